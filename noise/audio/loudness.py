"""Loudness of a programme, ITU-R BS.1770, of a sound that need not be in memory.

The filters are those of pyloudnorm. Powers of blocks are kept, of which the loudness at any gain
follows: the gates move with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from noise.audio.long_sound import LongSound

__all__ = ["LOUDNESS_BLOCK", "LoudnessBlocks"]

LOUDNESS_BLOCK = 0.4
"""Shortest sound that has a loudness [s] (ITU-R BS.1770)."""

_STEP = 0.25
"""From one block to the next, over their length."""

_FILTERS = "DeMan"
"""The set of filters that is within 0.002 dB of the standard's table; the default is 0.04 off."""

_ABSOLUTE_GATE, _RELATIVE_GATE = -70.0, -10.0
_OFFSET = -0.691


@dataclass(frozen=True, eq=False)
class LoudnessBlocks:
    """Powers of a sound's blocks of 0.4 s.

    Parameters
    ----------
    powers : ndarray, shape (n_blocks,)
        Mean square through the filters of the standard [unit of the sound, squared].

    Examples
    --------
    >>> from noise.audio.long_sound import LongSound
    >>> tone = np.sin(2 * np.pi * 997 * np.arange(96000) / 48e3)
    >>> round(LoudnessBlocks.of(LongSound.of(tone, 48000)).at(1.0), 1)
    -3.0
    """

    powers: NDArray[np.float64]

    @classmethod
    def of(cls, sound: LongSound) -> LoudnessBlocks:
        """Go through a sound once.

        Raises
        ------
        ParameterError
            It is shorter than `LOUDNESS_BLOCK`.
        """
        rate = sound.rate
        if sound.n_samples < LOUDNESS_BLOCK * rate:
            raise ParameterError(
                f"a sound of {sound.n_samples / rate:.3g} s has no loudness to be matched; "
                f"ITU-R BS.1770 needs {LOUDNESS_BLOCK:g} s"
            )
        import pyloudnorm
        from scipy.signal import lfilter

        meter = pyloudnorm.Meter(rate, filter_class=_FILTERS)
        stages = [(one.passband_gain * one.b, one.a) for one in meter._filters.values()]
        states = [np.zeros(2) for _ in stages]
        seconds = sound.n_samples / rate
        powers = np.zeros(int(np.round((seconds - LOUDNESS_BLOCK) / (LOUDNESS_BLOCK * _STEP))) + 1)
        number = np.arange(powers.size)
        first = (LOUDNESS_BLOCK * (number * _STEP) * rate).astype(int)
        last = (LOUDNESS_BLOCK * (number * _STEP + 1.0) * rate).astype(int)
        held, start, done = np.empty(0), 0, 0
        for piece in sound.pieces():
            for at, (b, a) in enumerate(stages):
                piece, states[at] = lfilter(b, a, piece, zi=states[at])
            held = np.concatenate([held, np.square(piece)])
            end = start + held.size
            while done < powers.size and (last[done] <= end or end == sound.n_samples):
                powers[done] = held[first[done] - start : last[done] - start].sum()
                done += 1
            passed = min(first[done], end) if done < powers.size else end
            held, start = held[passed - start :], passed
        return cls(powers / (LOUDNESS_BLOCK * rate))

    def at(self, full_scale: float) -> float:
        """Integrated loudness where this sample is full scale.

        Parameters
        ----------
        full_scale : float
            [unit of the sound]

        Returns
        -------
        float
            [LUFS]; minus infinity where nothing reaches -70 LUFS.
        """
        powers = self.powers / full_scale**2
        with np.errstate(divide="ignore"):
            level = _OFFSET + 10.0 * np.log10(powers)
        heard = level >= _ABSOLUTE_GATE
        if not heard.any():
            return float("-inf")
        gate = _OFFSET + 10.0 * np.log10(powers[heard].mean()) + _RELATIVE_GATE
        counted = powers[(level > gate) & (level > _ABSOLUTE_GATE)]
        if not counted.size:
            return float("-inf")
        return float(_OFFSET + 10.0 * np.log10(counted.mean()))
