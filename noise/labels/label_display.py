"""Display of labels: a line a file, bars over time, tables in HTML, what conditions rely on."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from models.drawing import axes_or_new
from models.errors import ParameterError
from noise.base.label_looks import DARK_LABELS, LABEL_COLOURS
from noise.base.label_names import NAMED

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from matplotlib.axes import Axes


ASSUMED = "assuming a fluorocarbon bushing like the shipped one"
"""What inferred conditions say of themselves where no material was logged."""

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


def assumes_material(row: Mapping[str, object]) -> bool:
    """Whether a row of the label table has inferred conditions, and no material to rely on.

    Examples
    --------
    >>> row = {"speed_rad_s_source": "inferred", "material_source": "missing"}
    >>> assumes_material(row), assumes_material(row | {"material_source": "logged"})
    (True, False)
    """
    sources = (value for column, value in row.items() if column.endswith("_source"))
    return "inferred" in sources and row.get("material_source") != "logged"


def naming_row(rows: Sequence[Mapping[str, object]]) -> Mapping[str, object] | None:
    """Return the longest row that is not ``none``, by which a file is named.

    Examples
    --------
    >>> short = {"label": "creak", "start_s": 0.0, "end_s": 1.0}
    >>> naming_row([short, {"label": "none", "start_s": 1.0, "end_s": 9.0}])["label"]
    'creak'
    """
    labelled = [row for row in rows if row.get("label") is not None]
    loud = [row for row in labelled if row["label"] != "none"]
    return max(loud or labelled, key=_length, default=None)


def labels_in(rows: Sequence[Mapping[str, object]]) -> tuple[str, ...]:
    """Return all labels of a recording: the one that names it, then by their longest row.

    ``none`` comes last.

    Examples
    --------
    >>> short = {"label": "creak", "start_s": 0.0, "end_s": 1.0}
    >>> long = {"label": "squeal", "start_s": 1.0, "end_s": 3.0}
    >>> labels_in([{"label": "none", "start_s": 3.0, "end_s": 9.0}, short, long])
    ('squeal', 'creak', 'none')
    """
    longest: dict[str, float] = {}
    for row in rows:
        if row["label"] is not None:
            label = str(row["label"])
            longest[label] = max(_length(row), longest.get(label, 0.0))
    return tuple(sorted(longest, key=lambda label: (label == "none", -longest[label])))


def result_lines(rows: Iterable[Mapping[str, object]]) -> Iterator[str]:
    """Yield one line a file: its label, frequency, level, place in time and probability.

    Parameters
    ----------
    rows : iterable of mapping
        Of the label table, those of one file behind one another.

    Yields
    ------
    str
        Of the segment that names the file, and of the longest of each other noise in it; or why
        it was refused.

    Examples
    --------
    >>> row = {"file": "run07.wav", "label": "squeal", "start_s": 1.99, "end_s": 6.01,
    ...        "frequency_hz": 974.2, "level_dba": 59.9, "p_squeal": 0.93}
    >>> list(result_lines([row, {"file": "b.wav", "label": None, "error": "is empty"}]))
    ['run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.93', 'b.wav  refused: is empty']
    """
    for file, of_file in groupby(rows, key=lambda row: row["file"]):
        segments = list(of_file)
        row = naming_row(segments)
        if row is None:
            yield f"{file}  refused: {segments[0].get('error')}"
            continue
        also = ""
        for label in labels_in(segments)[1:]:
            other = naming_row([one for one in segments if one["label"] == label])
            if label in NAMED and other is not None:
                also += f"  also {'  '.join(_result_words(other))}"
        yield f"{file}  {'  '.join(_result_words(row))}{also}"


def _result_words(row: Mapping[str, object]) -> Iterator[str]:
    label, hertz, start, end = (row.get(c) for c in ("label", "frequency_hz", "start_s", "end_s"))
    yield f"{label} {hertz:.0f} Hz" if isinstance(hertz, float) else str(label)
    for column, unit in (("level_dba", "dB(A)"), ("level_dbfs", "dBFS")):
        level = row.get(column)
        if isinstance(level, float):
            yield f"{level:.1f} {unit}"
            break
    if isinstance(start, float) and isinstance(end, float):
        yield f"{start:.2f}-{end:.2f} s"
    probability = row.get(f"p_{label}")
    if row.get("label_source") == "human":
        yield "by hand"
    elif isinstance(probability, float):
        # `unknown` may be the less likely: a noise that is likelier was not likely enough.
        noises = [(p, name) for name in NAMED if isinstance(p := row.get(f"p_{name}"), float)]
        p, name = max(noises, default=(0.0, ""))
        less = label == "unknown" and p > probability
        yield f"p {probability:.2f}" + (f" ({name} {p:.2f})" if less else "")


def _length(row: Mapping[str, object]) -> float:
    start, end = row.get("start_s"), row.get("end_s")
    if isinstance(start, int | float) and isinstance(end, int | float):
        return float(end - start)
    return 0.0
