"""Several recordings joined into one sound: A and B of a comparison, or several runs.

All parts have the same gain, each is faded by itself, and there is silence between them. What is
said of the whole is what holds for every part.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import Condition
from models.errors import ParameterError
from noise.audio.long_sound import AudibleSound, LongSound
from noise.audio.sound import FADE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.recording import Recording


__all__ = ["GAP", "JoinedSound", "Part", "back_to_back"]

GAP = 0.5
"""Silence between two parts [s]."""


@dataclass(frozen=True)
class Part:
    """One recording's place in a sound: its name, start and end [s]."""

    name: str
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class JoinedSound:
    """A sound of one or more recordings.

    Parameters
    ----------
    sound : LongSound
        As `noise.audio.sound.audible` gives it.
    recording : Recording
        What is known of all parts, without samples.
    parts : tuple of Part
        In their order.
    """

    sound: LongSound
    recording: Recording
    parts: tuple[Part, ...]


def back_to_back(
    recordings: Sequence[Recording | AudibleSound],
    rate: int = 48000,
    *,
    gap: float = GAP,
    fade: float = FADE,
) -> JoinedSound:
    """Put the sounds of recordings behind one another, at the same gain.

    Parameters
    ----------
    recordings : sequence of Recording or AudibleSound
        One or more; their names become those of the parts.
    rate : int
        Sampling rate of the result [Hz].
    gap : float
        Silence between two of them [s].
    fade : float
        Length of the fades of each [s].

    Returns
    -------
    JoinedSound

    Raises
    ------
    ParameterError
        A recording has no pressure channel, or some are calibrated and others are not.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> runs = [Recording(np.ones((1, 48)), 48e3, (Channel("pressure"),), name=n) for n in "AB"]
    >>> pair = back_to_back(runs, gap=0.001)
    >>> pair.sound.n_samples, [(part.name, part.start) for part in pair.parts]
    (144, [('A', 0.0), ('B', 0.002)])
    """
    takes = [AudibleSound.of(recording) for recording in recordings]
    check_same_calibration([take.about for take in takes])
    sounds = [take.sound.playable(rate, fade=fade) for take in takes]
    lengths = np.array([sound.n_samples for sound in sounds])
    starts = (np.cumsum(lengths + round(gap * rate)) - lengths - round(gap * rate)).tolist()
    parts = tuple(
        Part(take.about.name, start / rate, (start + sound.n_samples) / rate)
        for take, sound, start in zip(takes, sounds, starts, strict=True)
    )
    about = replace(
        takes[0].about,
        rate=float(rate),
        condition=_common([take.about for take in takes]),
        notes=(),
    )
    return JoinedSound(LongSound.joined(sounds, starts), about, parts)


def check_same_calibration(recordings: Sequence[Recording]) -> None:
    """Refuse recordings whose levels cannot be compared.

    Raises
    ------
    ParameterError
        Some are calibrated and others are not.

    Examples
    --------
    >>> check_same_calibration([])
    """
    known = next((one.name for one in recordings if one.calibrated), None)
    unknown = next((one.name for one in recordings if not one.calibrated), None)
    if known is not None and unknown is not None:
        raise ParameterError(
            f"{known} is calibrated and {unknown} is not, so one gain cannot keep how loud they "
            "are to each other; give its calibration"
        )


def _common(recordings: Sequence[Recording]) -> Condition:
    conditions = [recording.condition for recording in recordings]
    values = {name: {getattr(c, name) for c in conditions} for name in _FIELDS}
    return Condition(**{name: of.pop() for name, of in values.items() if len(of) == 1})


_FIELDS = [field.name for field in fields(Condition)]
