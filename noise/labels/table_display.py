"""Labels that show themselves: the segments of one recording, and the table of many.

Both are the lists that programs take; what a notebook shows is added, nothing is changed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.html_table import html_table
from noise.labels.tracks import draw_tracks

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from noise.labels.segments import Segment

__all__ = ["LabelTable", "Segments"]


class Segments(list["Segment"]):
    """Labelled segments of a recording, in order of time, track by track.

    Examples
    --------
    >>> from noise.labels.segments import Segment
    >>> found = Segments([Segment("all", 0.0, 1.0, "creak", {"creak": 0.9}, 152.0, 78.0, None)])
    >>> found[0].label, "152 Hz" in found._repr_html_()
    ('creak', True)
    """

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the labels over time, one row a track.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There are none.
        """
        tracks: dict[str, list[tuple[float, float, str]]] = {}
        for one in self:
            tracks.setdefault(one.channel, []).append((one.start, one.end, one.label))
        return draw_tracks(tracks, ax)

    def _repr_html_(self) -> str:
        rows = [
            [
                one.label,
                f"{one.start:.2f} to {one.end:.2f} s",
                one.channel,
                f"{100 * one.probabilities[one.label]:.0f} %",
                "" if one.frequency is None else f"{one.frequency:.4g} Hz",
                _level(one.level, one.level_dbfs),
            ]
            for one in self
        ]
        header = ["label", "time", "channel", "probability", "frequency", "level"]
        return html_table("Labelled segments", rows, header=header)


class LabelTable(list[dict[str, object]]):
    """The label table of recordings: one row a segment, by `noise.labels.COLUMNS`.

    A table of pandas or polars is made of it as of any list of dictionaries.

    Examples
    --------
    >>> row = {"file": "run07.wav", "label": "creak", "start_s": 0.0, "end_s": 1.0, "error": None}
    >>> LabelTable([row, {"file": "b.wav", "label": None, "error": "is empty"}]).refused
    {'b.wav': 'is empty'}
    """

    @property
    def refused(self) -> dict[str, str]:
        """Why files could not be read, by file."""
        return {str(row["file"]): str(row["error"]) for row in self if row.get("error")}

    def write(self, path: str | Path) -> None:
        """Write the table, whole or not at all.

        Parameters
        ----------
        path : str or Path
            Ends in .csv, .jsonl or .parquet.

        Raises
        ------
        ParameterError
            No table can be written there.
        """
        from noise.base.tables import check_table_path, write_table
        from noise.labels.table import COLUMNS

        check_table_path(path)
        write_table(path, COLUMNS, self)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the labels over time, one row a file.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            Nothing is labelled.
        """
        tracks: dict[str, list[tuple[float, float, str]]] = {}
        for row in self:
            start, end, label = row["start_s"], row["end_s"], row["label"]
            if isinstance(start, float) and isinstance(end, float) and isinstance(label, str):
                track = "" if row["channel"] == "all" else f", track {row['channel']}"
                tracks.setdefault(f"{row['file']}{track}", []).append((start, end, label))
        return draw_tracks(tracks, ax)

    def _repr_html_(self) -> str:
        rows = [
            [
                str(row["file"]),
                str(row["label"] or f"refused: {row['error']}"),
                _time(row.get("start_s"), row.get("end_s")),
                _level(row.get("level_db"), row.get("level_dbfs")),
                _condition(row, "speed_rad_s", "rad/s"),
                _condition(row, "interference_mm", "mm"),
                _condition(row, "support_stiffness_Nm_rad", "Nm/rad"),
            ]
            for row in self
        ]
        header = ["file", "label", "time", "level", "speed", "interference", "support stiffness"]
        return html_table(f"Labels of {len({row['file'] for row in self})} files", rows,
                          header=header)  # fmt: skip


def _time(start: object, end: object) -> str:
    if isinstance(start, float) and isinstance(end, float):
        return f"{start:.2f} to {end:.2f} s"
    return ""


def _level(level: object, level_dbfs: object) -> str:
    if isinstance(level, float):
        return f"{level:.1f} dB"
    return f"{level_dbfs:.1f} dBFS" if isinstance(level_dbfs, float) else ""


def _condition(row: dict[str, object], column: str, unit: str) -> str:
    """Return a condition with its bounds where it is inferred."""
    value, low, high = (row.get(f"{column}{part}") for part in ("", "_low", "_high"))
    if not isinstance(value, float):
        return ""
    words = f"{value:.4g} {unit}"
    if isinstance(low, float) and isinstance(high, float):
        words += f" ({low:.4g} to {high:.4g})"
    return words
