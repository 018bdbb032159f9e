r"""Mechanisms of friction sounds: a slider that slips, bodies of modes, modes fed by friction.

**Slider.** A spring k is drawn at an irregular speed v(t). The contact bears a friction that grows
with the time of stick,

.. math::
    F_s(t_s) = F_k + \Delta F \, (1 - e^{-t_s / \tau}), \qquad
    k \int v \, dt = 2 (F_s - F_k) (1 + \sigma \xi)

so a slip comes where the spring has been drawn by a distance D = D_0 (1 - exp(-t_s / tau)), and
lets go as much, its overshoot being the mirror image of what it was drawn beyond F_k. The second
equation holds for every stick, with a scatter sigma of contacts that differ. The longer the stick,
the larger the slip: slow creaks knock, fast ones buzz. A slip takes far less time than a stick and
counts as instantaneous (Rabinowicz, *Friction and Wear of Materials*, chapter 4.8).

The rate of slips is v / D; v is drawn such that it glides, irregularly, and stops now and then.

**Bodies** are sums of modes with the impulse response

.. math::
    h(t) = \sum_i w_i \, e^{-\zeta_i \omega_i t} \sin(\omega_i \sqrt{1 - \zeta_i^2} \, t)

The weights w_i, the product of the mode's shapes at the contact and its radiation to the ear, are
random; frequencies are as a plate's, evenly dense, or a beam's, thinning out; damping is the
material's with scatter. Where modes overlap, as a panel's do above a kilohertz or two, there are
hundreds and none stands out: the response is noise that decays (Schroeder 1962).

**Modes fed by friction** grow, saturate and compete. Averaged over a period (Krylov and
Bogoliubov), an oscillator with negative damping, cubic losses and a rough contact becomes an
equation for its complex amplitude,

.. math::
    \dot A_i = \Big[ \gamma_i(t) - \sum_j c_{ij} |A_j|^2 + i \, \delta\omega_i(t) \Big] A_i
    + \varepsilon_i \, \xi_i(t)

with the growth gamma that load and speed set, c_ii = |gamma_i|-sized so that amplitudes are about
one, and xi complex white noise. Cross terms above the own ones let one mode win, and the winner
change as the growth rates cross: a jump. A growth just below zero leaves noise filtered by the
mode: the broad line of a tyre. The contact's nonlinearity puts harmonics on top.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from noise.base.arrays import Array, Rng
from noise.training.draws import coloured_noise, log_uniform, wandering


@dataclass(frozen=True, eq=False)
class Slips:
    """Times [s] and sizes of slips, relative to D_0; arrays of shape (n_slips,)."""

    time: Array
    size: Array


def random_drive(
    n: int, rate: float, slowest: float, fastest: float, rng: Rng, *, steps: bool = False
) -> Array:
    """Return a random speed of the drive over D_0, which is nearly the slip rate of long sticks.

    Its logarithm varies between `slowest` and `fastest`, like that of a hand or a gust; sometimes
    it rests, or begins fast and dies away.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    slowest, fastest : float
        [1/s]
    rng : numpy.random.Generator
    steps : bool
        Whether half of the drives jump between steady speeds, like slips that lock onto modes of
        the body.

    Returns
    -------
    ndarray, shape (n,)
        [1/s]

    Examples
    --------
    >>> drive = random_drive(48_000, 48e3, 5.0, 250.0, np.random.default_rng(0))
    >>> bool(drive.min() >= 0.0), bool(drive.max() < 400.0)
    (True, True)
    """
    middle, half = 0.5 * math.log(slowest * fastest), 0.5 * math.log(fastest / slowest)
    course = wandering(n, rate, log_uniform(0.3, 4.0, rng), rng)
    x = np.linspace(0.0, 1.0, n)
    if rng.random() < 0.5:  # a trend: decay, start, or both
        trend = rng.choice((-1.0, 1.0)) * (1.0 - 2.0 * x ** rng.uniform(0.5, 2.0))
        if rng.random() < 0.4:
            trend = 1.0 - 2.0 * np.abs(2.0 * x - 1.0)
        share = rng.uniform(0.4, 0.9)
        course = share * trend + (1.0 - share) * course
    course = half * np.clip(course, -1.1, 1.1)
    if steps and rng.random() < 0.5:
        step = rng.uniform(0.15, 0.7)
        course = 0.85 * step * np.round(course / step) + 0.15 * course
    drive = np.exp(middle + course)
    for _ in range(int(rng.poisson(0.5 * n / rate))):
        start = int(rng.integers(n))
        drive[start : start + int(rng.uniform(0.04, 0.3) * rate)] = 0.0
    return np.asarray(drive)


def slide(drive: Array, rate: float, *, ageing_time: float, scatter: float, rng: Rng) -> Slips:
    """Return the slips of a slider.

    Parameters
    ----------
    drive : ndarray, shape (n,)
        Speed of the drive over D_0 [1/s].
    rate : float
        Sampling rate [Hz].
    ageing_time : float
        tau [s].
    scatter : float
        sigma [-].
    rng : numpy.random.Generator

    Examples
    --------
    >>> slips = slide(np.full(48_000, 50.0), 48e3, ageing_time=1e-4, scatter=0.0,
    ...               rng=np.random.default_rng(0))
    >>> slips.time.size
    50
    """
    scattered = np.maximum(0.15, 1.0 + scatter * rng.standard_normal(4096))
    index, size = _slips(drive, rate, ageing_time, scattered)
    return Slips(index / rate, size)


@njit(cache=True)
def _slips(drive: Array, rate: float, ageing_time: float, scattered: Array) -> tuple[Array, Array]:
    index = np.empty(drive.size)
    size = np.empty(drive.size)
    count = 0
    drawn = 0.0
    stick = 0.0
    for i in range(drive.size):
        step = drive[i] / rate
        drawn += step
        stick += 1.0 / rate
        borne = scattered[count % scattered.size] * (1.0 - math.exp(-stick / ageing_time))
        # A contact needs 0.1 ms to form.
        if drawn >= borne and stick > 1e-4:
            index[count] = i - min(1.0, (drawn - borne) / max(step, 1e-12))
            size[count] = drawn
            count += 1
            drawn = 0.0
            stick = 0.0
    return index[:count].copy(), size[:count].copy()


@dataclass(frozen=True, eq=False)
class ModalBody:
    """Modes of a body.

    Parameters
    ----------
    frequency : ndarray, shape (n_modes,)
        Natural frequencies [Hz].
    damping_ratio : ndarray, shape (n_modes,)
        [-]
    weight : ndarray, shape (n_modes,)
        Signed [arbitrary unit].
    """

    frequency: Array
    damping_ratio: Array
    weight: Array

    def impulse_response(self, rate: float, longest: float = 0.4) -> Array:
        """Return the impulse response until it has decayed, limited to a duration.

        Parameters
        ----------
        rate : float
            [Hz]
        longest : float
            [s]

        Returns
        -------
        ndarray, shape (n,)
            [unit of the weights]

        Examples
        --------
        >>> body = ModalBody(np.array([500.0]), np.array([0.02]), np.array([1.0]))
        >>> body.impulse_response(48e3).size
        5277
        """
        decay = 2.0 * np.pi * self.frequency * self.damping_ratio
        n = int(min(longest, 6.908 / float(decay.min())) * rate)
        time = np.arange(n) / rate
        damped = 2.0 * np.pi * self.frequency * np.sqrt(1.0 - self.damping_ratio**2)
        pole = np.exp((1j * damped - decay)[:, None] * (time[None, : int(0.01 * rate)]))
        # Blocks of 10 ms: each is the first block times a complex factor.
        step = np.exp((1j * damped - decay) * pole.shape[1] / rate)
        sound = np.zeros(n)
        factor = self.weight.astype(complex)
        for first in range(0, n, pole.shape[1]):
            block = (factor @ pole).imag
            sound[first : first + block.size] = block[: n - first]
            factor = factor * step
        return sound


def random_body(
    modes: tuple[float, float], damping_ratio: tuple[float, float], rng: Rng
) -> ModalBody:
    """Return a random body of 10 to 60 modes.

    Parameters
    ----------
    modes : pair of float
        Lowest and highest natural frequency of its kind [Hz].
    damping_ratio : pair of float
        Smallest and largest [-].
    rng : numpy.random.Generator

    Examples
    --------
    >>> body = random_body((80.0, 9000.0), (0.015, 0.08), np.random.default_rng(0))
    >>> 10 <= body.frequency.size <= 60
    True
    """
    least, largest = damping_ratio
    lowest = modes[0] * math.exp(rng.uniform(0.0, 1.2))
    highest = modes[1] * math.exp(rng.uniform(-0.7, 0.25))
    n = int(rng.integers(10, 61))
    place = rng.random(n)
    if rng.random() < 0.5:
        frequency = lowest + (highest - lowest) * place
    else:
        frequency = lowest * (highest / lowest) ** place
    damping = least * (largest / least) ** rng.random() * np.exp(rng.normal(0.0, 0.4, n))
    tilt = rng.uniform(-0.5, 0.7)
    weight = rng.standard_normal(n) * (frequency / lowest) ** tilt
    # Up to three modes may be much stronger than the others.
    loud = rng.integers(0, n, int(rng.integers(0, 4)) if rng.random() < 0.5 else 0)
    weight[loud] *= rng.uniform(1.0, 5.0)
    return ModalBody(frequency, np.clip(damping, 0.002, 0.12), weight)


def overlapping_modes(rate: float, rng: Rng) -> Array:
    """Return the impulse response of overlapping modes: coloured noise with a decay of 1 to 25 ms.

    Parameters
    ----------
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> sound = overlapping_modes(48e3, np.random.default_rng(0))
    >>> bool(np.abs(sound[:100]).max() > np.abs(sound[-100:]).max())
    True
    """
    lasting = log_uniform(0.001, 0.025, rng)
    n = int(7.0 * lasting * rate)
    sound = coloured_noise(n, rng.uniform(-0.6, 1.2), rng)
    sound *= np.exp(-np.arange(n) / (lasting * rate))
    return np.asarray(sound / np.abs(sound).max())


ENVELOPE_RATE = 6000.0
"""Sampling rate of the amplitudes [Hz]."""


def amplitudes(
    growth: Array, detuning: Array, coupling: Array, noise: Array, rng: Rng
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


@njit(cache=True)
def _solved(
    growth: Array, detuning: Array, coupling: Array, kicks: NDArray[np.complex128]
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


def carried(
    amplitude: NDArray[np.complex128], frequency: float, harmonics: Array, n: int, rate: float
) -> Array:
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
