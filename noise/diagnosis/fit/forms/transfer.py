"""The linear part that a signal has too much, estimated over several recordings.

With x what went in and r what came out too much, <X* R> / <X* X> line by line is the best linear
guess, and a poor one between the harmonics of the slips, where x has next to nothing. So the
impulse response is looked for, of the length that it may have, by least squares (Wiener 1949);
both signals are made white before, so that all bands count, but not the noise of sensors. What
noise and jitter take from the estimate can be restored by its energy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.linalg import solve_toeplitz
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import tukey

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.diagnosis.simulated.paths import Way

__all__ = ["Noise", "Transfer", "estimated_transfer", "filtered_by"]

_LEAD = 0.08
"""Left out at the start, where what rings on from before is missing [s]."""

_NEIGHBOURHOOD = 60.0
"""[Hz]"""

_LEAST = 3e-3
"""White noise added to the whitened input, over its power."""

_USABLE = (0.40, 0.45)
"""Shares of the sampling rate between which a transfer fades."""

_FADE = 0.25
"""Of an impulse response, as a share of its length."""

_MOST_LOST = 16.0
"""Of energy."""

_TORQUE_NOISE = 0.005
"""White noise of a torque, rms [Nm]; assumed."""


@dataclass(frozen=True, eq=False)
class Noise:
    """What a line of the input must exceed to tell something.

    Parameters
    ----------
    level : float
        White noise of the output over the transfer that is looked for, rms, in the input's unit.
    way : Way, optional
        That the torque was sent along, with its noise, to make the input.
    """

    level: float
    way: Way | None = None

    def power(self, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean square at each frequency, for a window of unit energy."""
        power = np.full(frequency.size, self.level**2)
        if self.way is not None:
            power += np.abs(_TORQUE_NOISE * self.way.at(frequency)) ** 2
        return power


@dataclass(frozen=True, eq=False)
class Transfer:
    """A transfer function as a table.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        [Hz]
    response : ndarray of complex, shape (n,)
        0 towards the last.
    """

    frequency: NDArray[np.float64]
    response: NDArray[np.complex128]

    def at(self, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Response at other frequencies; 0 beyond the table."""
        real = np.interp(frequency, self.frequency, self.response.real, right=0.0)
        imaginary = np.interp(frequency, self.frequency, self.response.imag, right=0.0)
        return np.asarray(real + 1j * imaginary)


def estimated_transfer(
    pairs: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
    rate: float,
    length: float,
    before: float = 0.0,
    *,
    noise: Sequence[Noise] | None = None,
    restored: bool = False,
) -> Transfer:
    """Estimate what makes the second of each pair from the first.

    Parameters
    ----------
    pairs : sequence of (ndarray, ndarray)
        Of one recording each, all at one rate.
    rate : float
        [Hz]
    length, before : float
        How long the impulse response is, after and before the blow [s].
    noise : sequence of Noise, optional
        One a pair.
    restored : bool
        Whether sixth octaves of the output have the energy that they had.

    Returns
    -------
    Transfer

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> x = rng.standard_normal(8000)
    >>> late = np.concatenate([np.zeros(5), 0.5 * x[:-5]])
    >>> found = estimated_transfer([(x, late)], 8e3, 0.01)
    >>> round(float(abs(found.at(np.array([1000.0]))[0])), 1)
    0.5
    """
    cut = round(_LEAD * rate)
    n = next_fast_len(2 * max(x.size for x, _ in pairs), real=True)
    frequency = np.asarray(np.fft.rfftfreq(n, 1.0 / rate), np.float64)
    power, cross = np.zeros(n // 2 + 1), np.zeros(n // 2 + 1, complex)
    least, out = np.zeros(n // 2 + 1), np.zeros(n // 2 + 1)
    for k, (x, r) in enumerate(pairs):
        window = tukey(x.size - cut, 0.1)
        of_x = rfft((x[cut:] - x[cut:].mean()) * window, n)
        of_r = rfft((r[cut:] - r[cut:].mean()) * window, n)
        weight = 1.0 / (float(np.mean(np.abs(of_x) ** 2)) + 1e-30)
        power += weight * np.abs(of_x) ** 2
        cross += weight * np.conj(of_x) * of_r
        out += weight * np.abs(of_r) ** 2
        if noise is not None:
            least += weight * float(np.sum(window**2)) * noise[k].power(frequency)
    width = max(3, round(_NEIGHBOURHOOD * n / rate))
    white = 1.0 / (uniform_filter1d(power, width, mode="nearest") + least + 1e-30)
    m, back = min(round(length * rate), n // 4), round(before * rate)
    alike, common = irfft((power + least) * white, n), irfft(cross * white, n)
    first = alike[: m + back].copy()
    first[0] *= 1.0 + _LEAST
    taps = solve_toeplitz(first, np.concatenate([common[n - back :], common[:m]]))
    taps *= np.clip((m + back - np.arange(m + back)) / max(_FADE * m, 1.0), 0.0, 1.0)
    impulse = np.zeros(n)
    impulse[:m], impulse[n - back :] = taps[back:], taps[:back]
    low, high = (share * rate for share in _USABLE)
    fading = np.clip((high - frequency) / (high - low), 0.0, 1.0)
    found = np.asarray(rfft(impulse) * fading)
    if restored:
        found *= _lost(np.abs(found) ** 2 * power, out, frequency)
    return Transfer(frequency, found)


def _lost(
    kept: NDArray[np.float64], whole: NDArray[np.float64], frequency: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Factor by which amplitudes fell, over sixth octaves."""
    edges = 20.0 * 2.0 ** (np.arange(0, 60) / 6.0)
    place = np.digitize(frequency, edges)
    sums = [np.bincount(place, x, minlength=edges.size + 1) for x in (kept, whole)]
    lost = np.sqrt(np.clip(sums[1] / (sums[0] + 1e-30), 1.0, _MOST_LOST))
    return np.asarray(lost[place])


def filtered_by(
    signal: NDArray[np.float64], rate: float, transfer: Transfer
) -> NDArray[np.float64]:
    """Send a signal through a transfer function, as if its ends went on.

    Examples
    --------
    >>> double = Transfer(np.array([0.0, 4e3]), np.array([2.0 + 0j, 2.0 + 0j]))
    >>> bool(np.allclose(filtered_by(np.ones(100), 8e3, double), 2.0))
    True
    """
    n = next_fast_len(2 * signal.size, real=True)
    gap = n - signal.size
    bridge = np.linspace(signal[-1], signal[0], gap + 2)[1:-1]
    spectrum = rfft(np.concatenate([signal, bridge]))
    frequency = np.asarray(np.fft.rfftfreq(n, 1.0 / rate), np.float64)
    return np.asarray(irfft(spectrum * transfer.at(frequency), n)[: signal.size])
