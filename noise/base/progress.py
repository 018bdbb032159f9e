"""Messages and progress bar while the program works, all on standard error.

Standard output belongs to results. The bar is drawn on a terminal only; in a log file there is one
line that says what is being done, and one a second for a program that reads them (`LINES`). Lines
and bar do not tread on each other, and a standard error that is closed is no reason to stop.

Names of files may hold anything. Bytes that are no UTF-8 cannot be written as text, characters that
control a terminal can clear it, or write into its title, and those that turn the direction of
writing make a name look like another; all are shown as a backslash and their code (`readable`).
"""

from __future__ import annotations

import os
import re
import sys
import time
from collections.abc import Iterable, Iterator, Sized
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO, TypeVar

if TYPE_CHECKING:
    from tqdm import tqdm

LINES = "BUSHING_NOISE_PROGRESS_LINES"
"""Environment variable that asks for lines ``simulating: 120 of 7360`` where there is no bar."""

_EVERY = 1.0
"""Between two such lines [s]."""

_LONG = 5.0
"""From which on work is told how long it will take [s]; a bar always tells it."""

_Item = TypeVar("_Item")


def set_verbosity(*, quiet: bool = False, verbose: bool = False) -> None:
    """Say less or more: with `quiet` errors alone, with `verbose` the time of each line.

    Quiet leaves out progress, notes, summaries and the names of what was written.

    Examples
    --------
    >>> set_verbosity()
    """
    _verbosity.quiet, _verbosity.since = quiet, time.monotonic() if verbose else None


class _Verbosity:
    quiet = False
    since: float | None = None


_verbosity = _Verbosity()


def say(text: str, *, error: bool = False) -> None:
    """Print one line on standard error.

    Line breaks inside `text` become spaces, and what would control the terminal is shown as its
    code.

    Parameters
    ----------
    text : str
    error : bool
        Whether it is printed with ``--quiet``, too.

    Examples
    --------
    >>> say("reading 12 recordings")
    """
    if sys.stderr is None or (_verbosity.quiet and not error):  # None: closed by the caller
        return
    line = readable(" ".join(text.split("\n")))
    if _verbosity.since is not None:
        line = f"[{time.monotonic() - _verbosity.since:7.2f} s] {line}"
    try:
        if "tqdm" in sys.modules:
            from tqdm import tqdm

            tqdm.write(line, file=sys.stderr)
        else:
            sys.stderr.write(line + "\n")
        sys.stderr.flush()
    except OSError:  # nobody reads on; the work is worth going on with
        discard(sys.stderr)


def report(*lines: object) -> None:
    """Print what a call has written or found on standard output, a line each, unless quiet.

    A result that standard output itself is to hold, as of a call without ``--out``, is printed.

    Examples
    --------
    >>> report("labels.csv")
    labels.csv
    """
    if not _verbosity.quiet:
        for line in lines:
            print(line)  # noqa: T201  # what a command prints


def discard(stream: TextIO) -> None:
    """Point a stream that can no longer be written nowhere, so that nothing is left to fail."""
    try:
        number = stream.fileno()
    except OSError:  # of a notebook, or in memory
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    os.close(nowhere)


def note(text: str) -> None:
    """Print one line that the user should know of, though the work goes on.

    Examples
    --------
    >>> note("0.5 mm lies outside the measured fits")
    """
    say(f"bushing-noise: note: {text}")


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, in the plural where it takes one.

    Examples
    --------
    >>> counted(1, "recording"), counted(12, "recording")
    ('1 recording', '12 recordings')
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def track(
    items: Iterable[_Item], doing: str, *, total: int | None = None, unit: str = "recording"
) -> Iterator[_Item]:
    """Pass items on, showing how far the work is.

    Parameters
    ----------
    items : iterable
    doing : str
        What is being done, such as ``"labelling"``.
    total : int, optional
        How many items there are; by default their length, where they have one.
    unit : str
        What one item is called, in the singular.

    Yields
    ------
    object
        The items, in their order.

    Examples
    --------
    >>> list(track([1, 2], "adding", unit="number"))
    [1, 2]
    """
    if total is None and isinstance(items, Sized):
        total = len(items)
    if not _on_terminal():
        say(doing if total is None else f"{doing} {counted(total, unit)}")
        yield from items if not os.environ.get(LINES) else _in_lines(items, doing, total)
        return
    from tqdm import tqdm

    # The bar goes away at the end: the line that says what came of the work follows.
    yield from tqdm(items, desc=doing, total=total, unit=f" {unit}", leave=False, file=sys.stderr)


class Steps:
    """Work of a few steps, each told of by a line; a terminal has a bar of how many are done.

    Parameters
    ----------
    bar : tqdm.tqdm, optional
        Where standard error is a terminal.
    """

    def __init__(self, bar: tqdm[object] | None = None) -> None:
        self._bar = bar
        self._begun = 0

    def __call__(self, text: str) -> None:
        """Say that a step begins, or what came of it."""
        say(text)
        self._begun += 1
        if self._bar is not None:
            self._bar.update(self._begun - 1 - self._bar.n)
            self.expect(self._bar.total)

    def expect(self, number: int) -> None:
        """Know better how many steps there are."""
        if self._bar is not None:
            self._bar.total = max(number, self._begun)
            self._bar.refresh()


@contextmanager
def steps(doing: str, number: int) -> Iterator[Steps]:
    """Show how far work is that consists of steps of any length.

    Parameters
    ----------
    doing : str
        What is being done, such as ``"screening"``.
    number : int
        Of its steps, as far as that is known; it may turn out to be more or fewer.

    Yields
    ------
    Steps
        To be called with a line as each step begins.

    Examples
    --------
    >>> with steps("screening", 2) as tell:
    ...     tell("mapping PDMS")
    ...     tell("grading PDMS")
    """
    if not _on_terminal():
        yield Steps()
        return
    from tqdm import tqdm

    with tqdm(desc=doing, total=number, unit=" step", leave=False, file=sys.stderr) as bar:
        yield Steps(bar)


def _on_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty() and not _verbosity.quiet


def _in_lines(items: Iterable[_Item], doing: str, total: int | None) -> Iterator[_Item]:
    began = said = time.monotonic()
    for number, item in enumerate(items, 1):
        yield item
        now = time.monotonic()
        if now - said < _EVERY:
            continue
        said, text = now, f"{doing}: {number}"
        if total is not None:
            left = (now - began) * (total - number) / number
            text += f" of {total}" + f", about {left:.0f} s left" * (now - began >= _LONG)
        say(text)


_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def readable(text: str) -> str:
    r"""Return a text without what cannot be shown.

    Examples
    --------
    >>> print(readable("run07.wav"), readable("\x1b[2J\a.wav"), readable("caf\udce9.wav"))
    run07.wav \x1b[2J\x07.wav caf\xe9.wav
    """
    if not text.isascii():
        text = _bytes(text).decode("utf-8", "backslashreplace")
    return _CONTROL.sub(_code, text)


def _bytes(text: str) -> bytes:
    try:
        return os.fsencode(text)
    except UnicodeEncodeError:  # of a system whose names are in another code
        return text.encode("utf-8", "surrogatepass")


def _code(found: re.Match[str]) -> str:
    number = ord(found[0])
    return f"\\x{number:02x}" if number < 0x100 else f"\\u{number:04x}"
