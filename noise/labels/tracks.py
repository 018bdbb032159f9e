"""Label tracks: drawing of labels over time, and files for Audacity.

The format is that of Audacity's manual, "Importing and Exporting Labels": times in seconds with a
decimal point, fields separated by tabs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from models.drawing import axes_or_new
from models.errors import ParameterError
from noise.base.files import atomic, export_paths
from noise.base.labels import DARK_LABELS, LABEL_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MOST_TRACKS = 40
"""Maximum number of rows in a picture."""

_HEIGHT = 0.7
_NAMED = 0.08
"""Minimum share of the axis of a bar with its label in it."""


def draw_tracks(
    tracks: Mapping[str, Sequence[tuple[float, float, str]]], ax: Axes | None = None
) -> Axes:
    """Draw labels over time.

    Parameters
    ----------
    tracks : mapping of str to sequence of (float, float, str)
        Start [s], end [s] and label of each stretch, by the name of its row; the first row is on
        top, and at most `MOST_TRACKS` are drawn.
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
        present = {label for _, _, label in stretches}
        axes.legend(
            handles=[
                Patch(facecolor=colour, edgecolor="#444444", label=label)
                for label, colour in LABEL_COLOURS.items()
                if label in present
            ],
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=len(present),
        )
    return axes


def label_track(rows: Iterable[Mapping[str, object]]) -> str:
    r"""Return the text of the label track of a recording.

    Parameters
    ----------
    rows : iterable of mapping
        Its rows of the label table; those without a label are ignored.

    Examples
    --------
    >>> row = {"channel": "all", "start_s": 0.5, "end_s": 2.25, "label": "creak"}
    >>> label_track([row, row | {"channel": "2"}])
    '0.500000\t2.250000\tcreak\n0.500000\t2.250000\ttrack 2: creak\n'
    """
    lines = []
    for row in rows:
        start, end, channel = row["start_s"], row["end_s"], row["channel"]
        if row["label"] is None or not isinstance(start, float) or not isinstance(end, float):
            continue
        track = "" if channel in ("all", None) else f"track {channel}: "
        lines.append(f"{start:.6f}\t{end:.6f}\t{track}{row['label']}\n")
    return "".join(lines)


def write_label_tracks(target: Path, rows: Sequence[Mapping[str, object]]) -> list[Path]:
    """Write the label track of each recording of a table, each file atomically.

    Parameters
    ----------
    target : Path
        As for `noise.base.files.export_paths`, of .txt.
    rows : sequence of mapping
        Of the label table.

    Returns
    -------
    list of Path
        The written files; refused recordings have none.
    """
    grouped: dict[str, list[Mapping[str, object]]] = {}
    for row in rows:
        if row["label"] is not None:
            grouped.setdefault(str(row["file"]), []).append(row)
    paths = export_paths(target, list(grouped), (".txt",), "--audacity")
    for file, of_file in grouped.items():
        with atomic(paths[file]) as temporary:
            temporary.write_text(label_track(of_file), encoding="utf-8", newline="\n")
    return list(paths.values())
