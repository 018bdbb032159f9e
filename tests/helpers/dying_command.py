"""``python dying_command.py AT TOLD ARGUMENTS...``: a command killed on its way.

Moments are the items that it goes through, the steps that it tells of and the files that it puts in
their places; they are the same in each call, however fast the machine is. It kills itself before
moment number `AT`. With -1 it lives, and writes into the file `TOLD` how many there were.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path


def main() -> int:
    from noise.base import progress

    at, told = int(sys.argv[1]), Path(sys.argv[2])
    track, step, put = progress.track, progress.Steps.__call__, Path.replace
    move = progress.Steps.at
    n = 0

    def moment():
        nonlocal n
        if n == at:
            os.kill(os.getpid(), signal.SIGKILL)
        n += 1

    def tracked(items, *given, **named):
        for item in track(items, *given, **named):
            moment()
            yield item

    def stepped(*given):
        moment()
        step(*given)

    def moved(*given):
        moment()
        move(*given)

    def replaced(path, target):
        moment()
        return put(path, target)

    progress.track, progress.Steps.__call__, Path.replace = tracked, stepped, replaced
    progress.Steps.at = moved
    from noise.cli import main as command

    code = command(sys.argv[3:])
    told.write_text(str(n))
    return code


if __name__ == "__main__":
    sys.exit(main())
