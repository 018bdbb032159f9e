"""One input: written, given to its call, and judged by what a user would see of it."""

from __future__ import annotations

import io
import os
import re
import shutil
import sys
import traceback
import warnings
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError
from tests.fuzz.calls import CALLS, Call
from tests.fuzz.mutations import BYTES, NAMES, pick

if TYPE_CHECKING:
    from tests.fuzz.mutations import Rng

__all__ = ["MOST_MEMORY", "Input", "Outcome", "input_of", "judge"]

MOST_MEMORY = 1_000_000_000
"""Of a command and its reading process, each [byte]."""

_ANY_NAME = 0.08  # share of inputs whose file is called anything
_CONTROLS = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u202e]")  # all but the line's end


@dataclass(frozen=True)
class Input:
    """A damaged file and what is done with it.

    Parameters
    ----------
    call : str
        Of `CALLS`.
    content : bytes
    stem : str, optional
        What the file is called instead of what the call calls it.
    """

    call: str
    content: bytes
    stem: str | None = None


@dataclass(frozen=True)
class Outcome:
    """What came of an input: the exit code, faults in words, memory [byte] and the messages."""

    code: int
    faults: tuple[str, ...]
    memory: int
    said: str


def input_of(seed: int, number: int, valid: Path) -> Input:
    """Make an input: the same of the same numbers."""
    rng = np.random.default_rng([seed, number])
    shares = np.array([call.share for call in CALLS.values()])
    name = list(CALLS)[int(rng.choice(len(CALLS), p=shares / shares.sum()))]
    call = CALLS[name]
    content = (valid / call.valid).read_bytes()
    stem = pick(rng, NAMES) if call.named and rng.random() < _ANY_NAME else None
    if stem is None or rng.random() < 0.5:
        content = _damaged(content, call, rng)
    return Input(name, content, stem)


def _damaged(content: bytes, call: Call, rng: Rng) -> bytes:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return pick(rng, call.mutations)(content, rng)
        except Exception:  # no library writes everything that is hostile
            return pick(rng, BYTES)(content, rng)


def judge(case: Input, valid: Path, folder: Path) -> Outcome:
    """Run an input in a folder of its own, and find fault with what happens.

    Parameters
    ----------
    case : Input
    valid : Path
        Folder of `write_valid_files`.
    folder : Path
        Made anew, and the working directory from then on.
    """
    call = CALLS[case.call]
    path = _laid_out(case, call, valid, folder)
    messages: list[str] = []
    said, printed, faults = io.StringIO(), io.StringIO(), []
    _forget_peaks()
    code = -1
    spoken = os.fstat(2).st_size
    with _Listening(messages), redirect_stdout(printed), redirect_stderr(said):
        try:
            code = call.run(path)
        except BaseException as error:  # whatever gets out of a command
            last = traceback.extract_tb(error.__traceback__)[-1]
            faults.append(
                f"traceback: {type(error).__name__} in {Path(last.filename).name}, line "
                f"{last.lineno}: {error!s:.200}"
            )
    text = said.getvalue()
    if "unexpected, please report" in text:
        faults.append(f"unexpected: {text[text.index('unexpected, please') :][:300].strip()}")
    if code not in (0, 1, 2) and not faults:
        faults.append(f"exit code {code}")
    several = [one for one in messages if len(one.replace(str(path), "").splitlines()) > 1]
    if several:
        faults.append(f"a message of several lines: {several[0]!r:.300}")
    if _CONTROLS.search(text):
        faults.append(f"controls the terminal: {text!r:.300}")
    if os.fstat(2).st_size > spoken:
        os.lseek(2, spoken, os.SEEK_SET)
        faults.append(f"a library prints: {os.read(2, 200)!r}")
    memory = max(_peaks())
    if memory > MOST_MEMORY:
        faults.append(f"memory of {memory / 1e6:.0f} MB")
    return Outcome(code, tuple(faults), memory, text)


def _laid_out(case: Input, call: Call, valid: Path, folder: Path) -> Path:
    os.chdir("/")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    os.chdir(folder)
    given = Path(call.given)
    path = given if case.stem is None else given.with_name(case.stem + given.suffix)
    for name, file in call.beside.items():
        shutil.copy(valid / file, name)
    path.write_bytes(case.content)
    return path


class _Listening:
    """Notes the messages of all errors within: what a terminal shows has lost its line breaks."""

    def __init__(self, messages: list[str]) -> None:
        self._messages = messages
        self._init = BushingNoiseError.__init__

    def __enter__(self) -> None:
        def noting(error: BushingNoiseError, *given: object) -> None:
            self._init(error, *given)
            self._messages.append(str(error))

        BushingNoiseError.__init__ = noting

    def __exit__(self, *_: object) -> None:
        BushingNoiseError.__init__ = self._init


def _processes() -> list[str]:
    """This process and those that it has started, as Linux names them."""
    if not sys.platform.startswith("linux"):
        return []
    found = ["self"]
    for one in Path("/proc/self/task").glob("*/children"):
        with suppress(OSError):  # the thread has ended
            found += one.read_text().split()
    return found


def _forget_peaks() -> None:
    for pid in _processes():
        with suppress(OSError):  # it has ended
            Path(f"/proc/{pid}/clear_refs").write_text("5")


def _peaks() -> list[int]:
    found = [0]
    for pid in _processes():
        try:
            status = Path(f"/proc/{pid}/status").read_text()
        except OSError:
            continue
        found += [1024 * int(line.split()[1]) for line in status.splitlines() if "VmHWM" in line]
    return found
