"""The noise of sensors, estimated from recordings of a rig at work.

A recording has no silence, but high above what the rig sounds at there is little else than noise
for a few milliseconds between slips: of all short segments the quietest, in the quietest bands, in
the quietest recordings. What bands and conditions share there is white and the sensor's.

A sensor is not equally noisy in all recordings, so that its noise is a middle of theirs.

What is given up: white noise that fills all recordings alike counts as the sensor's, however loud.
Coloured noise, and such as is louder in some recordings than in others, is no sensor's, and stays
what the simulation lacks. A noise well below the step of the converter cannot be told, and changes
little there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.stats import gamma

from features.kernels.spectra import segment_spectra
from noise.diagnosis.evidence.bands import USABLE

if TYPE_CHECKING:
    from models.recording import Recording


_LENGTH = 128
"""Of a segment [samples]; a few milliseconds; assumed."""

_BANDS, _LOWEST, _LOWEST_SHARE = 4, 500.0, 0.18
"""From the larger of a frequency [Hz] and of a share of the rate [-], up to `USABLE`; assumed."""

_QUIETEST = (0.05, 0.2)
"""Shares of the segments, the quietest, of which either may be free of signals; assumed."""

_OVERLAP = 1.94
"""Neighbouring lines of a Hann window that count as one independent line; 1 + 2 (4/9 + 1/36), from
the squares of their correlations."""

_FEWEST = 20
"""Segments to tell it from; assumed."""

_ALIKE, _ALIKE_RECORDINGS = 1.5, 2.5
"""White noise is the floor of two bands, and of two recordings where there are two: so many times
the power of the lower at most [-]; assumed. From one recording to the next the noise of a sensor
may be half as large again."""

_MIDDLE = 1.0 / 3.0
"""Quantile of the recordings' floors that is the noise: in the louder ones signals may reach into
the floor; assumed."""

_ABOVE_STEP = 0.4
"""Of a converter's step, below which white noise cannot be told from its rounding [-]; assumed."""


def estimated_noise(recordings: Sequence[Recording], kind: str, step: float = 0.0) -> float | None:
    """Estimate the noise of the sensor of a kind of channel.

    Parameters
    ----------
    recordings : sequence of Recording
        In physical units.
    kind : str
    step : float
        Of the converter, whose rounding does not count [unit of the channel].

    Returns
    -------
    float, optional
        Standard deviation of white noise over the whole band [unit of the channel]; None where the
        recordings are too short, have no such channel, or share no floor that is white.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> noise = 0.02 * np.random.default_rng(0).standard_normal((1, 60_000))
    >>> tone = np.sin(2 * np.pi * 440 * np.arange(60_000) / 30e3)
    >>> run = Recording(tone + noise, 30e3, (Channel("torque"),))
    >>> round(estimated_noise([run], "torque"), 3)
    0.02
    """
    floors = []
    for recording in recordings:
        row = recording.first(kind)
        found = None if row is None else _floors(recording.samples[row], recording.rate)
        if found is not None:
            lower, higher = found
            white = higher <= _ALIKE * lower
            floors.append(0.5 * (lower + higher) if white else np.inf)
    quietest = min(floors, default=np.inf)
    alike = [power for power in floors if power <= _ALIKE_RECORDINGS * quietest < np.inf]
    if len(alike) < min(len(floors), 2) or not alike:
        return None
    level = float(np.sqrt(np.quantile(alike, _MIDDLE)))
    if level < _ABOVE_STEP * step:
        return None
    return float(np.sqrt(max(level**2 - step**2 / 12.0, 0.0)))


def _floors(x: NDArray[np.float64], rate: float) -> tuple[float, float] | None:
    """Power of the two quietest bands of a signal [unit^2]."""
    t = np.arange(x.size)
    x = x - (x[0] + (x[-1] - x[0]) / max(x.size - 1, 1) * t)  # a shaft turns all the time
    if x.size < _LENGTH * (_FEWEST + 1) // 2:
        return None
    first = int(np.ceil(max(_LOWEST / rate, _LOWEST_SHARE) * _LENGTH))
    lines = np.abs(segment_spectra(x, _LENGTH)[:, first : int(USABLE * _LENGTH) + 1]) ** 2
    width = lines.shape[1] // _BANDS
    bands = lines[:, lines.shape[1] - width * _BANDS :].reshape(len(lines), _BANDS, width)
    free = width / _OVERLAP
    share = gamma.ppf(_QUIETEST, free) / free
    quiet = np.quantile(bands.mean(axis=2), _QUIETEST, axis=0) / share[:, None]
    lowest = np.sort(quiet.min(axis=0))
    return float(lowest[0]), float(lowest[1])
