"""What ever failed, one JSON object a line: what happened, the call, and the file's content."""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz.judged import Input

__all__ = ["Entry", "corpus", "entry_line"]

_FILE = Path(__file__).with_name("corpus.jsonl")


@dataclass(frozen=True)
class Entry:
    """An input, and what it once did."""

    about: str
    input: Input


def corpus() -> list[Entry]:
    """Read them."""
    found = []
    for line in _FILE.read_text(encoding="utf-8").splitlines():
        said = json.loads(line)
        content = zlib.decompress(base64.b85decode(said["content"]))
        found.append(Entry(said["about"], Input(said["call"], content, said.get("stem"))))
    return found


def entry_line(about: str, case: Input) -> str:
    """Return the line of an input, for the file."""
    content = base64.b85encode(zlib.compress(case.content, 9)).decode()
    stem = {} if case.stem is None else {"stem": case.stem}
    return json.dumps({"about": about, "call": case.call, **stem, "content": content})
