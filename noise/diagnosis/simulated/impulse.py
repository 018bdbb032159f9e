"""A way as a causal impulse response, which effects of structure and radiation can change.

A table ends at its highest line, and a response cut off there rings before the blow as well as
after it. So the table is continued: what has no delay by its last value, as of a mass, what comes
late by a fading pulse of that delay. What still comes before the blow is put into its first two
samples, such that low frequencies, of which a torque is full, are what they were.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from noise.diagnosis.simulated.paths import Way

__all__ = ["impulse_of"]

_LAST = (0.8, 0.98)
"""Part of a table that tells how it goes on, as shares of its highest frequency."""

_PROMPT = 3e-4
"""What comes later than this is a delay [s]; sooner, a mass."""

_BEFORE = 5e-4
"""What comes before the blow by more than this is noise of the measurement [s]."""


def impulse_of(way: Way, rate: float, n: int) -> NDArray[np.float64]:
    """Return the impulse response of a way.

    Parameters
    ----------
    way : Way
    rate : float
        Sampling rate [Hz].
    n : int
        Number of samples.

    Returns
    -------
    ndarray, shape (n,)
        For convolution with samples.

    Examples
    --------
    >>> from noise.diagnosis.simulated.paths import Way
    >>> lines = np.arange(0.0, 1e4 + 1.0, 10.0)
    >>> mass = Way(lines, np.full(lines.size, 2.0 + 0j))
    >>> abs(impulse_of(mass, 48e3, 2400)[:3]).round()
    array([2., 0., 0.])
    """
    frequency = np.asarray(np.fft.rfftfreq(2 * n, 1.0 / rate), np.float64)
    impulse = irfft(_continued(way, frequency), 2 * n)
    m = min(n, round(_BEFORE * rate))
    before = impulse[-m:]
    moment = float(np.arange(-m, 0) @ before)
    causal = np.asarray(impulse[:n])
    causal[0] += float(before.sum()) - moment
    causal[1] += moment
    return causal


def _continued(way: Way, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Response at frequencies that go beyond the table."""
    response, end = way.at(frequency), float(way.frequency[-1])
    first, last = (share * end for share in _LAST)
    top = (frequency > first) & (frequency <= last)
    if np.count_nonzero(top) < 3 or frequency[-1] <= last:
        return response
    f, h = frequency[top], response[top]
    delay = -float(np.angle(np.sum(h[1:] * np.conj(h[:-1])))) / (2.0 * np.pi * (f[1] - f[0]))
    if delay > _PROMPT:
        turning = np.exp(-2j * np.pi * frequency * delay)
        size = np.mean(h * np.exp(2j * np.pi * f * delay))
        fading = 0.5 + 0.5 * np.cos(np.pi * np.clip((frequency - end) / end, 0.0, 1.0))
        beyond = size * turning * fading
    else:
        beyond = np.full(frequency.size, complex(np.mean(h.real)))
    mixed = np.clip((frequency - 0.5 * (first + last)) / (0.5 * (last - first)), 0.0, 1.0)
    return np.asarray(response * (1.0 - mixed) + beyond * mixed)
