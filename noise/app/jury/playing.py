"""The sounds of a jury, as they are heard: all at one gain, or all equally loud.

They are played as they come, without a name, so that the page which plays them knows nothing of
what it plays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.audio.gain import (
    LOUDNESS_BLOCK,
    QUIETEST_FULL_SCALE,
    full_scale_without_clipping,
    loudness,
    matched_loudness,
    true_peak,
)
from noise.audio.sound import playable
from noise.recordings.wav import wav_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from noise.app.opened import Opened
    from noise.app.sounds.sound_cache import SoundCache

__all__ = ["EQUAL_LOUDNESS", "GAINS", "LONGEST", "ONE_GAIN", "Playing"]

ONE_GAIN, EQUAL_LOUDNESS = "one gain", "equal loudness"

GAINS = (ONE_GAIN, EQUAL_LOUDNESS)
"""How sounds are played: as recorded, the louder louder; or each as loud as the others."""

LONGEST = 30.0
"""Of what is heard of a recording, from its beginning [s]."""

_RATE = 48000
"""Of samples to play [Hz]."""


@dataclass(frozen=True)
class _Measured:
    """A sound: whether in pascals, its true peak [Pa, or full scale], its loudness there [LUFS]."""

    calibrated: bool
    peak: float
    loudness: float | None


class Playing:
    """Sounds that were opened, measured once; may be used from several threads.

    Parameters
    ----------
    opened : Opened
    sounds : SoundCache
        Of what was opened.
    """

    def __init__(self, opened: Opened, sounds: SoundCache) -> None:
        self._opened = opened
        self._sounds = sounds
        self._lock = Lock()
        self._measured: dict[tuple[int, int, int], _Measured] = {}

    def prepare(self, indices: Sequence[int], seconds: float = math.inf) -> int:
        """Measure sounds for a while [s], and return how many are measured.

        Raises
        ------
        BushingNoiseError
            One of them, which it names, cannot be read or has no sound.
        """
        began = monotonic()
        for number, index in enumerate(indices):
            if monotonic() - began > seconds:
                return number
            self._measure(index)
        return len(indices)

    def gain(self, indices: Sequence[int], played: str) -> str:
        """Say in words at which gain sounds are played.

        Raises
        ------
        BushingNoiseError
            They cannot be played so; it says why.
        """
        target = self._target(indices, played)
        if target is not None:
            return f"equal loudness, {target:.0f} LUFS"
        full_scale = self._full_scale(indices)
        if not self._measure(indices[0]).calibrated:
            return f"one gain: as in the files, full scale = {full_scale:g}"
        level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
        return f"one gain: full scale = {full_scale:g} Pa ({level:.0f} dB peak re 20 µPa)"

    def wav(self, index: int, indices: Sequence[int], played: str) -> bytes:
        """Return one of several sounds as a WAV file of floats, to be played as it is.

        Raises
        ------
        BushingNoiseError
            They cannot be played so; it says why.
        """
        target = self._target(indices, played)
        if target is None:
            full_scale = self._full_scale(indices)
        else:
            measured = self._measure(index)
            # A gain shifts loudness by as much, but for the absolute gate, which matters to none
            # that is 10 dB louder.
            full_scale = measured.peak * 10.0 ** (((measured.loudness or 0.0) - target) / 20.0)
        return wav_bytes(self._samples(index) / full_scale, _RATE, 32)

    def _target(self, indices: Sequence[int], played: str) -> float | None:
        """Return the loudness that all can have [LUFS]; None where it stays as recorded."""
        if played != EQUAL_LOUDNESS:
            return None
        found = {index: self._measure(index).loudness for index in indices}
        for index, known in found.items():
            if known is None:
                name = self._opened.job(index).name
                raise ParameterError(
                    f"{name}: has no loudness to be matched, as it is silent or shorter than "
                    f"{LOUDNESS_BLOCK:g} s; leave it out, or play all at one gain"
                )
        return matched_loudness([known for known in found.values() if known is not None])

    def _full_scale(self, indices: Sequence[int]) -> float:
        measured = {index: self._measure(index) for index in indices}
        known = [index for index, one in measured.items() if one.calibrated]
        peak = max(one.peak for one in measured.values())
        if len(known) == len(indices):
            return max(QUIETEST_FULL_SCALE, full_scale_without_clipping(peak))
        if known:
            other = next(index for index in indices if index not in known)
            one, two = (self._opened.job(index).name for index in (known[0], other))
            raise ParameterError(
                f"{one} is calibrated and {two} is not, so they share no gain; leave one of them "
                "out, or compare at equal loudness"
            )
        return max(1.0, full_scale_without_clipping(peak))

    def _measure(self, index: int) -> _Measured:
        path = self._opened.job(index).path
        try:
            state = path.stat()
        except OSError as error:
            raise ParameterError(f"{path.name}: {error.strerror}") from None
        key = index, state.st_size, state.st_mtime_ns
        with self._lock:
            if key not in self._measured:
                self._measured[key] = self._measured_anew(index)
            return self._measured[key]

    def _measured_anew(self, index: int) -> _Measured:
        samples = self._samples(index)
        peak = true_peak(samples, _RATE)
        known = None
        if peak > 0.0 and samples.size >= LOUDNESS_BLOCK * _RATE:
            reached = loudness(samples / peak, _RATE)
            known = reached if math.isfinite(reached) else None
        return _Measured(self._sounds.track(index).calibrated, peak, known)

    def _samples(self, index: int) -> NDArray[np.float64]:
        name = self._opened.job(index).name
        try:
            track = self._sounds.track(index)
        except BushingNoiseError as error:
            raise ParameterError(f"{name}: cannot be heard ({error})") from None
        if track.channel.kind != "pressure":
            raise ParameterError(f"{name}: has no sound pressure to be heard; leave it out")
        last = min(track.n, round(LONGEST * track.rate))
        return playable(track.read(0, last), track.rate, _RATE)
