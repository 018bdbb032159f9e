r"""Amplitudes of modes excited by friction: growth, saturation and competition.

Averaged over a period (Krylov and Bogoliubov), an oscillator with negative damping, cubic losses
and a rough contact becomes an equation for its complex amplitude,

.. math::
    \dot A_i = \Big[ \gamma_i(t) - \sum_j c_{ij} |A_j|^2 + i \, \delta\omega_i(t) \Big] A_i
    + \varepsilon_i \, \xi_i(t)

with the growth gamma that load and speed set, c_ii = |gamma_i|-sized so that amplitudes are about
one, and xi complex white noise. Cross terms above the own ones let one mode win, and the winner
change as the growth rates cross: a jump. A growth just below zero leaves noise filtered by the
mode: the broad line of a tyre. The contact's nonlinearity puts harmonics on top.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

ENVELOPE_RATE = 6000.0
"""Sampling rate of the amplitudes [Hz]."""


def amplitudes(
    growth: NDArray[np.float64],
    detuning: NDArray[np.float64],
    coupling: NDArray[np.float64],
    noise: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.complex128]:
    """Return the complex amplitudes of the modes.

    Parameters
    ----------
    growth, detuning : ndarray, shape (n_modes, m)
        gamma [1/s] and delta omega [rad/s], at `ENVELOPE_RATE`.
    coupling : ndarray, shape (n_modes, n_modes)
        c [1/s].
    noise : ndarray, shape (n_modes,) or (n_modes, m)
        epsilon, of an amplitude of one in the root of a second [1/s^0.5].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray of complex128, shape (n_modes, m)
        [-]

    Examples
    --------
    >>> steady = amplitudes(np.full((1, 6000), 100.0), np.zeros((1, 6000)), np.array([[100.0]]),
    ...                     np.array([0.1]), np.random.default_rng(0))
    >>> bool(abs(np.abs(steady[0, 3000:]).mean() - 1.0) < 0.05)
    True
    """
    kicks = rng.standard_normal((2, *growth.shape))
    kicks *= noise.reshape(len(growth), -1) / np.sqrt(2.0 * ENVELOPE_RATE)
    return np.asarray(_solved(growth, detuning, coupling, kicks[0] + 1j * kicks[1]))


def _averaged(
    growth: NDArray[np.float64],
    detuning: NDArray[np.float64],
    coupling: NDArray[np.float64],
    kicks: NDArray[np.complex128],
) -> NDArray[np.complex128]:
    n_modes, m = growth.shape
    solved = np.zeros((n_modes, m), dtype=np.complex128)
    now = np.full(n_modes, 1e-3 + 0j)
    step = 1.0 / ENVELOPE_RATE
    for k in range(m):
        power = np.abs(now) ** 2
        for i in range(n_modes):
            loss = 0.0
            for j in range(n_modes):
                loss += coupling[i, j] * power[j]
            rate = min(max((growth[i, k] - loss) * step, -3.0), 0.5)
            now[i] = now[i] * np.exp(rate + 1j * detuning[i, k] * step) + kicks[i, k]
            if abs(now[i]) > 3.0:
                now[i] *= 3.0 / abs(now[i])
        solved[:, k] = now
    return solved


_solved = njit(cache=True)(_averaged)


def carried(
    amplitude: NDArray[np.complex128],
    frequency: float,
    harmonics: NDArray[np.float64],
    n: int,
    rate: float,
) -> NDArray[np.float64]:
    """Return the sound of an amplitude: carrier, and harmonics that grow with its powers.

    Parameters
    ----------
    amplitude : ndarray of complex128, shape (m,)
        [-]
    frequency : float
        Frequency of the carrier [Hz].
    harmonics : ndarray, shape (n_harmonics,)
        Strengths at an amplitude of 1 [-]; the first is that of the carrier.
    n : int
    rate : float
        [Hz]

    Examples
    --------
    >>> tone = carried(np.ones(6000, dtype=complex), 1000.0, np.array([1.0]), 48_000, 48e3)
    >>> int(np.abs(np.fft.rfft(tone)).argmax())
    1000
    """
    place = np.arange(n) * (ENVELOPE_RATE / rate)
    grid = np.arange(amplitude.size)
    size = np.interp(place, grid, np.abs(amplitude))
    phase = np.interp(place, grid, np.unwrap(np.angle(amplitude)))
    phase += 2.0 * np.pi * frequency * np.arange(n) / rate
    sound = np.zeros(n)
    turn = np.exp(1j * phase)
    power = np.ones(n, dtype=complex)
    for k, strength in enumerate(harmonics, start=1):
        power = power * turn
        if k * frequency * 1.3 > 0.48 * rate:
            break
        if strength:
            grown = size if k == 1 else size ** min(k, 3)
            sound += strength * grown * np.cos(0.7 * k * k) * power.real
            sound += strength * grown * np.sin(0.7 * k * k) * power.imag
    return sound
