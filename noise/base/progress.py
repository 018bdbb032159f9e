"""Messages and progress bar while the program works, all on standard error.

Standard output belongs to results. The bar is drawn on a terminal only; in a log file there is one
line that says what is being done. Lines and bar do not tread on each other, and a standard error
that is closed is no reason to stop.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sized
from typing import TYPE_CHECKING, TypeVar

from noise.base.readable import readable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import TextIO

__all__ = ["counted", "discard", "note", "say", "track"]

_Item = TypeVar("_Item")


def say(text: str) -> None:
    """Print one line on standard error.

    Line breaks inside `text` become spaces, and what would control the terminal is shown as its
    code.

    Examples
    --------
    >>> say("reading 12 recordings")
    """
    if sys.stderr is None:  # closed by the caller
        return
    line = readable(" ".join(text.split("\n")))
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
        yield from items
        return
    from tqdm import tqdm

    # The bar goes away at the end: the line that says what came of the work follows.
    with tqdm(
        items, desc=doing, total=total, unit=f" {unit}", leave=False, file=sys.stderr
    ) as advancing:
        yield from advancing
