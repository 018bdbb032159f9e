"""Map of recorded conditions and their labels, one panel per support.

The tile of a condition is divided by the numbers of segments per label. Conditions without
recordings stay empty, which distinguishes them from quiet ones.
"""

import math
from collections.abc import Iterable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from models.drawing import styled
from models.errors import ParameterError
from noise.base.labels import DARK_LABELS, LABEL_COLOURS, LABELS
from noise.labels.conditions import Place, Range
from noise.pictures.figure import new_figure, place_title

_ACROSS = 3  # panels
_ROW = 0.42  # height of a place [inch]
_LEAST = 0.13  # height in which a number can be read [inch]
_MARGIN = 0.06  # of a place
_FEWEST = 6  # places that a panel has room for across


def plot_conditions(places: Sequence[Place], *, title: str) -> Figure:
    """Draw a conditions map.

    Parameters
    ----------
    places : sequence of Place
        Of `noise.labels.conditions.conditions_map`.
    title : str

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        There are no places.

    Examples
    --------
    >>> from noise.labels.conditions import Place, Range
    >>> place = Place("PDMS", Range(4.9, 5.1, 5.0), Range(0.279, 0.279, 0.279), None)
    >>> place.segments["none"] = 3
    >>> [axes.get_title("left") for axes in plot_conditions([place], title="PDMS").axes]
    ['PDMS, support not known']
    """
    if not places:
        raise ParameterError("there are no labelled segments to map")
    panels = list(dict.fromkeys((place.material, place.support_stiffness) for place in places))
    speeds = _along(place.speed for place in places)
    fits = _along(place.interference for place in places)
    across = min(_ACROSS, len(panels))
    down = math.ceil(len(panels) / across)
    height = max(1.3, _ROW * len(fits) + 0.2)
    with styled():
        figure = new_figure(1.0 + down * (height + 0.75), title)
        grid = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
        row_height = height / len(fits)
        for number, axes in enumerate(grid.flat):
            if number >= len(panels):
                axes.set_axis_off()
                continue
            material, support = panels[number]
            axes.set_title(place_title(material, support))
            for place in places:
                if (place.material, place.support_stiffness) == panels[number]:
                    at = speeds.index(place.speed), fits.index(place.interference)
                    _draw(axes, place, at, row_height)
            _label_axes(axes, speeds, fits)
            axes.tick_params(labelbottom=number + across >= len(panels))
            if number + across >= len(panels):
                axes.set_xlabel("Speed [rad/s]")
            if number % across == 0:
                axes.set_ylabel("Interference [mm]")
        handles = [
            Patch(facecolor=LABEL_COLOURS[label], edgecolor="#444444", linewidth=0.6, label=label)
            for label in LABELS
            if any(place.segments[label] for place in places)
        ]
        words = "Numbers of segments" + "; ?: not known" * (None in (*speeds, *fits))
        figure.legend(handles=handles, loc="outside lower center", ncols=len(LABELS), title=words)
    return figure


def _along(ranges: Iterable[Range | None]) -> list[Range | None]:
    """Return the distinct values in ascending order, unknown last."""
    different = set(ranges)
    known = sorted(span for span in different if span is not None)
    return [*known, *([None] if None in different else [])]


def _draw(axes: Axes, place: Place, at: tuple[int, int], row_height: float) -> None:
    """Draw one condition as a stack of its labels, heights by share of segments."""
    size = 1.0 - 2.0 * _MARGIN
    left, bottom = at[0] - size / 2.0, at[1] - size / 2.0
    total = sum(place.segments.values())
    for label in LABELS:
        number = place.segments[label]
        height = size * number / total
        if not number:
            continue
        axes.add_patch(
            Rectangle(
                (left, bottom),
                size,
                height,
                facecolor=LABEL_COLOURS[label],
                edgecolor="#444444",
                linewidth=0.6,
            )
        )
        if height * row_height >= _LEAST:
            axes.text(
                at[0], bottom + height / 2.0, f"{number}", ha="center", va="center_baseline",
                fontsize=8.0, color="white" if label in DARK_LABELS else "#222222",
            )  # fmt: skip
        bottom += height


def _label_axes(axes: Axes, speeds: list[Range | None], fits: list[Range | None]) -> None:
    axes.set_xlim(-0.6, max(len(speeds), _FEWEST) - 0.4)
    axes.set_ylim(-0.6, len(fits) - 0.4)
    axes.set_xticks(range(len(speeds)), [_value(span) for span in speeds])
    axes.set_yticks(range(len(fits)), [_value(span) for span in fits])
    axes.tick_params(length=0)
    axes.grid(visible=False)


def _value(span: Range | None) -> str:
    return "?" if span is None else f"{span.middle:.3g}"
