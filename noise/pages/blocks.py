"""Building blocks of pages: text, tables, figures, cards of sounds.

A review, a screen, a diagnosis and an identification are sections of the same blocks.
``templates/blocks.html.j2`` has a macro for each, by the name of its class; a block of nothing is
left out.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from noise.base.labels import LABELS

if TYPE_CHECKING:
    from noise.pages.figures import Panel  # which loads matplotlib


@dataclass(frozen=True)
class Text:
    """Paragraph with a CSS class `style`."""

    words: str
    style: str = ""

    def __bool__(self) -> bool:
        return bool(self.words)


@dataclass(frozen=True)
class Items:
    """List of texts, or of names with texts."""

    items: Sequence[str | tuple[str, str]]
    style: str = ""

    def __bool__(self) -> bool:
        return bool(self.items)


@dataclass(frozen=True)
class Pre:
    """Preformatted lines of a file or call."""

    text: str


class Bar(NamedTuple):
    """Bar within a cell: left end [%], width [%] and CSS class."""

    left: float
    width: float
    look: str = ""


class Cell(NamedTuple):
    """Cell of a table.

    Parameters
    ----------
    text : str
    small : str
        Below it.
    bars : sequence of Bar
        Above it.
    labels : sequence of (str, str)
        Labels, each with a text.
    items : sequence of str
    """

    text: str = ""
    small: str = ""
    bars: Sequence[Bar] = ()
    labels: Sequence[tuple[str, str]] = ()
    items: Sequence[str] = ()


@dataclass(frozen=True)
class Table:
    """Table whose rows become cards on a narrow screen.

    Parameters
    ----------
    columns : sequence of str
    rows : sequence of sequences of (Cell or str)
    head : int
        Index of the column that names each row.
    style : str
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell | str]]
    head: int = 0
    style: str = ""

    @property
    def cells(self) -> list[list[Cell]]:
        """All cells, row by row."""
        return [[Cell(one) if isinstance(one, str) else one for one in row] for row in self.rows]

    def __bool__(self) -> bool:
        return bool(self.rows)


@dataclass(frozen=True)
class Panels:
    """Figures side by side."""

    pictures: Sequence[Panel]

    def __bool__(self) -> bool:
        return bool(self.pictures)


@dataclass(frozen=True)
class Cards:
    """Cards of sounds by id, with filters by label."""

    keys: Collection[str]
    style: str = ""
    counts: Sequence[tuple[str, int]] = ()

    def __bool__(self) -> bool:
        return bool(self.keys)


@dataclass(frozen=True)
class Group:
    """Group of blocks with an optional heading."""

    title: str
    blocks: Sequence[Block]
    soft: str = ""
    style: str = ""

    def __bool__(self) -> bool:
        return any(self.blocks)


@dataclass(frozen=True)
class Sounds:
    """Legend of all sounds: gains, labels, and colours of spectrograms."""

    gain: Sequence[str]
    labels: Sequence[str] = LABELS


@dataclass(frozen=True)
class Other:
    """Block of a named template macro."""

    macro: str
    content: Any

    def __bool__(self) -> bool:
        return bool(self.content)


@dataclass(frozen=True)
class Section:
    """Section of blocks under a heading."""

    heading: str
    blocks: Sequence[Block]
    style: str = ""

    def __bool__(self) -> bool:
        return any(self.blocks)


Block = Text | Items | Pre | Table | Panels | Cards | Group | Sounds | Other | Section
"""Type of all blocks."""
