"""The step of a converter, found in the samples that went through it: all are multiples of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from models.recording import Recording


_LOOKED_AT = 8192
"""Samples of a recording."""

_ROUNDED = 2.0**-22
"""Error of samples that are kept in 32 bits, over the largest [-]."""

_CLEAR = 20.0
"""A step is so many times that error at least; assumed."""

_REACHES = (1.0, 4.0, 64.0, np.inf)
"""Steps that values are apart at most, from which the step is found more and more exactly."""

_SAME = 1e-4
"""Relative difference of the steps of recordings through one converter [-]; assumed."""

_FEWEST = 3
"""Different values between which a step can be told."""


def converter_step(recordings: Sequence[Recording], kind: str) -> float:
    """Find the step in which a kind of channel was sampled.

    Parameters
    ----------
    recordings : sequence of Recording
    kind : str

    Returns
    -------
    float
        [unit of the channel]; 0 where there is none, or not the same in all recordings.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> x = 0.05 * np.random.default_rng(0).integers(-40, 40, (1, 3000))
    >>> run = Recording(x.astype(np.float32).astype(float), 30e3, (Channel("torque"),))
    >>> round(converter_step([run], "torque"), 6)
    0.05
    """
    rows = [(r.samples, row) for r in recordings if (row := r.first(kind)) is not None]
    steps = np.array([_step(samples[row]) for samples, row in rows])
    told = steps[np.isfinite(steps)]
    if not told.size:
        return 0.0
    middle = float(np.median(told))
    return middle if np.allclose(told, middle, rtol=_SAME, atol=0.0) else 0.0


def _step(x: NDArray[np.float64]) -> float:
    """Greatest common divisor of what samples differ by; 0 if none, NaN if they say nothing."""
    values = np.unique(x[:: max(1, x.size // _LOOKED_AT)])
    if values.size < _FEWEST:
        return np.nan
    error = _ROUNDED * float(np.abs(values).max())
    apart = np.diff(values)
    step = float(apart.min())
    while step > _CLEAR * error:
        for reach in _REACHES:  # the step's own error counts as often as a difference has steps
            steps = np.round(apart / step)
            near = steps <= reach
            if not near.any():
                continue
            left = float(np.abs(apart - step * steps)[near].max())
            if left > 2.0 * error:
                step = left
                break
            step = float(apart[near].sum() / steps[near].sum())
        else:
            return step
    return 0.0
