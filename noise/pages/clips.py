"""Sounds of a page: entries, common gain, FLAC clips.

A page is for the ear, so a long recording is represented by the stretch that shows why it has its
name, not by its beginning. Sixteen bits hold a set whose loudest sound is 60 dB above its quietest
with 36 dB to spare, and FLAC gives them back bit by bit in about half the space, in every browser
of today. All calibrated sounds have one full scale, so that what is louder there is louder here;
those that nobody calibrated have another one, common to them.
"""

from __future__ import annotations

import io
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import soundfile
from numpy.typing import NDArray

from models.condition import Condition
from models.recording import REFERENCE_PRESSURE
from noise.audio.gain import full_scale_without_clipping, true_peak
from noise.audio.sound import RATE
from noise.base.labels import LABELS
from noise.base.progress import counted
from noise.labels.summary import labels_in, naming_row
from noise.recordings.wav import largest_sample

Row = Mapping[str, object]


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


BYTES_A_SECOND = 120_000.0
"""Maximum size of a second of loud noise [byte]."""

_BITS = 16


@dataclass(frozen=True)
class Gain:
    """Full scale of the sounds of a page.

    Parameters
    ----------
    calibrated : float or None
        Of calibrated sounds [Pa]; None where there are none.
    uncalibrated : float or None
        Of the others, in fractions of their own full scale.
    """

    calibrated: float | None
    uncalibrated: float | None

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
            level = 20.0 * math.log10(self.calibrated / REFERENCE_PRESSURE)
            sentences.append(
                "Calibrated sounds share one gain and may be compared: full scale = "
                f"{self.calibrated:.4g} Pa ({level:.0f} dB peak re 20 µPa)."
            )
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
    """

    flac: bytes
    samples: NDArray[np.float32]
    start: float
    end: float


def common_gain(entries: Iterable[Entry]) -> Gain:
    """Return the common gain of a set: what the loudest sound of each kind needs."""
    peaks: dict[bool, float] = {}
    entries = list(entries)
    for calibrated in (True, False):
        sounds = [
            (float(np.abs(one.sound).max(initial=0.0)), one.sound)
            for one in entries
            if one.sound is not None and one.calibrated == calibrated
        ]
        # The true peak is less than 12 dB above the largest sample.
        most = max((largest for largest, _ in sounds), default=0.0)
        loud = [sound for largest, sound in sounds if largest >= 0.25 * most]
        if loud:
            peak = max(true_peak(sound.astype(np.float64), RATE) for sound in loud)
            peaks[calibrated] = full_scale_without_clipping(peak) or 1.0
    return Gain(peaks.get(True), peaks.get(False))


def make_clips(entries: Mapping[str, Entry], gain: Gain) -> dict[str, Clip]:
    """Encode the sounds of entries by id, without dither, so that silence stays digital zero.

    Examples
    --------
    >>> from noise.pages.clips import Entry
    >>> silence = Entry("silence", duration=1.0, sound=np.zeros(RATE, np.float32))
    >>> make_clips({"s1": silence}, Gain(1.0, None))["s1"].end
    1.0
    """
    clips = {}
    largest = largest_sample(_BITS)  # a sample beyond would wrap round
    for key, entry in entries.items():
        if (samples := entry.sound) is None:
            continue
        fractions = np.clip((samples / gain.of(entry)).astype(np.float64), -largest, largest)
        flac = io.BytesIO()
        steps = np.round(fractions * 2.0 ** (_BITS - 1)).astype(np.int16)
        soundfile.write(flac, steps, RATE, format="FLAC", subtype="PCM_16")
        end = entry.offset + samples.size / RATE
        clips[key] = Clip(flac.getvalue(), samples, entry.offset, end)
    return clips
