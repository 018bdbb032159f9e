"""Messages and progress bar while the program works, all on standard error.

Standard output belongs to results. The bar is drawn on a terminal only; in a log file there is one
line that says what is being done, and one a second for a program that reads them (`LINES`). Lines
and bar do not tread on each other, and a standard error that is closed is no reason to stop.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sized
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import TextIO

__all__ = ["LINES", "counted", "discard", "note", "say", "track"]

LINES = "BUSHING_NOISE_PROGRESS_LINES"
"""Environment variable that asks for lines ``simulating: 120 of 7360`` where there is no bar."""

_EVERY = 1.0
"""Between two such lines [s]."""

_Item = TypeVar("_Item")


def say(text: str) -> None:
    """Print one line on standard error; line breaks inside `text` become spaces.

    Examples
    --------
    >>> say("reading 12 recordings")
    """
    if sys.stderr is None:  # closed by the caller
        return
    line = " ".join(text.split("\n"))
    try:
        if "tqdm" in sys.modules:
            from tqdm import tqdm

            tqdm.write(line, file=sys.stderr)
        else:
            sys.stderr.write(line + "\n")
        sys.stderr.flush()
    except OSError:  # nobody reads on; the work is worth going on with
        discard(sys.stderr)


def discard(stream: TextIO) -> None:
    """Point a stream that can no longer be written nowhere, so that nothing is left to fail."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
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
    if sys.stderr is None or not sys.stderr.isatty():
        say(doing if total is None else f"{doing} {counted(total, unit)}")
        yield from items if not os.environ.get(LINES) else _in_lines(items, doing, total)
        return
    from tqdm import tqdm

    # The bar goes away at the end: the line that says what came of the work follows.
    with tqdm(
        items, desc=doing, total=total, unit=f" {unit}", leave=False, file=sys.stderr
    ) as advancing:
        yield from advancing


def _in_lines(items: Iterable[_Item], doing: str, total: int | None) -> Iterator[_Item]:
    said = time.monotonic()
    for number, item in enumerate(items, 1):
        yield item
        if time.monotonic() - said >= _EVERY:
            said = time.monotonic()
            say(f"{doing}: {number}" + ("" if total is None else f" of {total}"))
