"""Names, order, colours, patterns and abbreviations of the labels.

A label has a colour, a pattern and an abbreviation, because projectors wash colours out, printers
drop them, and one man in twelve is colour-blind.
"""

from __future__ import annotations

from typing import NamedTuple

LABELS = ("creak", "squawk", "squeal", "none", "unknown")
"""Labels in the order of all probability tables."""

PERSISTS = "persists"
"""Map label of points where a running vibration persists but none starts from rest."""

MAP_LABELS = (*LABELS, PERSISTS)
"""Labels on the maps of a screening."""

NAMED = LABELS[:3]
"""Labels that name a noise."""


class Look(NamedTuple):
    """Colours, pattern and abbreviation of a label.

    Parameters
    ----------
    colour : str
        Fill colour.
    line : str
        Colour of pattern and outline.
    pattern : str
        ``stripes``, ``dots``, ``lines``, ``hatches``, ``plain`` or ``crosses``.
    mark : str
        Abbreviation.
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
"""Look of each map label; vermilion and orange are those of Okabe and Ito (Color universal design,
2008)."""

DARK_LABELS = ("creak", "squeal")
"""Labels whose colour needs white text."""

LABEL_COLOURS = {label: LABEL_LOOKS[label].colour for label in LABELS}
"""Fill colour of each label."""

SURROUNDINGS = ("any", "car", "rig")
"""Places of recording: other sounds to expect there set the confidence needed to name a noise."""

SENSITIVITY = (0.1, 10.0)
"""Least and largest factor on the odds of a noise [-]."""
