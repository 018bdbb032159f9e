"""``python -m tests.fuzz --inputs 100000``: try damaged files, and say what came of them."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from tests.fuzz.corpus import corpus, entry_line
from tests.fuzz.harness import Tally, try_inputs

EVERY = 30.0  # s, between lines


def main() -> int:
    """Try them; return 1 where there is a finding."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--inputs", type=int, default=2000, metavar="N", help="how many")
    parser.add_argument("--seed", type=int, default=0, help="of all of them")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="number of the first")
    parser.add_argument("--corpus", action="store_true", help="what ever failed, instead")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="for the lines of findings")
    given = parser.parse_args()
    numbers = [(given.seed, given.first + k) for k in range(given.inputs)]
    begun = said = time.monotonic()
    told = 0
    tally = Tally()
    for tally in try_inputs([entry.input for entry in corpus()] if given.corpus else numbers):
        for finding in tally.findings[told:]:
            sys.stdout.write(f"{finding.name} ({finding.call}): {finding.fault}\n")
            if given.keep is not None and finding.input is not None:
                with given.keep.open("a", encoding="utf-8") as file:
                    file.write(entry_line(finding.fault, finding.input) + "\n")
        told = len(tally.findings)
        if time.monotonic() - said > EVERY:
            said = time.monotonic()
            sys.stdout.flush()
            sys.stderr.write(f"{tally.n} inputs in {said - begun:.0f} s\n")
    sys.stdout.write(f"{tally.summary()}\n")
    for call, seconds in sorted(tally.seconds.items(), key=lambda one: -one[1])[:8]:
        sys.stdout.write(f"  {call}: {seconds:.1f} s\n")
    return 1 if tally.findings else 0


if __name__ == "__main__":
    sys.exit(main())
