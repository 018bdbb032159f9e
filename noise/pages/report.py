"""Report of recordings: labels, facts, sounds and figures on one page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.recording import Recording
from models.show import short_repr
from noise.audio.sound import audible
from noise.audio.spectrogram import recorded_levels
from noise.labels.rows import label_rows
from noise.pages import blocks as b
from noise.pages.cards import facts_of
from noise.pages.clips import RATE, Entry, common_gain, labels_sentence, make_clips
from noise.pages.figures import recording_panels
from noise.pages.page import page_html, write_page

if TYPE_CHECKING:
    from noise.labels.segments import Segment


@short_repr
@dataclass(frozen=True)
class ReportEntry:
    """Recording of a report.

    Parameters
    ----------
    title : str
    recording : Recording
        Recording whose first sound pressure is played.
    segment : Segment
        Label and its interval.
    note : str
        Remark on the card.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.labels.segments import Segment
    >>> hum = Recording(np.zeros((1, 48000)), 48e3, (Channel("pressure"),))
    >>> ReportEntry("run07", hum, Segment("all", 0.0, 1.0, "none", {}, None, 30.0, -90.0)).title
    'run07'
    """

    title: str
    recording: Recording
    segment: Segment
    note: str = ""


_COLUMNS = {
    "speed": "Speed",
    "interference": "Interference",
    "stiffness": "Support stiffness",
    "material": "Material",
    "level": "Level",
    "frequency": "Frequency",
}
"""Columns of the overview table: fact and heading."""


def write_report(
    path: str | Path, entries: Sequence[ReportEntry], *, title: str, summary: str | None = None
) -> None:
    """Write a report as one self-contained HTML file, atomically.

    Parameters
    ----------
    path : path-like
        The file to write; parent folders are made.
    entries : sequence of ReportEntry
        At least one, shown in this order; calibrated sounds share one gain.
    title : str
        Of the page.
    summary : str, optional
        The headline sentence; by default how many recordings have which label.

    Raises
    ------
    ParameterError
        There are no entries, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> from noise.labels.segments import Segment
    >>> silence = Recording(np.zeros((1, 4800)), 48e3, (Channel("pressure"),))
    >>> segment = Segment(channel="all", start=0.0, end=0.1, label="none",
    ...     probabilities={"none": 1.0}, frequency=None, level=None, level_dbfs=None)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "report.html"
    ...     write_report(path, [ReportEntry("Silence", silence, segment)], title="Review")
    ...     "<h1>Review</h1>" in path.read_text(encoding="utf-8")
    True
    """
    if not entries:
        raise ParameterError(f"{path}: there is no entry to report; give at least one")
    on_page = {f"s{number}": _entry(entry) for number, entry in enumerate(entries, 1)}
    gain = common_gain(on_page.values())
    clips, _ = make_clips(on_page, gain)
    rows: list[list[b.Cell | str]] = []
    for key, entry in on_page.items():
        facts = facts_of(entry)
        labels = b.Cell(labels=tuple((label, "") for label in entry.labels))
        columns = [facts[name].words if name in facts else "" for name in _COLUMNS]
        rows.append([b.Cell(entry.title, link=f"card-{key}"), labels, *columns])
    panels = recording_panels([(one.recording, one.segment) for one in entries])
    names = ["Recording", "Label", *_COLUMNS.values()]
    more = {key: [panel] for key, panel in zip(on_page, panels, strict=True)}
    html = page_html(
        "report",
        title,
        [
            b.Text(summary or f"{labels_sentence(list(on_page.values()))}.", "summary"),
            b.Sounds(gain.sentences if clips else ()),
        ],
        [
            b.Section("Overview", [b.Table(names, rows, name="All recordings", style="overview")]),
            b.Section("Recordings", [b.Cards(list(on_page), "single", more=more)], "recordings"),
        ],
        footer="Autospectra of one kind of channel share their axes on this page. Time histories "
        "have a scale of their own, which spans no less than a twentieth of the largest of their "
        "kind.",
        entries=on_page,
        clips=clips,
    )
    write_page(Path(path), html)


def _entry(entry: ReportEntry) -> Entry:
    recording, has_sound = entry.recording, entry.recording.first("pressure") is not None
    return Entry(
        entry.title,
        tuple(label_rows(entry.title, recording, [entry.segment])),
        recording.condition,
        recording.duration,
        audible(recording, RATE).astype(np.float32) if has_sound else None,
        calibrated=recording.calibrated,
        note=entry.note,
        fast_levels=recorded_levels(recording) if has_sound else None,
    )
