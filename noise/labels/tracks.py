"""Labels over time as bars, one row a recording or a channel, in the colours of the labels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.drawing import axes_or_new
from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

__all__ = ["MOST_TRACKS", "draw_tracks"]

MOST_TRACKS = 40
"""Rows that a picture has room for."""

_HEIGHT = 0.7
_NAMED = 0.08
"""A bar as long as this share of the axis has room for its label."""


def draw_tracks(
    tracks: Mapping[str, Sequence[tuple[float, float, str]]], ax: Axes | None = None
) -> Axes:
    """Draw labels over time.

    Parameters
    ----------
    tracks : mapping of str to sequence of (float, float, str)
        Start [s], end [s] and label of each stretch, by the name of its row; the first of them is
        on top, and no more than `MOST_TRACKS` are drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ParameterError
        Nothing is labelled.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = draw_tracks({"run07": [(0.0, 1.0, "creak")]}, Figure().subplots())
    >>> axes.get_xlabel(), [text.get_text() for text in axes.get_legend().get_texts()]
    ('Time [s]', ['creak'])
    """
    from matplotlib.patches import Patch

    from noise.labels.label_display import DARK_LABELS, LABEL_COLOURS

    stretches = [stretch for of_one in tracks.values() for stretch in of_one]
    if not stretches:
        raise ParameterError("nothing is labelled, so there is nothing to draw")
    longest = max(end for _, end, _ in stretches)
    shown = dict(list(tracks.items())[:MOST_TRACKS])
    with axes_or_new(ax) as axes:
        for row, of_one in enumerate(shown.values()):
            for start, end, label in of_one:
                axes.broken_barh(
                    [(start, end - start)], (row - _HEIGHT / 2, _HEIGHT),
                    facecolor=LABEL_COLOURS[label], edgecolor="#444444", linewidth=0.6,
                )  # fmt: skip
                if end - start >= _NAMED * longest:
                    axes.text(
                        (start + end) / 2, row, label, ha="center", va="center", fontsize=9.0,
                        color="white" if label in DARK_LABELS else "#222222",
                    )  # fmt: skip
        axes.set_yticks(range(len(shown)), list(shown))
        axes.set_ylim(len(shown) - 0.5, -0.5)
        axes.set_xlim(0.0, longest)
        axes.set_xlabel("Time [s]")
        axes.grid(visible=False)
        if len(tracks) > MOST_TRACKS:
            axes.set_title(f"{MOST_TRACKS} of {len(tracks)}", loc="left")
        found = {label for _, _, label in stretches}
        axes.legend(
            handles=[
                Patch(facecolor=colour, edgecolor="#444444", label=label)
                for label, colour in LABEL_COLOURS.items()
                if label in found
            ],
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=len(found),
        )
    return axes
