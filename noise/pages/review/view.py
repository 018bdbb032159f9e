"""Entries as a page shows them: cards with a picture, label tracks and what is known, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.recording import REFERENCE_PRESSURE
from noise.pages.review.spectrogram import HIGHEST, LOWEST, TICKS, line_levels, picture, top
from noise.pages.templating import as_base64

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from noise.pages.review.clips import Clip
    from noise.pages.review.entries import Entry

__all__ = ["Band", "Card", "Pictures", "card_of", "draw_pictures", "frequency_ticks"]

_MOST_TICKS = 6


@dataclass(frozen=True)
class Band:
    """A labelled stretch on a card: where, in per cent of the clip, and what."""

    left: float
    width: float
    label: str
    words: str


@dataclass(frozen=True)
class Card:
    """What the page shows of an entry.

    Parameters
    ----------
    id : str
    title : str
    label : str or None
    facts : tuple of str
        Condition, level and frequency.
    note : str
    sound : bool
        Whether there is something to be heard.
    duration : float
        Of the clip [s].
    tracks : tuple of (str, tuple of Band)
        Labels in time, by the track that they belong to.
    ticks : tuple of (float, str)
        Of the time axis: per cent of the clip, and seconds of the recording.
    alt : str
        What the spectrogram shows.
    """

    id: str
    title: str
    label: str | None
    facts: tuple[str, ...]
    note: str
    sound: bool
    duration: float
    tracks: tuple[tuple[str, tuple[Band, ...]], ...]
    ticks: tuple[tuple[float, str], ...]
    alt: str


@dataclass(frozen=True)
class Pictures:
    """Spectrograms by id, as ``data:`` addresses, and the levels of their darkest colours."""

    by_id: Mapping[str, str]
    top: float | None
    top_dbfs: float | None


def draw_pictures(entries: Mapping[str, Entry], clips: Mapping[str, Clip]) -> Pictures:
    """Draw spectrograms; calibrated ones share their colours, and so do the others."""
    uris: dict[str, str] = {}
    tops: dict[bool, float | None] = {}
    for calibrated in (True, False):
        levels = {
            key: line_levels(clip.samples, REFERENCE_PRESSURE if calibrated else 1.0)
            for key, clip in clips.items()
            if entries[key].calibrated == calibrated
        }
        tops[calibrated] = top(list(levels.values())) if levels else None
        highest = tops[calibrated] or 0.0
        for key, one in levels.items():
            uris[key] = f"data:image/png;base64,{as_base64(picture(one, highest))}"
    return Pictures(uris, tops[True], tops[False])


def frequency_ticks() -> tuple[tuple[float, str], ...]:
    """Where the spectrograms' frequencies stand, in per cent from the bottom.

    Examples
    --------
    >>> frequency_ticks()[0]
    (11.57, '100')
    """
    span = math.log(HIGHEST / LOWEST)
    return tuple(
        (round(100.0 * math.log(hertz / LOWEST) / span, 2), words) for hertz, words in TICKS.items()
    )


def card_of(key: str, entry: Entry, clip: Clip | None) -> Card:
    """Lay an entry out."""
    start = 0.0 if clip is None else clip.start
    end = entry.duration if clip is None else clip.end
    note = entry.note
    if clip is not None and end - start < entry.duration - 0.02:
        heard = (
            f"{_seconds(end - start)} s from {_seconds(start)} s of {_seconds(entry.duration)} s"
        )
        note = f"{heard}; {note}" if note else heard
    return Card(
        id=key,
        title=entry.title,
        label=entry.label,
        facts=_facts(entry),
        note=note,
        sound=clip is not None,
        duration=end - start,
        tracks=_tracks(entry, start, end) if end > start else (),
        ticks=_time_ticks(start, end) if clip is not None else (),
        alt=_alt(entry, start, end),
    )


def _facts(entry: Entry) -> tuple[str, ...]:
    row = entry.row or {}
    condition = entry.condition
    told = [
        _fact(row, "speed_rad_s", condition.speed, 1.0, "rad/s"),
        _fact(row, "interference_mm", condition.interference, 1e3, "mm"),
        _fact(row, "support_stiffness_Nm_rad", condition.support_stiffness, 1.0, "Nm/rad"),
        str(row.get("material") or condition.material or ""),
        "" if condition.temperature is None else f"{condition.temperature:.3g} °C",
        _value(row, "frequency_hz", ".0f", "Hz"),
        _value(row, "level_db", ".1f", "dB") or _value(row, "level_dbfs", ".1f", "dBFS"),
    ]
    return tuple(filter(None, told))


def _fact(
    row: Mapping[str, object], column: str, logged: float | None, scale: float, unit: str
) -> str:
    value, source = row.get(column), row.get(f"{column}_source")
    if source == "inferred":
        low, high = row.get(f"{column}_low"), row.get(f"{column}_high")
        if isinstance(low, float) and isinstance(high, float):
            return f"{_plain(low, 2)} to {_plain(high, 2)} {unit} (inferred)"
    if not isinstance(value, int | float):
        value = None if logged is None else scale * logged
    if value is None:
        return ""
    return "clamp fixed" if math.isinf(value) else f"{_plain(value)} {unit}"


def _value(row: Mapping[str, object], column: str, form: str, unit: str) -> str:
    value = row.get(column)
    if not isinstance(value, int | float):
        return ""
    return f"{value:{form}} {unit}".replace("-", "\N{MINUS SIGN}")


def _plain(value: float, digits: int = 4) -> str:
    words = "fixed" if math.isinf(value) else f"{value:.{digits}g}"
    return words.replace("-", "\N{MINUS SIGN}")


def _tracks(entry: Entry, start: float, end: float) -> tuple[tuple[str, tuple[Band, ...]], ...]:
    tracks: dict[str, list[Band]] = {}
    for part in entry.parts:
        low, high = max(part.start, start), min(part.end, end)
        if high <= low:
            continue
        left, width = 100.0 * (low - start) / (end - start), 100.0 * (high - low) / (end - start)
        words = f"{part.label}, {_seconds(part.start)} to {_seconds(part.end)} s"
        band = Band(round(left, 3), round(width, 3), part.label, words)
        tracks.setdefault(part.track, []).append(band)
    return tuple((track, tuple(bands)) for track, bands in tracks.items())


def _time_ticks(start: float, end: float) -> tuple[tuple[float, str], ...]:
    length = end - start
    least = length / _MOST_TICKS
    decade = 10.0 ** math.floor(math.log10(least))
    step = next(s * decade for s in (1, 2, 5, 10) if least <= s * decade * (1 + 1e-9))
    first, last = math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9)
    return tuple(
        (round(100.0 * (n * step - start) / length, 2), f"{n * step:.6g}")
        for n in range(first, last + 1)
    )


def _alt(entry: Entry, start: float, end: float) -> str:
    parts = [f"{p.label} from {_seconds(p.start)} to {_seconds(p.end)} s" for p in entry.parts]
    labels = f": {'; '.join(parts[:6])}" if parts else ""
    more = " and more" if len(parts) > 6 else ""
    return f"Spectrogram of {entry.title}, {_seconds(start)} to {_seconds(end)} s{labels}{more}"


def _seconds(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")


def scale_words(pictures: Pictures, width: float) -> Sequence[str]:
    """Say what the colours of the spectrograms are worth."""
    told = []
    if pictures.top is not None:
        told.append(f"{pictures.top - width:.0f} to {pictures.top:.0f} dB re 20 µPa")
    if pictures.top_dbfs is not None:
        told.append(f"{pictures.top_dbfs - width:.0f} to {pictures.top_dbfs:.0f} dBFS")
    return [words.replace("-", "\N{MINUS SIGN}") for words in told]
