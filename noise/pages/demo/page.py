"""The review page: recordings to see, to hear and to compare, in one HTML file.

Such a page is mailed, projected in a meeting and opened again after years. So everything is inside
it, and the page itself forbids the browser to fetch anything from elsewhere. Sounds are 16-bit WAV,
which every browser plays and no decoder alters; whether they may be compared by ear depends on
their gain, so the page says what full scale is worth, and whether it is the same for all.
"""

from __future__ import annotations

import io
import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import soundfile

from models.errors import ParameterError, RecordingError
from models.recording import REFERENCE_PRESSURE
from noise.base.atomic import atomic
from noise.base.label_names import LABELS
from noise.pages.figures import entry_figures
from noise.pages.templating import as_base64, template

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.recording import Recording
    from noise.labels.segments import Segment
    from noise.pages.figures import EntryFigure

__all__ = ["ReportEntry", "write_report"]

_LAST_BIT = 2.0**-15  # of 16; a sound that exceeds full scale by no more is not clipped audibly


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
    >>> from noise.labels import Segment
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


@dataclass(frozen=True)
class _Sound:
    uri: str
    length: str
    gain: str


@dataclass(frozen=True)
class _Section:
    entry: ReportEntry
    values: dict[str, str]
    probabilities: list[tuple[str, float, str]]  # label, share, share in words
    sound: _Sound | None
    figure: EntryFigure


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
    >>> import numpy as np
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
    sounds = [_sound(entry) for entry in entries]
    figures = entry_figures([(entry.recording, entry.segment) for entry in entries])
    sections = [
        _Section(entry, _values(entry), _probabilities(entry.segment), sound, figure)
        for entry, sound, figure in zip(entries, sounds, figures, strict=True)
    ]
    html = template("report.html.j2").render(
        title=title,
        summary=_counts(entries) if summary is None else summary,
        gain=_common_gain(entries),
        sections=sections,
    )
    with atomic(path) as temporary:
        # Names of files may hold what no UTF-8 can.
        temporary.write_bytes(html.encode("utf-8", "backslashreplace"))


def _sound(entry: ReportEntry) -> _Sound | None:
    if entry.audio is None:
        return None
    if isinstance(entry.audio, bytes):
        name, content = f"sound of {entry.title!r}", entry.audio
    else:
        name = str(entry.audio)
        try:
            content = Path(entry.audio).read_bytes()
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
    wav = io.BytesIO()
    soundfile.write(wav, samples, rate, format="WAV", subtype="PCM_16")
    return _Sound(
        uri=f"data:audio/wav;base64,{as_base64(wav.getvalue())}",
        length=f"{len(samples) / rate:.3g} s",
        gain="not stated" if entry.full_scale is None else _full_scale(entry.full_scale),
    )


def _full_scale(value: float) -> str:
    peak_level = 20.0 * math.log10(value / REFERENCE_PRESSURE)
    return f"full scale = {value:.3g} Pa ({peak_level:.0f} dB peak re 20 µPa)"


def _common_gain(entries: Sequence[ReportEntry]) -> str:
    gains = {entry.full_scale for entry in entries if entry.audio is not None}
    if not gains:
        return ""
    if gains == {None}:
        return "The gain of the sounds is not stated: do not compare their loudness."
    (first, *others) = sorted(gain for gain in gains if gain is not None)
    if others or None in gains:
        return "The sounds have different gains, stated with each: do not compare their loudness."
    return f"Sounds: {_full_scale(first)}, the same for all sounds on this page."


def _values(entry: ReportEntry) -> dict[str, str]:
    """Write what is known of a recording, in the units that the page states."""
    condition, segment = entry.recording.condition, entry.segment
    values = {"speed": _speed(entry.recording)}
    if condition.interference is not None:
        values["interference"] = f"{1e3 * condition.interference:.4g}"
    if condition.support_stiffness is not None:
        fixed = math.isinf(condition.support_stiffness)
        values["stiffness"] = "fixed" if fixed else f"{condition.support_stiffness:.5g}"
    values["material"] = condition.material or ""
    if condition.temperature is not None:
        values["temperature"] = f"{condition.temperature:.3g}"
    if segment.level is not None:
        values["level"] = f"{segment.level:.1f}"
    elif segment.level_dbfs is not None:
        values["level"] = f"{segment.level_dbfs:.1f} dBFS"
    if segment.frequency is not None:
        values["frequency"] = f"{segment.frequency:.{0 if segment.frequency >= 100 else 1}f}"
    return {
        name: value if name == "material" else value.replace("-", "\N{MINUS SIGN}")
        for name, value in values.items()
        if value
    }


def _speed(recording: Recording) -> str:
    if recording.condition.speed is not None:
        return f"{recording.condition.speed:.4g}"
    if recording.calibrated and "speed" in recording:
        speed = recording["speed"]
        return f"{speed.min():.3g} to {speed.max():.3g}"
    return ""


def _probabilities(segment: Segment) -> list[tuple[str, float, str]]:
    return [
        (label, segment.probabilities[label], _percent(segment.probabilities[label]))
        for label in LABELS
        if label in segment.probabilities
    ]


def _percent(share: float) -> str:
    """No estimate is certain: what rounds to it is said to be near."""
    if 0.0 < share < 0.01:
        return "< 1 %"
    return "> 99 %" if 0.99 < share < 1.0 else f"{100 * share:.0f} %"


def _counts(entries: Sequence[ReportEntry]) -> str:
    counts = Counter(entry.segment.label for entry in entries)
    found = ", ".join(f"{counts[label]} {label}" for label in LABELS if counts[label])
    return f"{len(entries)} recording{'s' if len(entries) > 1 else ''}: {found}."
