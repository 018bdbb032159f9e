"""Labels: their names in the one order that all tables and models have, and how they are shown.

A label is shown by a colour that no eye takes for another's, by a pattern and by two letters: a
projector washes colours out, a printer drops them, and one man in twelve does not see them.
"""

from __future__ import annotations

from typing import NamedTuple

LABELS = ("creak", "squawk", "squeal", "none", "unknown")
"""The labels, in the order of all tables of probabilities."""

PERSISTS = "persists"
"""What a map shows where a vibration goes on, but none breaks out from rest."""

MAP_LABELS = (*LABELS, PERSISTS)
"""What maps of screened points show."""

NAMED = LABELS[:3]
"""Those that are the name of a noise."""


class Look(NamedTuple):
    """How one label is shown.

    Parameters
    ----------
    colour : str
        Of an area.
    line : str
        Of its pattern and of its outline.
    pattern : str
        ``stripes``, ``dots``, ``lines``, ``hatches``, ``plain`` or ``crosses``.
    mark : str
        Where there is no room for the label itself.
    """

    colour: str
    line: str
    pattern: str
    mark: str


LABEL_LOOKS = {
    "creak": Look("#d55e00", "#7a3600", "stripes", "Cr"),
    "squawk": Look("#e69f00", "#7d5600", "dots", "Sk"),
    "squeal": Look("#b5478a", "#6b1f4e", "lines", "Sl"),
    "none": Look("#c3d4df", "#6f8596", "plain", "\N{EN DASH}"),
    PERSISTS: Look("#f3dfae", "#7d5600", "hatches", "P"),
    "unknown": Look("#f6f6f6", "#55606b", "crosses", "?"),
}
"""By label, and of where a vibration only persists once started; vermilion and orange are those of
Okabe and Ito (Color universal design, 2008)."""

DARK_LABELS = ("creak", "squeal")
"""On whose colours text is white."""

LABEL_COLOURS = {label: LABEL_LOOKS[label].colour for label in LABELS}
"""Of areas."""

SURROUNDINGS = ("any", "car", "rig")
"""Where recordings are made: what else may be heard there decides how sure a name has to be."""
