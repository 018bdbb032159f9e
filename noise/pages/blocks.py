"""Blocks that pages consist of: words, tables, figures, cards of sounds, condition maps.

A report, a review, a screen, a diagnosis and an identification are sections of the same blocks.
``templates/blocks.html.j2`` has a macro for each, by the name of its class; a block of nothing is
left out.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from noise.base.labels import LABELS

if TYPE_CHECKING:
    from noise.pages.figures import Panel  # which loads matplotlib
    from noise.pages.maps import ConditionMap


@dataclass(frozen=True)
class Text:
    """A paragraph; `style` is of the style sheet, `bold` stands before it."""

    words: str
    style: str = ""
    bold: str = ""

    def __bool__(self) -> bool:
        return bool(self.words)


@dataclass(frozen=True)
class Items:
    """A list of texts, or of names and what is said of each."""

    items: Sequence[str | tuple[str, str]]
    style: str = ""

    def __bool__(self) -> bool:
        return bool(self.items)


@dataclass(frozen=True)
class Pre:
    """Lines of a file or a call, as they are."""

    text: str


class Bar(NamedTuple):
    """A bar within a cell: where it begins and how wide it is [%], and its look."""

    left: float
    width: float
    look: str = ""


class Cell(NamedTuple):
    """Content of a cell of a table.

    Parameters
    ----------
    text : str
    small : str
        Below it.
    bars : sequence of Bar
        Above it.
    labels : sequence of (str, str)
        Labels, and what is said of each.
    link : str
        Id of the element that a click leads to.
    items : sequence of str
    """

    text: str = ""
    small: str = ""
    bars: Sequence[Bar] = ()
    labels: Sequence[tuple[str, str]] = ()
    link: str = ""
    items: Sequence[str] = ()


@dataclass(frozen=True)
class Table:
    """A table whose rows become cards of their own on a narrow screen.

    Parameters
    ----------
    columns : sequence of str
    rows : sequence of sequences of (Cell or str)
    head : int
        Number of the column that names each row.
    name : str
        For who does not see it.
    style : str
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell | str]]
    head: int = 0
    name: str = ""
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
    caption: str = ""

    def __bool__(self) -> bool:
        return bool(self.pictures)


@dataclass(frozen=True)
class Cards:
    """Cards of sounds, by id; `counts` of labels filter them, `more` has blocks on each card."""

    keys: Collection[str]
    style: str = ""
    counts: Sequence[tuple[str, int]] = ()
    more: Mapping[str, Sequence[Block]] | None = None

    def __bool__(self) -> bool:
        return bool(self.keys)


@dataclass(frozen=True)
class Maps:
    """Condition maps side by side."""

    maps: Sequence[ConditionMap]

    def __bool__(self) -> bool:
        return bool(self.maps)


@dataclass(frozen=True)
class Group:
    """Blocks under a heading of their own, or side by side under none."""

    title: str
    blocks: Sequence[Block]
    soft: str = ""
    style: str = ""

    def __bool__(self) -> bool:
        return any(self.blocks)


@dataclass(frozen=True)
class Sounds:
    """What holds for all sounds: gains, labels, and the colours of spectrograms."""

    gain: Sequence[str]
    labels: Sequence[str] = LABELS


@dataclass(frozen=True)
class Other:
    """What a page has beyond these: the name of a macro, and what it is given."""

    macro: str
    content: Any

    def __bool__(self) -> bool:
        return bool(self.content)


@dataclass(frozen=True)
class Section:
    """Blocks under a heading."""

    heading: str
    blocks: Sequence[Block]
    style: str = ""

    def __bool__(self) -> bool:
        return any(self.blocks)


Block = Text | Items | Pre | Table | Panels | Cards | Maps | Group | Sounds | Other | Section
"""Any of these."""
