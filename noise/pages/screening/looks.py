"""Looks of the maps of a screen beside those of labels: levels, differences, how a point is known.

Each has words, or a number, on the map as well, so that nothing is told by colour alone.
"""

from __future__ import annotations

from noise.base.label_looks import Look

__all__ = ["DIFFERENCES", "LEVELS", "LEVEL_STEPS", "SAID", "SUBSTITUTED", "WAYS", "way_look"]

LEVEL_STEPS = (50.0, 60.0, 70.0, 80.0, 90.0)
"""Between the colours of levels [dB(A)]."""

LEVELS = {
    "level-0": Look("#fdf1cf", "#8a6d2f", "plain", "below 50"),
    "level-1": Look("#fccf96", "#8a6d2f", "plain", "50 to 60"),
    "level-2": Look("#f89b6c", "#7a3600", "plain", "60 to 70"),
    "level-3": Look("#dd5f6b", "#6b1f2e", "plain", "70 to 80"),
    "level-4": Look("#a63a80", "#4b1d3e", "plain", "80 to 90"),
    "level-5": Look("#5e2379", "#2b0d3e", "plain", "90 and more"),
}
"""By steps of the level, from soft to loud."""

DIFFERENCES = {
    "gone": Look("#3f8fc4", "#dcebf6", "lines", "noise gone"),
    "softer-much": Look("#8dbfe0", "#3f6f94", "plain", "softer by 10 dB or more"),
    "softer": Look("#cfe3f1", "#3f6f94", "plain", "softer by 3 to 10 dB"),
    "alike": Look("#e3e6e9", "#6f7b87", "plain", "within 3 dB"),
    "louder": Look("#fbdcbc", "#94592a", "plain", "louder by 3 to 10 dB"),
    "louder-much": Look("#f0a55f", "#94592a", "plain", "louder by 10 dB or more"),
    "new": Look("#c4571b", "#fbe3d3", "stripes", "noise new"),
    "quiet": Look("#ffffff", "#c9d0d7", "dots", "none in both"),
}
"""Of a design against another."""

WAYS = {
    "simulated": Look("#41719c", "#1d3a55", "plain", "simulated"),
    "refined": Look(
        "#f3e2b0", "#a58a3c", "stripes",
        "interpolated between simulated points of one noise",
    ),
    "stability": Look(
        "#dcead3", "#7f9a6f", "plain", "silent, as steady sliding is stable there"
    ),
    "unchanged": Look(
        "#dcdfe8", "#767d92", "dots", "as at another temperature or fit"
    ),
}  # fmt: skip
"""By how a point is known."""

SAID = {"refined": "interpolated", "stability": "by stability", "unchanged": "as elsewhere"}
"""In short, how a point is known whose way of knowing does not say it."""

SUBSTITUTED = Look("none", "#1d2329", "stripes", "the design has no data of its own there")
"""Over the look of how a point is known."""


def way_look(how: str) -> Look:
    """Return the look of a way of knowing, also of one that no page has heard of.

    Examples
    --------
    >>> way_look("simulated").mark, way_look("guessed").mark
    ('simulated', 'guessed')
    """
    return WAYS.get(how, Look("#f6f6f6", "#55606b", "crosses", how or "not told"))
