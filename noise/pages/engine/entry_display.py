"""Entries as a page shows them: cards with a picture, label tracks and what is known, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.recording import REFERENCE_PRESSURE
from noise.audio.spectrogram import HIGHEST, LOWEST, spectrogram
from noise.labels.label_display import ASSUMED, assumes_material
from noise.pages.engine.entry import RATE
from noise.pages.engine.over_time import level_displays, orders_display
from noise.pages.engine.spectrogram import RANGE, TICKS, picture, top
from noise.pages.engine.ticks import round_ticks

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.pages.engine.clips import Clip
    from noise.pages.engine.entry import RATE, Entry, Row
from noise.pages.engine.over_time import LevelDisplay, OrdersDisplay

__all__ = [
    "Band", "EntryDisplay", "Fact", "draw_entries", "entry_display", "facts_of", "frequency_ticks",
]  # fmt: skip

_MOST_TICKS = 6


class Fact(NamedTuple):
    """What is known of a condition or of a noise: a number in words, and its unit."""

    text: str
    unit: str = ""

    @property
    def words(self) -> str:
        """Number and unit, as they stand in a line of facts."""
        return "clamp fixed" if self.text == "fixed" else f"{self.text} {self.unit}".strip()


class Band(NamedTuple):
    """A labelled stretch on a card: where, in per cent of the clip, and what."""

    left: float
    width: float
    label: str
    words: str


@dataclass(frozen=True)
class EntryDisplay:
    """What a page shows of an entry.

    Parameters
    ----------
    id : str
    title : str
    labels : tuple of str
        All in it, the longest first.
    facts : dict of str to Fact
        Those known of ``speed``, ``interference``, ``stiffness``, ``material``, ``temperature``,
        ``frequency`` and ``level``.
    note : str
    picture : bytes
        Spectrogram, a PNG file; empty where there is nothing to be heard.
    duration : float
        Of the clip [s].
    tracks : tuple of (str, tuple of Band)
        Labels in time, by the track that they belong to.
    ticks : tuple of (float, str)
        Of the time axis: share of the clip [%], and seconds of the recording.
    alt : str
        What the spectrogram shows.
    level : LevelDisplay, optional
        A-weighted, Fast, over the time of the clip.
    orders : OrdersDisplay, optional
    """

    id: str
    title: str
    labels: tuple[str, ...]
    facts: dict[str, Fact]
    note: str
    picture: bytes
    duration: float
    tracks: tuple[tuple[str, tuple[Band, ...]], ...]
    ticks: tuple[tuple[float, str], ...]
    alt: str
    level: LevelDisplay | None = None
    orders: OrdersDisplay | None = None


def draw_entries(
    entries: Mapping[str, Entry], clips: Mapping[str, Clip]
) -> tuple[dict[str, EntryDisplay], list[str]]:
    """Lay entries out; calibrated spectrograms share their colours, and so do the others.

    Parameters
    ----------
    entries : mapping of str to Entry
        By id.
    clips : mapping of str to Clip
        Of those that can be heard.

    Returns
    -------
    displays : dict of str to EntryDisplay
    scale_words : list of str
        What the colours are worth.

    Examples
    --------
    >>> from noise.pages.engine.entry import Entry
    >>> displays, scale_words = draw_entries({"s1": Entry("run07")}, {})
    >>> displays["s1"].title, scale_words
    ('run07', [])
    """
    pictures: dict[str, bytes] = {}
    over_time: dict[str, LevelDisplay] = {}
    orders: dict[str, OrdersDisplay] = {}
    scale_words = []
    for calibrated, reference, unit in ((True, REFERENCE_PRESSURE, "dB re 20 µPa"),
                                        (False, 1.0, "dBFS")):  # fmt: skip
        of_it = {key: clip for key, clip in clips.items() if entries[key].calibrated == calibrated}
        levels = {key: _levels(clip, reference) for key, clip in of_it.items()}
        unit_a = "dB(A)" if calibrated else "dBFS(A)"
        measured = {key: known for key in of_it if (known := entries[key].fast_levels) is not None}
        over_time |= level_displays(of_it, RATE, reference, unit_a, measured)
        if levels:
            highest = top(list(levels.values()))
            pictures |= {key: picture(one, highest) for key, one in levels.items()}
            orders |= {
                key: orders_display(found, highest)
                for key in levels
                if (found := entries[key].orders) is not None
            }
            words = f"{highest - RANGE:.0f} to {highest:.0f} {unit}"
            scale_words.append(words.replace("-", "\N{MINUS SIGN}"))
    displays = {
        key: replace(
            entry_display(key, entry, clips.get(key), pictures.get(key, b"")),
            level=over_time.get(key),
            orders=orders.get(key),
        )
        for key, entry in entries.items()
    }
    return displays, scale_words


def _levels(clip: Clip, reference: float) -> NDArray[np.float64]:
    def read(first: int, last: int) -> NDArray[np.float32]:
        return clip.samples[first:last]

    return spectrogram(read, clip.samples.size, RATE, reference)


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


def entry_display(key: str, entry: Entry, clip: Clip | None, picture: bytes) -> EntryDisplay:
    """Lay an entry out.

    Examples
    --------
    >>> from noise.pages.engine.entry import Entry
    >>> entry_display("s1", Entry("run07", note="no sound"), None, b"").note
    'no sound'
    """
    start = 0.0 if clip is None else clip.start
    end = entry.duration if clip is None else clip.end
    note = entry.note
    if clip is not None and end - start < entry.duration - 0.02:
        heard = (
            f"{_seconds(end - start)} s from {_seconds(start)} s of {_seconds(entry.duration)} s"
        )
        note = f"{heard}; {note}" if note else heard
    ticks = round_ticks(start, end, _MOST_TICKS) if clip is not None and end > start else []
    return EntryDisplay(
        id=key,
        title=entry.title,
        labels=entry.labels,
        facts=facts_of(entry),
        note=note,
        picture=picture,
        duration=end - start,
        tracks=_tracks(entry, start, end) if end > start else (),
        ticks=tuple((_per_cent(tick, start, end), f"{tick:.6g}") for tick in ticks),
        alt=_alt(entry, start, end),
    )


def facts_of(entry: Entry) -> dict[str, Fact]:
    """Return what is known of an entry, the label table before the recording.

    Examples
    --------
    >>> from models.condition import FIXED, Condition
    >>> from noise.pages.engine.entry import Entry
    >>> facts = facts_of(Entry("run07", condition=Condition(5.0, 0.279e-3, FIXED)))
    >>> [fact.words for fact in facts.values()]
    ['5 rad/s', '0.279 mm', 'clamp fixed']
    """
    row, condition = entry.row or {}, entry.condition
    fit, temperature = condition.interference, condition.temperature
    hertz = row.get("frequency_hz")
    material = str(row.get("material") or condition.material or "")
    if not material and assumes_material(row):
        material = ASSUMED
    facts = {
        "speed": _condition_fact(row, "speed_rad_s", condition.speed, "rad/s"),
        "interference": _condition_fact(
            row, "interference_mm", None if fit is None else 1e3 * fit, "mm"
        ),
        "stiffness": _condition_fact(
            row, "support_stiffness_Nm_rad", condition.support_stiffness, "Nm/rad"
        ),
        "material": Fact(material) if material else None,
        "temperature": None if temperature is None else _number(temperature, ".3g", "°C"),
        "frequency": _number(hertz, ".0f" if _at_least(hertz, 100.0) else ".1f", "Hz"),
        "level": _number(row.get("level_dba"), ".1f", "dB(A)")
        or _number(row.get("level_db"), ".1f", "dB")
        or _number(row.get("level_dbfs"), ".1f", "dBFS"),
    }
    return {name: fact for name, fact in facts.items() if fact is not None}


def _condition_fact(row: Row, column: str, logged: float | None, unit: str) -> Fact | None:
    low, high = row.get(f"{column}_low"), row.get(f"{column}_high")
    source = row.get(f"{column}_source")
    if source in ("inferred", "varied") and isinstance(low, float) and isinstance(high, float):
        digits = ".2g" if source == "inferred" else ".3g"
        words = f"{_plain(low, digits)} to {_plain(high, digits)}"
        return Fact(words, f"{unit} (inferred)" if source == "inferred" else unit)
    value = row.get(column)
    return _number(value if isinstance(value, int | float) else logged, ".5g", unit)


def _number(value: object, form: str, unit: str) -> Fact | None:
    if not isinstance(value, int | float):
        return None
    return Fact("fixed") if math.isinf(value) else Fact(_plain(value, form), unit)


def _plain(value: float, form: str) -> str:
    words = "fixed" if math.isinf(value) else f"{value:{form}}"
    if "e+" in words:  # 3400 rather than 3.4e+03
        words = f"{float(words):.0f}"
    return words.replace("-", "\N{MINUS SIGN}")


def _at_least(value: object, least: float) -> bool:
    return isinstance(value, int | float) and value >= least


def _tracks(entry: Entry, start: float, end: float) -> tuple[tuple[str, tuple[Band, ...]], ...]:
    tracks: dict[str, list[Band]] = {}
    for part in entry.parts:
        low, high = max(part.start, start), min(part.end, end)
        if high <= low:
            continue
        words = f"{part.label}, {_seconds(part.start)} to {_seconds(part.end)} s"
        width = round(100.0 * (high - low) / (end - start), 3)
        band = Band(_per_cent(low, start, end, 3), width, part.label, words)
        tracks.setdefault(part.track, []).append(band)
    return tuple((track, tuple(bands)) for track, bands in tracks.items())


def _per_cent(value: float, start: float, end: float, digits: int = 2) -> float:
    return round(100.0 * (value - start) / (end - start), digits)


def _alt(entry: Entry, start: float, end: float) -> str:
    parts = [f"{p.label} from {_seconds(p.start)} to {_seconds(p.end)} s" for p in entry.parts]
    labels = f": {'; '.join(parts[:6])}" if parts else ""
    more = " and more" if len(parts) > 6 else ""
    return f"Spectrogram of {entry.title}, {_seconds(start)} to {_seconds(end)} s{labels}{more}"


def _seconds(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
