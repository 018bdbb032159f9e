"""The report: recordings to see, to hear and to compare, each with all that is known of it.

Sounds are played as they were given, at their own rates and gains. Whether they may be compared by
ear depends on the gain, so the page says what full scale is worth, and whether it is the same for
all.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import soundfile

from models.errors import ParameterError, RecordingError
from models.recording import Recording
from models.show import short_repr
from noise.audio.sound import resampled
from noise.base.labels import LABELS
from noise.diagnosis.text.words import percent
from noise.pages import blocks as b
from noise.pages.cards import Fact, facts_of
from noise.pages.clips import RATE, Clip, Entry, full_scale_words, labels_sentence
from noise.pages.figures import entry_figures
from noise.pages.page import page_html, write_page
from noise.pictures.recording import recorded_levels, recorded_orders

if TYPE_CHECKING:
    from noise.labels.segments import Segment


_SAME_LENGTH = 0.02
"""By how much a sound and the recording that it was made of differ in length at most [s]."""

_LAST_BIT = 2.0**-15  # of 16; a sound that exceeds full scale by no more is not clipped audibly


@short_repr
@dataclass(frozen=True)
class ReportEntry:
    """One recording on the review page.

    Parameters
    ----------
    title : str
    recording : Recording
    segment : Segment
        What the recording was labelled, and for which part of it.
    audio : Path or bytes, optional
        The sound to play, a file in any format that the sound library reads, or its content.
    note : str
        A remark shown with the entry; line breaks are kept.
    full_scale : float, optional
        What full scale of `audio` is worth [Pa]; without it the page says that it is not known.

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
    audio: Path | bytes | None = None
    note: str = ""
    full_scale: float | None = None


def write_report(
    path: str | Path, entries: Sequence[ReportEntry], *, title: str, summary: str | None = None
) -> None:
    """Write a review page: one HTML file that needs nothing else, whole or not at all.

    Parameters
    ----------
    path : path-like
        The file to write; parent folders are made.
    entries : sequence of ReportEntry
        At least one, shown in this order.
    title : str
        Of the page.
    summary : str, optional
        The headline sentence; by default how many recordings have which label.

    Raises
    ------
    ParameterError
        There are no entries, the file cannot be written, or a sound exceeds full scale.
    RecordingError
        A sound cannot be read.

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
    keys = [f"s{number}" for number in range(1, len(entries) + 1)]
    clips = {
        key: _clip(entry, entry.audio)
        for key, entry in zip(keys, entries, strict=True)
        if entry.audio is not None
    }
    on_page = {key: _entry(entry, clips.get(key)) for key, entry in zip(keys, entries, strict=True)}
    figures = entry_figures([(one.recording, one.segment) for one in entries])
    shown = {key: facts_of(entry) for key, entry in on_page.items()}
    more: dict[str, list[b.Block]] = {}
    rows: list[list[b.Cell | str]] = []
    for (key, facts), entry, figure in zip(shown.items(), entries, figures, strict=True):
        label = entry.segment.label
        columns = ["" if one not in facts else facts[one].words for one in _COLUMNS]
        rows.append(
            [b.Cell(entry.title, link=f"card-{key}"), b.Cell(labels=((label, ""),)), *columns]
        )
        more[key] = [
            b.Table(("Known", "Value"), _known_rows(entry, facts, clips.get(key)), style="known"),
            _probabilities(entry.segment),
            b.Panels(figure.panels, figure.caption),
        ]
    if summary is None:
        summary = f"{labels_sentence(list(on_page.values()))}."
    names = ["Recording", "Label", *_NAMES.values()]
    html = page_html(
        "report",
        title,
        [b.Text(summary, "summary"), b.Sounds(_common_gain(entries))],
        [
            b.Section("Overview", [b.Table(names, rows, name="All recordings", style="overview")]),
            b.Section("Recordings", [b.Cards(keys, "single", more=more)], "recordings"),
        ],
        footer="Autospectra of one kind of channel share their axes on this page. Time histories "
        "have a scale of their own, which spans no less than a twentieth of the largest of their "
        "kind.",
        entries=on_page,
        clips=clips,
    )
    write_page(Path(path), html)


_COLUMNS = ("speed", "interference", "stiffness", "material", "level", "frequency")
_NAMES = {name: name.capitalize() for name in _COLUMNS} | {"stiffness": "Support stiffness"}


def _known_rows(
    entry: ReportEntry, facts: Mapping[str, Fact], clip: Clip | None
) -> list[tuple[str, str]]:
    """Return condition, level, frequency and gain, and that they are not known where they are."""
    rows = [
        (words, facts[name].words if name in facts else "not known")
        for name, words in (*list(_NAMES.items())[:4], ("temperature", "Temperature"))
    ]
    rows += [
        (_NAMES[name], facts[name].words if name in facts else "none") for name in _COLUMNS[4:]
    ]
    if "level" in facts and facts["level"].unit in ("dB", "dB(A)"):
        rows[5] = ("Level", f"{facts['level'].words} re 20 µPa")
    if entry.segment.channel != "all":
        rows.append(("Track", entry.segment.channel))
    gain = "gain not stated"
    if entry.full_scale is not None:
        gain = full_scale_words(entry.full_scale)
    rows.append(("Sound", "none to play" if clip is None else f"{clip.end:.3g} s; {gain}"))
    return rows


def _clip(entry: ReportEntry, audio: Path | bytes) -> Clip:
    """Encode a sound as it is; what is drawn of it is its first channel at the page's rate."""
    if isinstance(audio, bytes):
        name, content = f"sound of {entry.title!r}", audio
    else:
        name = str(audio)
        try:
            content = Path(audio).read_bytes()
        except OSError as error:
            raise RecordingError(f"{name}: cannot be read ({error.strerror or error})") from error
    try:
        samples, rate = soundfile.read(io.BytesIO(content), always_2d=True)
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{name}: is damaged or no sound file ({reason})") from error
    peak = float(abs(samples).max(initial=0.0))
    if not peak <= 1.0 + _LAST_BIT:
        raise ParameterError(
            f"{name}: peaks at {peak:.3g} times full scale and would be clipped; scale it to at "
            f"most 1"
        )
    flac = io.BytesIO()
    soundfile.write(flac, samples, rate, format="FLAC", subtype="PCM_16")
    full_scale = entry.full_scale or 1.0
    first = full_scale * (resampled(samples[:, 0], rate, RATE) if len(samples) else samples[:, 0])
    return Clip(flac.getvalue(), first.astype(np.float32), 0.0, len(samples) / rate, full_scale)


def _entry(entry: ReportEntry, clip: Clip | None) -> Entry:
    segment, recording = entry.segment, entry.recording
    row: dict[str, object] = {
        "label": segment.label, "channel": segment.channel, "start_s": segment.start,
        "end_s": segment.end, "frequency_hz": segment.frequency, "level_db": segment.level,
        "level_dba": segment.level_a, "level_dbfs": segment.level_dbfs,
    }  # fmt: skip
    if recording.condition.speed is None and recording.calibrated and "speed" in recording:
        speed = recording["speed"]
        row |= {
            "speed_rad_s_source": "varied",
            "speed_rad_s_low": float(speed.min()),
            "speed_rad_s_high": float(speed.max()),
        }
    calibrated = entry.full_scale is not None
    whole = clip is not None and abs(clip.end - recording.duration) < _SAME_LENGTH
    in_pascal = calibrated and recording.calibrated and recording.first("pressure") is not None
    return Entry(
        entry.title,
        (row,),
        recording.condition,
        duration=recording.duration if clip is None else clip.end,
        calibrated=calibrated,
        note=entry.note,
        orders=recorded_orders(recording) if in_pascal else None,
        fast_levels=recorded_levels(recording) if whole and in_pascal else None,
    )


def _common_gain(entries: Sequence[ReportEntry]) -> list[str]:
    gains = {entry.full_scale for entry in entries if entry.audio is not None}
    if not gains:
        return []
    if gains == {None}:
        return ["The gain of the sounds is not stated: do not compare their loudness."]
    (first, *others) = sorted(gain for gain in gains if gain is not None)
    if others or None in gains:
        return ["The sounds have different gains, stated with each: do not compare their loudness."]
    return [f"Sounds: {full_scale_words(first)}, the same for all sounds on this page."]


def _probabilities(segment: Segment) -> b.Table:
    """Return a table of the probability of each label."""
    rows = [
        (label, b.Cell(percent(share), bars=[b.Bar(0.0, 100.0 * share, label)]))
        for label in LABELS
        if (share := segment.probabilities.get(label)) is not None
    ]
    return b.Table(("Label", "Probability"), rows, style="shares")
