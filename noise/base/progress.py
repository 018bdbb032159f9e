"""Messages and progress bars on standard error.

Standard output is for results. Bars are drawn on terminals only; otherwise one line announces the
work, and with the environment variable `LINES` one line per second reports progress. A closed
standard error does not stop the program.

File names may contain anything: invalid UTF-8, characters that control a terminal or change the
direction of writing. `readable` shows these as escape codes.
"""

from __future__ import annotations

import os
import re
import sys
import time
from collections.abc import Iterable, Iterator, Sized
from contextlib import contextmanager
from types import SimpleNamespace
from typing import TYPE_CHECKING, TextIO, TypeVar

if TYPE_CHECKING:
    from tqdm import tqdm

LINES = "BUSHING_NOISE_PROGRESS_LINES"
"""Environment variable that turns on lines such as ``simulating: 120 of 7360`` without a bar."""

_LINE_INTERVAL = 1.0
"""Time between two such lines [s]."""

_LONG = 5.0
"""Run time from which on these lines estimate the remaining time [s]."""

_Item = TypeVar("_Item")


def set_verbosity(*, quiet: bool = False, verbose: bool = False) -> None:
    """Set how much is printed: `quiet` prints errors only, `verbose` adds the elapsed time.

    Quiet suppresses progress, notes, summaries and the names of written files.

    Examples
    --------
    >>> set_verbosity()
    """
    _verbosity.quiet, _verbosity.since = quiet, time.monotonic() if verbose else None


_verbosity = SimpleNamespace(quiet=False, since=None)
"""Whether to be quiet, and the start time for verbose lines [s]."""


def say(text: str, *, error: bool = False) -> None:
    """Print one line on standard error.

    Line breaks become spaces, and control characters are shown as escape codes.

    Parameters
    ----------
    text : str
    error : bool
        Whether to print it with ``--quiet`` as well.

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
    except OSError:  # the reader is gone; the work goes on
        discard(sys.stderr)


def report(*lines: object) -> None:
    """Print written files or findings on standard output, one line each, unless quiet.

    Results that go to standard output in any case, as without ``--out``, are printed directly.

    Examples
    --------
    >>> report("labels.csv")
    labels.csv
    """
    if not _verbosity.quiet:
        for line in lines:
            print(line)  # noqa: T201  # output of a command


def discard(stream: TextIO) -> None:
    """Redirect a broken stream to the null device, so that later writes do not fail."""
    try:
        number = stream.fileno()
    except OSError:  # a stream of a notebook, or in memory
        return
    null_device = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null_device, number)
    os.close(null_device)


def note(*texts: str) -> None:
    """Print warnings, one line each.

    Examples
    --------
    >>> note("0.5 mm lies outside the measured fits")
    """
    for text in texts:
        say(f"bushing-noise: note: {text}")


def counted(number: int, noun: str) -> str:
    """Return a number with its noun in singular or plural.

    Examples
    --------
    >>> counted(1, "recording"), counted(12, "recording")
    ('1 recording', '12 recordings')
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def track(
    items: Iterable[_Item], doing: str, *, total: int | None = None, unit: str = "recording"
) -> Iterator[_Item]:
    """Iterate over items and show progress.

    Parameters
    ----------
    items : iterable
    doing : str
        Name of the work, such as ``"labelling"``.
    total : int, optional
        Number of items (default: their length, if they have one).
    unit : str
        Name of an item, in the singular.

    Yields
    ------
    object
        The items in their order.

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

    # The bar disappears at the end; a line with the result follows.
    yield from tqdm(items, desc=doing, total=total, unit=f" {unit}", leave=False, file=sys.stderr)


class Steps:
    """Progress of a few steps: a line for each, and on a terminal a bar.

    Parameters
    ----------
    bar : tqdm.tqdm, optional
        Progress bar on a terminal.
    """

    def __init__(self, bar: tqdm[object] | None = None) -> None:
        self._bar = bar
        self._started = 0

    def __call__(self, text: str) -> None:
        """Print a line at the start of a step."""
        say(text)
        self._started += 1
        if self._bar is not None:
            self._bar.update(self._started - 1 - self._bar.n)
            self.expect(self._bar.total)

    def at(self, share: float) -> None:
        """Move the bar to a share of all steps [-]."""
        if self._bar is not None:
            self._bar.update(int(share * (self._bar.total or 0)) - self._bar.n)

    def expect(self, number: int) -> None:
        """Correct the expected number of steps."""
        if self._bar is not None:
            self._bar.total = max(number, self._started)
            self._bar.refresh()


@contextmanager
def steps(doing: str, number: int, unit: str = "step") -> Iterator[Steps]:
    """Show the progress of work that has few steps of different length.

    Parameters
    ----------
    doing : str
        Name of the work, such as ``"screening"``.
    number : int
        Expected number of steps; there may be more or fewer.
    unit : str
        Name of a step, in the singular.

    Yields
    ------
    Steps
        Function to call with a line of text at the start of each step.

    Examples
    --------
    >>> with steps("screening", 2) as progress:
    ...     progress("mapping PDMS")
    ...     progress("grading PDMS")
    """
    if not _on_terminal():
        yield Steps()
        return
    from tqdm import tqdm

    with tqdm(desc=doing, total=number, unit=f" {unit}", leave=False, file=sys.stderr) as bar:
        yield Steps(bar)


def _on_terminal() -> bool:
    """Whether to draw bars."""
    return sys.stderr is not None and sys.stderr.isatty() and not _verbosity.quiet


def _in_lines(items: Iterable[_Item], doing: str, total: int | None) -> Iterator[_Item]:
    """Iterate over items and print a line of progress per second."""
    start = last = time.monotonic()
    for number, item in enumerate(items, 1):
        yield item
        now = time.monotonic()
        if now - last < _LINE_INTERVAL:
            continue
        last, text = now, f"{doing}: {number}"
        if total is not None:
            left = (now - start) * (total - number) / number
            text += f" of {total}" + f", about {left:.0f} s left" * (now - start >= _LONG)
        say(text)


_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def readable(text: str) -> str:
    r"""Return a text with escape codes for all that cannot be displayed.

    Examples
    --------
    >>> print(readable("run07.wav"), readable("\x1b[2J\a.wav"), readable("caf\udce9.wav"))
    run07.wav \x1b[2J\x07.wav caf\xe9.wav
    """
    if not text.isascii():
        try:
            content = os.fsencode(text)
        except UnicodeEncodeError:  # the file system has another encoding
            content = text.encode("utf-8", "surrogatepass")
        text = content.decode("utf-8", "backslashreplace")
    return _CONTROL.sub(_escape, text)


def _escape(match: re.Match[str]) -> str:
    """Return the escape code of a character."""
    number = ord(match[0])
    return f"\\x{number:02x}" if number < 0x100 else f"\\u{number:04x}"
