"""Cards of a page: spectrogram, labels and facts of a sound.

A picture is the plain spectrogram over the whole duration of the clip, so a cursor needs only the
played fraction; the page draws the axes. Frequency is logarithmic. All pictures of a page share
their colours, dark on light for projectors and print.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.recording import REFERENCE_PRESSURE
from noise.audio.sound import RATE
from noise.audio.spectrogram import HIGHEST, LOWEST, spectrogram
from noise.labels.summary import ASSUMED, assumes_material
from noise.pages.clips import Clip, Entry, Row, number_or


def round_ticks(low: float, high: float, most: int) -> list[float]:
    """Return multiples of 1, 2 or 5 times a power of ten, about `most` of them from low to high.

    Parameters
    ----------
    low, high : float
        Ends of the axis, in its unit, such as [Hz].
    most : int
        Maximum number of steps.

    Examples
    --------
    >>> round_ticks(0.0, 7.9, 6), round_ticks(0.31, 0.36, 5)
    ([0.0, 2.0, 4.0, 6.0], [0.31, 0.32, 0.33, 0.34, 0.35, 0.36])
    """
    least = (high - low) / most
    decade = 10.0 ** math.floor(math.log10(least))
    step = next(step * decade for step in (1, 2, 5, 10) if least <= step * decade * (1 + 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    # Rounded, because 3 times 0.1 is not 0.3.
    return [float(f"{step * n:.12g}") for n in range(first, last + 1)]


RANGE = 70.0
"""Range of the colours [dB]."""

TICKS = {100: "100", 200: "200", 500: "500", 1000: "1k", 2000: "2k", 5000: "5k", 10000: "10k"}

_COLOURS = 16


def top(levels: Sequence[NDArray[np.float64]]) -> float:
    """Return the level of the darkest colour: the maximum, rounded up to 5 dB.

    Parameters
    ----------
    levels : sequence of ndarray, shape (n_rows, n_columns)
        Of `noise.audio.spectrogram.spectrogram` [dB].

    Returns
    -------
    float
        [dB]
    """
    highest = max((float(one.max()) for one in levels), default=0.0)
    return 5.0 * math.ceil(highest / 5.0)


def picture(levels: NDArray[np.float64], highest: float) -> bytes:
    """Return levels as a PNG file, `highest` the darkest and `RANGE` below it white.

    Parameters
    ----------
    levels : ndarray, shape (n_rows, n_columns)
        Of `noise.audio.spectrogram.spectrogram` [dB].
    highest : float
        [dB]
    """
    share = np.clip((levels - highest + RANGE) / RANGE, 0.0, 1.0)
    return _png(np.round(share * (_COLOURS - 1)).astype(np.uint8))


def scale_picture() -> bytes:
    """Return the colours from the lowest level to the highest, one pixel each, as a PNG file."""
    return _png(np.arange(_COLOURS, dtype=np.uint8)[np.newaxis])


def _png(steps: NDArray[np.uint8]) -> bytes:
    """Write a PNG file of four bits a pixel."""
    from matplotlib import colormaps
    from PIL import Image

    colours = (255 * colormaps["magma_r"](np.linspace(0.0, 1.0, _COLOURS))[:, :3]).astype(np.uint8)
    colours[0] = 255
    image = Image.fromarray(steps).convert("P")
    image.putpalette(colours.tobytes())
    png = io.BytesIO()
    image.save(png, "PNG", bits=4, optimize=True)
    return png.getvalue()


_MOST_TICKS = 6


class Band(NamedTuple):
    """Labelled segment on a card: position and width in per cent, label, description."""

    left: float
    width: float
    label: str
    words: str


@dataclass(frozen=True)
class EntryDisplay:
    """Contents of the card of an entry.

    Parameters
    ----------
    id : str
    title : str
    labels : tuple of str
        Labels of the entry, longest first.
    facts : dict of str to str
        Those known of ``speed``, ``interference``, ``stiffness``, ``material``, ``temperature``,
        ``frequency``, ``level`` and ``fast``.
    note : str
    picture : bytes
        Spectrogram, a PNG file; empty where there is nothing to be heard.
    duration : float
        Of the clip [s].
    tracks : tuple of (str, tuple of Band)
        Labels in time, by the track that they belong to.
    ticks : tuple of (float, str)
        Of the time axis: share of the clip [%], and seconds of the recording.
    """

    id: str
    title: str
    labels: tuple[str, ...]
    facts: dict[str, str]
    note: str
    picture: bytes
    duration: float
    tracks: tuple[tuple[str, tuple[Band, ...]], ...]
    ticks: tuple[tuple[float, str], ...]


def draw_entries(
    entries: Mapping[str, Entry], clips: Mapping[str, Clip]
) -> tuple[dict[str, EntryDisplay], list[str]]:
    """Return cards; calibrated and uncalibrated spectrograms each share their colours.

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
        Levels of the colours, in words.

    Examples
    --------
    >>> from noise.pages.clips import Entry
    >>> displays, scale_words = draw_entries({"s1": Entry("run07")}, {})
    >>> displays["s1"].title, scale_words
    ('run07', [])
    """
    pictures: dict[str, bytes] = {}
    scale_words = []
    for calibrated, reference, unit in ((True, REFERENCE_PRESSURE, "dB re 20 µPa"),
                                        (False, 1.0, "dBFS")):  # fmt: skip
        of_it = {key: clip for key, clip in clips.items() if entries[key].calibrated == calibrated}
        levels = {
            key: spectrogram(_reader(clip.samples), clip.samples.size, RATE, reference)
            for key, clip in of_it.items()
        }
        if levels:
            highest = top(list(levels.values()))
            pictures |= {key: picture(one, highest) for key, one in levels.items()}
            words = f"{highest - RANGE:.0f} to {highest:.0f} {unit}"
            scale_words.append(words.replace("-", "\N{MINUS SIGN}"))
    displays = {
        key: _display(key, entry, clips.get(key), pictures.get(key, b""))
        for key, entry in entries.items()
    }
    return displays, scale_words


def _reader(samples: NDArray[np.float32]) -> Callable[[int, int], NDArray[np.float32]]:
    return lambda first, last: samples[first:last]


def frequency_ticks() -> tuple[tuple[float, str], ...]:
    """Return the frequency ticks of spectrograms, in per cent from the bottom.

    Examples
    --------
    >>> frequency_ticks()[0]
    (11.57, '100')
    """
    span = math.log(HIGHEST / LOWEST)
    return tuple(
        (round(100.0 * math.log(hertz / LOWEST) / span, 2), words) for hertz, words in TICKS.items()
    )


def _display(key: str, entry: Entry, clip: Clip | None, picture: bytes) -> EntryDisplay:
    start = 0.0 if clip is None else clip.start
    end = entry.duration if clip is None else clip.end
    notes = [entry.note] if entry.note else []
    if clip is not None and end - start < entry.duration - 0.02:
        cut, first, whole = map(_seconds, (end - start, start, entry.duration))
        notes.insert(0, f"{cut} s from {first} s of {whole} s")
    if any(number_or(row.get("level_dbfs"), 0.0) > 0.0 for row in entry.rows):
        notes.append("above 0 dBFS, so it is probably clipped")
    ticks = round_ticks(start, end, _MOST_TICKS) if clip is not None and end > start else []
    return EntryDisplay(
        id=key,
        title=entry.title,
        labels=entry.labels,
        facts=facts_of(entry),
        note="; ".join(notes),
        picture=picture,
        duration=end - start,
        tracks=_tracks(entry, start, end) if end > start else (),
        ticks=tuple((_per_cent(tick, start, end), f"{tick:.6g}") for tick in ticks),
    )


def facts_of(entry: Entry) -> dict[str, str]:
    """Return the known facts of an entry, with units; the label table has priority.

    Examples
    --------
    >>> from models.condition import FIXED, Condition
    >>> from noise.pages.clips import Entry
    >>> list(facts_of(Entry("run07", condition=Condition(5.0, 0.279e-3, FIXED))).values())
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
        "material": material,
        "temperature": _number(temperature, ".3g", "°C"),
        "frequency": _number(hertz, ".0f" if number_or(hertz, 0.0) >= 100.0 else ".1f", "Hz"),
        "level": _number(row.get("level_dba"), ".1f", "dB(A)")
        or _number(row.get("level_db"), ".1f", "dB")
        or _number(row.get("level_dbfs"), ".1f", "dBFS"),
        "fast": _number(row.get("l_afmax_dba"), ".1f", "dB(A) Fast maximum"),
    }
    return {name: words for name, words in facts.items() if words}


def _condition_fact(row: Row, column: str, logged: float | None, unit: str) -> str:
    low, high = row.get(f"{column}_low"), row.get(f"{column}_high")
    source = row.get(f"{column}_source")
    if source == "inferred" and isinstance(low, float) and isinstance(high, float):
        return f"{_plain(low, '.2g')} to {_plain(high, '.2g')} {unit} (inferred)"
    value = row.get(column)
    return _number(value if isinstance(value, int | float) else logged, ".5g", unit)


def _number(value: object, form: str, unit: str) -> str:
    if not isinstance(value, int | float):
        return ""
    return "clamp fixed" if math.isinf(value) else f"{_plain(value, form)} {unit}"


def _plain(value: float, form: str) -> str:
    words = "fixed" if math.isinf(value) else f"{value:{form}}"
    if "e+" in words:  # 3400 rather than 3.4e+03
        words = f"{float(words):.0f}"
    return words.replace("-", "\N{MINUS SIGN}")


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


def _seconds(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")
