"""Sounds of a page: entries, common gain, FLAC clips within a size budget.

A page is for the ear, so a long recording is represented by the stretch that shows why it has its
name, not by its beginning. Sixteen bits hold a set whose loudest sound is 60 dB above its quietest
with 36 dB to spare, and FLAC gives them back bit by bit in about half the space, in every browser
of today. All calibrated sounds have one full scale, so that what is louder there is louder here;
those that nobody calibrated have another one, common to them. Where the budget is too small, every
sound is shortened to the same length, and the page says so. Equal loudness is one factor a sound,
switched on by the listener who compares characters.
"""

from __future__ import annotations

import io
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import soundfile
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.audio.gain import (
    full_scale_without_clipping,
    true_peak,
)
from noise.audio.sound import FADE, fade_ends
from noise.base.labels import LABELS
from noise.base.progress import counted
from noise.labels.summary import labels_in, naming_row
from noise.recordings.wav import integers, largest_sample

Row = Mapping[str, object]
FastLevels = tuple[NDArray[np.float64], NDArray[np.float64]]

RATE = 48000
"""Sampling rate of sounds on pages [Hz]."""


@dataclass(frozen=True)
class Part:
    """Labelled segment: `start` and `end` in seconds, `track` if there are several."""

    start: float
    end: float
    label: str
    track: str


@dataclass(frozen=True, eq=False)
class Entry:
    """Entry of a page: a recording or simulated sound, or its labels only.

    Parameters
    ----------
    title : str
    rows : tuple of mapping
        Of the label table; none where it is not labelled.
    condition : Condition
        As the recording says.
    duration : float
        Of the whole recording [s].
    sound : ndarray of float32, shape (n,), optional
        Sound pressure at `RATE` [Pa], or in fractions of full scale where not `calibrated`; of
        the whole recording or of a stretch of it.
    offset : float
        Where that stretch begins [s].
    calibrated : bool
    fast_levels : tuple of 2 ndarrays, shape (n,), optional
        Time [s] and A-weighted level, Fast [dB], where they were measured before the sound was
        faded and resampled, as by `noise.audio.spectrogram.recorded_levels`.
    note : str
        Where the labels come from, or why there is no sound.
    """

    title: str
    rows: tuple[Row, ...] = ()
    condition: Condition = field(default_factory=Condition)
    duration: float = 0.0
    sound: NDArray[np.float32] | None = None
    offset: float = 0.0
    calibrated: bool = True
    note: str = ""
    fast_levels: FastLevels | None = None

    @property
    def parts(self) -> tuple[Part, ...]:
        """Labelled segments."""
        return tuple(
            Part(
                number_or(row.get("start_s"), 0.0),
                min(number_or(row.get("end_s"), self.duration), self.duration),
                str(row["label"]),
                "" if row.get("channel") in ("all", None) else str(row["channel"]),
            )
            for row in self.rows
            if row["label"] is not None
        )

    @property
    def row(self) -> Row | None:
        """Row that names the entry."""
        return naming_row(self.rows)

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the entry, longest first."""
        return labels_in(self.rows)


def stretch_start(rows: Sequence[Row], duration: float, length: float) -> float:
    """Return the start of an excerpt that shows the naming segment of a recording [s].

    Examples
    --------
    >>> rows = [{"label": "squeal", "start_s": 40.0, "end_s": 42.0}]
    >>> stretch_start(rows, 60.0, 10.0), stretch_start([], 60.0, 10.0)
    (36.0, 0.0)
    """
    row = naming_row(rows)
    if row is None or length >= duration:
        return 0.0
    start, end = number_or(row.get("start_s"), 0.0), number_or(row.get("end_s"), duration)
    wanted = start if end - start >= length else 0.5 * (start + end - length)
    return float(min(max(wanted, 0.0), duration - length))


def label_counts(entries: Iterable[Entry]) -> list[tuple[str, int]]:
    """Count the entries with each label; those without labels come last, as "".

    Examples
    --------
    >>> label_counts([Entry("a"), Entry("b", ({"label": "creak"}, {"label": "none"}))])
    [('creak', 1), ('none', 1), ('', 1)]
    """
    counts = Counter(label for entry in entries for label in entry.labels or ("",))
    return [(label, counts[label]) for label in (*LABELS, "") if counts[label]]


def labels_sentence(entries: Sequence[Entry]) -> str:
    """Return the number of segments by label as a sentence.

    Examples
    --------
    >>> labels_sentence([Entry("a"), Entry("b", ({"label": "creak"},))])
    '2 recordings with 1 segment: 1 creak; 1 recording without a label'
    """
    counts = Counter(part.label for entry in entries for part in entry.parts)
    number = counted(len(entries), "recording")
    words = f"{number} with {counted(counts.total(), 'segment')}: " if counts else f"{number}: "
    words += ", ".join(f"{counts[label]} {label}" for label in LABELS if counts[label])
    bare = sum(not entry.parts for entry in entries)
    if bare and counts:
        return f"{words}; {counted(bare, 'recording')} without a label"
    return f"{words}no labels" if bare else words


def number_or(value: object, missing: float) -> float:
    """Return a cell if it is a number [any unit], else a default."""
    return float(value) if isinstance(value, int | float) else missing


SHORTEST = 1.0
"""Minimum duration after shortening [s]."""

BYTES_A_SECOND = 120_000.0
"""Maximum size of a second of loud noise [byte]."""

_ROUNDED_UP, _STEP = 1.05, 100_000.0
"""Margin factor and rounding step of a stated size [byte]."""

_BITS = 16
_BASE64 = 4.0 / 3.0


@dataclass(frozen=True)
class Gain:
    """Full scale of the sounds of a page.

    Parameters
    ----------
    calibrated : float or None
        Of calibrated sounds [Pa]; None where there are none.
    uncalibrated : float or None
        Of the others, in fractions of their own full scale.
    stated : bool
        Whether the caller has set `calibrated`.
    """

    calibrated: float | None
    uncalibrated: float | None
    stated: bool = False

    def of(self, entry: Entry) -> float:
        """Return the full scale of an entry's sound, in its unit, such as [Pa]."""
        return (self.calibrated if entry.calibrated else self.uncalibrated) or 1.0

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences about the gain for the listener.

        Examples
        --------
        >>> Gain(2.0, None).sentences[0]
        'Calibrated sounds share one gain and may be compared: full scale = 2 Pa (100 dB peak re 20
        µPa).'
        """
        sentences = []
        if self.calibrated is not None:
            how = "are level-true" if self.stated else "share one gain and may be compared"
            sentences.append(f"Calibrated sounds {how}: {full_scale_words(self.calibrated)}.")
        if self.uncalibrated is not None:
            decibel = f"{-20.0 * math.log10(self.uncalibrated):+.1f}".replace("-", "\N{MINUS SIGN}")
            sentences.append(
                "Sounds marked dBFS are not calibrated: how loud they were is not known; they "
                f"share a gain of {decibel} dB among themselves."
            )
        return tuple(sentences)


@dataclass(frozen=True)
class Clip:
    """Encoded sound of a page.

    Parameters
    ----------
    flac : bytes
    samples : ndarray of float32, shape (n,)
        Samples in the unit of the entry, such as [Pa].
    start, end : float
        Interval of the recording [s].
    full_scale : float
        What full scale of it is worth, in the unit of the entry, such as [Pa].
    """

    flac: bytes
    samples: NDArray[np.float32]
    start: float
    end: float
    full_scale: float


def full_scale_words(full_scale: float) -> str:
    """Return the full scale [Pa] in words.

    Examples
    --------
    >>> full_scale_words(2.0)
    'full scale = 2 Pa (100 dB peak re 20 µPa)'
    """
    level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
    return f"full scale = {full_scale:.4g} Pa ({level:.0f} dB peak re 20 µPa)"


def common_gain(entries: Iterable[Entry], pascal: float | None = None) -> Gain:
    """Return the common gain of a set.

    Parameters
    ----------
    entries : iterable of Entry
    pascal : float, optional
        Full scale of calibrated sounds [Pa]; by default what the loudest of them needs.

    Raises
    ------
    ParameterError
        A sound would clip at the full scale given.
    """
    peaks: dict[bool, list[tuple[float, str]]] = {True: [], False: []}  # titles may be alike
    for entry, largest in _that_may_be_loudest(list(entries)):
        peak = true_peak(largest.astype(np.float64), RATE)
        peaks[entry.calibrated].append((peak, entry.title))
    least = {
        calibrated: full_scale_without_clipping(max(of)[0]) or 1.0 if of else None
        for calibrated, of in peaks.items()
    }
    if pascal is None:
        return Gain(least[True], least[False])
    if (needed := least[True]) is not None and pascal < needed:
        raise ParameterError(
            f"{max(peaks[True])[1]}: would clip at {pascal:g} Pa per full scale; "
            f"{needed:g} Pa is the least that holds all sounds"
        )
    return Gain(pascal if peaks[True] else None, least[False], stated=True)


def make_clips(
    entries: Mapping[str, Entry],
    gain: Gain,
    *,
    budget: float = math.inf,
    beside: float = 0.0,
    dither: np.random.Generator | None = None,
) -> tuple[dict[str, Clip], float | None]:
    """Encode sounds, shortened if they exceed a size budget.

    Parameters
    ----------
    entries : mapping of str to Entry
        By id.
    gain : Gain
    budget : float
        Maximum size of the page [byte].
    beside : float
        Size of the rest of the page [byte].
    dither : numpy.random.Generator, optional
        By default there is no dither, and silence stays digital zero.

    Returns
    -------
    clips : dict of str to Clip
        Of the entries that have a sound.
    shortened : float or None
        Duration of shortened sounds [s]; None if none is shortened.

    Raises
    ------
    ParameterError
        Not even `SHORTEST` seconds of each would fit.

    Examples
    --------
    >>> from noise.pages.clips import Entry
    >>> silence = Entry("silence", duration=1.0, sound=np.zeros(RATE, np.float32))
    >>> clips, shortened = make_clips({"s1": silence}, Gain(1.0, None))
    >>> clips["s1"].end, shortened
    (1.0, None)
    """
    seeds = [None if dither is None else int(dither.integers(1 << 62)) for _ in entries]

    def cut_to(longest: float) -> dict[str, Clip]:
        return {
            key: _clip(entry, entry.sound, longest, gain, seed)
            for (key, entry), seed in zip(entries.items(), seeds, strict=True)
            if entry.sound is not None
        }

    room = budget - beside
    clips = cut_to(math.inf)
    if not clips or _weight(clips) <= room:
        return clips, None
    length = _length_that_fits(list(clips.values()), room) if room > 0.0 else 0.0
    if length < SHORTEST:
        least = math.ceil(_ROUNDED_UP * (beside + _weight(cut_to(SHORTEST))) / _STEP) * _STEP
        raise ParameterError(
            f"{len(clips)} sounds of {SHORTEST:g} s each do not fit into {budget / 1e6:.3g} MB; "
            f"they need about {least / 1e6:.3g} MB; allow more, or name fewer"
        )
    while True:
        clips = cut_to(length)
        if _weight(clips) <= room or length <= SHORTEST:
            return clips, length
        length = max(SHORTEST, 0.9 * length)  # the loud parts were kept


def _that_may_be_loudest(
    entries: Sequence[Entry],
) -> Iterator[tuple[Entry, NDArray[np.float32]]]:
    """Yield sounds within 12 dB of the largest sample; true peaks of others are lower."""
    for calibrated in (True, False):
        audible = [
            (entry, entry.sound, float(np.abs(entry.sound).max(initial=0.0)))
            for entry in entries
            if entry.sound is not None and entry.calibrated == calibrated
        ]
        most = max((largest for _, _, largest in audible), default=0.0)
        yield from ((entry, sound) for entry, sound, largest in audible if largest >= 0.25 * most)


def _clip(
    entry: Entry, samples: NDArray[np.float32], longest: float, gain: Gain, seed: int | None
) -> Clip:
    whole, offset = samples.size / RATE, entry.offset
    if whole > longest:
        first = stretch_start(entry.rows, entry.duration, longest) - offset
        first = min(max(first, 0.0), whole - longest)
        begin = round(first * RATE)
        samples = samples[begin : begin + round(longest * RATE)].copy()
        offset += begin / RATE
        fade_ends(samples, round(FADE * RATE))
    full_scale = gain.of(entry)
    largest = largest_sample(_BITS)  # a sample beyond would wrap round
    fractions = np.clip((samples / full_scale).astype(np.float64), -largest, largest)
    dither = None if seed is None else np.random.default_rng(seed)
    steps = np.frombuffer(integers(fractions, _BITS, dither), "<i2")
    flac = io.BytesIO()
    soundfile.write(flac, steps, RATE, format="FLAC", subtype="PCM_16")
    return Clip(flac.getvalue(), samples, offset, offset + samples.size / RATE, full_scale)


def _weight(clips: Mapping[str, Clip]) -> float:
    return sum(_BASE64 * len(clip.flac) for clip in clips.values())


def _length_that_fits(clips: Sequence[Clip], budget: float) -> float:
    """Return the common maximum length at which all clips fit the budget."""
    rates = [_BASE64 * len(clip.flac) / (clip.end - clip.start) for clip in clips]
    lengths = [clip.end - clip.start for clip in clips]
    low, high = 0.0, max(lengths)
    for _ in range(40):
        middle = 0.5 * (low + high)
        total = sum(r * min(d, middle) for r, d in zip(rates, lengths, strict=True))
        low, high = (middle, high) if total <= budget else (low, middle)
    return low
