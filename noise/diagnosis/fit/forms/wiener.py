"""The transfer function from what went in to what came out too much, by Wiener's least squares.

With x what went in and r what came out too much, <X* R> / <X* X> line by line is the best linear
guess, and a poor one between the harmonics of the slips, where x has next to nothing. So the
impulse response is looked for, of the length that it may have, by least squares (Wiener 1949);
both signals are made white before, so that all bands count, but not the noise of sensors. What
noise and jitter take from the estimate can be restored by its energy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft
from scipy.linalg import solve_toeplitz
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import tukey

from models.transfer_functions.transfer_function import TransferFunction

_LEAD = 0.08
"""Left out at the start, where what rings on from before is missing [s]; assumed."""

_NEIGHBOURHOOD = 60.0
"""[Hz]"""

_LEAST = 3e-3
"""White noise added to the whitened input, over its power; assumed."""

_USABLE = (0.40, 0.45)
"""Shares of the sampling rate between which a transfer function fades; assumed."""

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
        White noise of the output over the transfer function looked for, rms, in the input's unit
        [unit of the input].
    transfer : TransferFunction, optional
        Through which a torque was sent, with its noise, to make the input.
    """

    level: float
    transfer: TransferFunction | None = None

    def power(self, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean square at each frequency, for a window of unit energy.

        Parameters
        ----------
        frequency : ndarray, shape (n,)
            [Hz]

        Returns
        -------
        ndarray, shape (n,)
            [squared unit of the input]
        """
        power = np.full(frequency.size, self.level**2)
        if self.transfer is not None:
            power += np.abs(_TORQUE_NOISE * self.transfer.at(frequency, falls_below=True)) ** 2
        return power


def wiener_estimate(
    pairs: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
    rate: float,
    length: float,
    before: float = 0.0,
    *,
    noise: Sequence[Noise] | None = None,
    restored: bool = False,
) -> TransferFunction:
    """Estimate what makes the second of each pair from the first.

    Parameters
    ----------
    pairs : sequence of (ndarray of shape (n,), ndarray of shape (n,))
        What went in and what came out, of one recording each, all at one rate [any units].
    rate : float
        Sampling rate [Hz].
    length, before : float
        How long the impulse response is, after and before the impulse [s].
    noise : sequence of Noise, optional
        One a pair.
    restored : bool
        Whether sixth octaves of the output have the energy that they had.

    Returns
    -------
    TransferFunction
        0 towards its last line.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> x = rng.standard_normal(8000)
    >>> late = np.concatenate([np.zeros(5), 0.5 * x[:-5]])
    >>> found = wiener_estimate([(x, late)], 8e3, 0.01)
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
    return TransferFunction(frequency, found)


def _lost(
    kept: NDArray[np.float64], whole: NDArray[np.float64], frequency: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Factor by which amplitudes fell, over sixth octaves."""
    edges = 20.0 * 2.0 ** (np.arange(0, 60) / 6.0)
    place = np.digitize(frequency, edges)
    sums = [np.bincount(place, x, minlength=edges.size + 1) for x in (kept, whole)]
    lost = np.sqrt(np.clip(sums[1] / (sums[0] + 1e-30), 1.0, _MOST_LOST))
    return np.asarray(lost[place])
