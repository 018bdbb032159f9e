"""What is heard in a vehicle's cabin: road, wind, engine or motor, and the fan.

Tyres shake the body below some 500 Hz, where most of the power lies; their air-borne hum has its
hump near 800 Hz, and the cavity of the tyre rings near 220 Hz. Wind falls more gently and comes in
gusts. An engine fires once every two turns and cylinder, with half orders; an electric motor
whines at high orders of its shaft, its inverter near 8 to 10 kHz.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.signal import fftconvolve

from noise.training.classifier.background_sounds.building import blow, placed, wavering
from noise.training.draws import log_uniform, wandering

_SHAPE_SPREAD = 4.0
"""Standard deviation of a drawn spectrum about its shape at each point [dB]."""

_ROAD = (
    (20, 0), (32, 0), (63, -6), (125, -17), (250, -28), (500, -36), (900, -41), (1600, -50),
    (3000, -61), (6000, -74), (12000, -88),
)  # fmt: skip
_WIND = (
    (20, 0), (63, -8), (125, -14), (250, -21), (500, -27), (1000, -33), (2000, -40), (4000, -49),
    (8000, -60), (14000, -70),
)  # fmt: skip
_FAN = ((20, -8), (100, -3), (400, 0), (1000, -4), (2500, -14), (6000, -28), (12000, -44))
"""Spectra [dB] over frequency [Hz]."""


class Cabin(NamedTuple):
    """A family of cabins; ranges of what its members are.

    Parameters
    ----------
    road, wind, fan, drive : pair of float
        Levels of the four [dB].
    turns : pair of float
        Of the crankshaft or motor [1/s].
    cylinders : tuple of int
        ``0`` is an electric motor.
    roll_off : pair of float
        How fast the amplitudes of the orders fall with their frequency [-].
    """

    road: tuple[float, float]
    wind: tuple[float, float]
    fan: tuple[float, float]
    drive: tuple[float, float]
    turns: tuple[float, float]
    cylinders: tuple[int, ...]
    roll_off: tuple[float, float]


CABINS = {
    "petrol_car": Cabin((-6, 6), (-14, 4), (-45, -20), (-14, 2), (13, 70), (3, 4, 6), (1.5, 3.0)),
    "diesel_car": Cabin((-6, 6), (-14, 4), (-45, -20), (-8, 6), (12, 55), (4, 5, 6), (1.2, 2.5)),
    "electric_car": Cabin((-4, 6), (-12, 5), (-40, -16), (-46, -22), (10, 180), (0,), (0.3, 1.5)),
    "standing_car": Cabin((-60, -30), (-50, -20), (-16, 0), (-6, 6), (11, 17), (3, 4), (1.0, 2.5)),
    "van": Cabin((-2, 8), (-8, 6), (-36, -12), (-6, 6), (12, 55), (4,), (1.0, 2.2)),
    "lorry": Cabin((-8, 4), (-10, 4), (-34, -10), (0, 8), (9, 30), (6,), (1.0, 2.2)),
    "convertible": Cabin((-8, 2), (4, 14), (-45, -25), (-10, 2), (15, 70), (4, 6), (1.2, 2.5)),
}
"""By name."""


def cabin(kind: str, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a cabin's noise.

    Parameters
    ----------
    kind : str
        One of `CABINS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        Of unit standard deviation [-].

    Examples
    --------
    >>> sound = cabin("petrol_car", 4800, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(sound.std()), 6)
    ((4800,), 1.0)
    """
    what = CABINS[kind]
    road = _road(n, rate, rng)
    wind = shaped_noise(n, rate, _WIND, rng)
    wind *= np.exp(rng.uniform(0.0, 0.5) * wandering(n, rate, rng.uniform(0.3, 3.0), rng))
    fan = shaped_noise(n, rate, _FAN, rng)
    turns = log_uniform(*what.turns, rng) * wavering(n, rate, 0.4, rng.uniform(0.0, 0.15), rng)
    cylinders = int(rng.choice(what.cylinders))
    roll_off = rng.uniform(*what.roll_off)
    if cylinders:
        drive = orders(turns, rate, 0.5, 0.5 * cylinders, roll_off, rng)
    else:
        drive = orders(turns, rate, 4.0, float(rng.choice((24.0, 36.0, 48.0))), roll_off, rng)
        drive += 10.0 ** rng.uniform(-2.5, -0.5) * _inverter(turns, rate, rng)
    levels = (what.road, what.wind, what.fan, what.drive)
    sound = np.zeros(n)
    for part, level in zip((road, wind, fan, drive), levels, strict=True):
        sound += 10.0 ** (rng.uniform(*level) / 20.0) * part / (part.std() + 1e-12)
    return np.asarray(sound / sound.std())


def shaped_noise(
    n: int, rate: float, shape: Sequence[tuple[float, float]], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Noise whose spectrum follows a shape, but for a random deviation at each point and a tilt.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    shape : sequence of pair of float
        Frequencies [Hz], rising, and spectral density there [dB].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        Of unit standard deviation [-].

    Examples
    --------
    >>> noise = shaped_noise(4800, 48e3, ((20, 0), (8000, -40)), np.random.default_rng(0))
    >>> round(float(noise.std()), 6)
    1.0
    """
    at, level = np.array(shape, dtype=np.float64).T
    octave = np.log2(at)
    level = level + rng.normal(0.0, _SHAPE_SPREAD, at.size)
    level += rng.uniform(-2.0, 2.0) * (octave - octave.mean())
    m = next_fast_len(n, real=True)
    frequency = np.maximum(rfftfreq(m, 1.0 / rate), 10.0)
    gain = 10.0 ** (np.interp(np.log2(frequency), octave, level) / 20.0)
    noise = irfft(rfft(rng.standard_normal(m)) * gain, m)[:n]
    return np.asarray(noise / noise.std())


def orders(
    turns: NDArray[np.float64],
    rate: float,
    spacing: float,
    main: float,
    roll_off: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return the orders of a turning shaft; those that the main one divides are the strongest.

    Parameters
    ----------
    turns : ndarray, shape (n,)
        Of the shaft [1/s].
    rate : float
        [Hz]
    spacing, main : float
        Distance of the orders, and the order of firing, teeth or pistons [-].
    roll_off : float
        Their amplitudes fall with the order to this power [-].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> sound = orders(np.full(4800, 25.0), 48e3, 0.5, 2.0, 1.0, np.random.default_rng(0))
    >>> sound.shape
    (4800,)
    """
    phase = 2.0 * np.pi * np.cumsum(turns) / rate
    sound = np.zeros(turns.size)
    weaker = rng.uniform(0.03, 0.4)
    numbers = np.unique(np.r_[spacing * np.arange(1, 9), main * np.arange(1, 16)])
    for number in numbers.tolist():
        if number * float(turns.max()) > 0.45 * rate:
            break
        strength = (number / main) ** -roll_off * rng.lognormal(0.0, 0.6)
        if number % main:
            strength *= weaker * min(1.0, (number / main) ** roll_off)
        sound += strength * np.sin(number * phase + rng.uniform(0.0, 6.3))
    return sound


def _road(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw the noise of rolling over a rough surface, at times over joints."""
    sound = shaped_noise(n, rate, _ROAD, rng)
    cavity = rng.uniform(190.0, 250.0)
    narrow = ((20, -60), (cavity / 1.2, -25), (cavity, 0), (1.2 * cavity, -25), (8000, -60))
    sound += rng.uniform(0.0, 0.5) * shaped_noise(n, rate, narrow, rng)
    rough = rng.uniform(0.0, 0.6) * wandering(n, rate, log_uniform(0.3, 10.0, rng), rng)
    sound *= np.exp(rough)
    if rng.random() < 0.25:  # a joint under the front axle and then under the rear
        gap = rng.uniform(0.08, 0.25)
        times = np.arange(rng.random(), n / rate, rng.uniform(0.4, 1.5))
        joints = placed(n, np.r_[times, times + gap], np.ones(2 * times.size), rate)
        thump = blow(rate, (40.0, 500.0), (0.01, 0.06), rng, noise=0.5)
        knocks = fftconvolve(joints, thump)[:n] if times.size else joints
        sound += log_uniform(1.0, 6.0, rng) * knocks / (np.abs(knocks).max() + 1e-12)
    return sound


def _inverter(
    turns: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Switching tone with side lines at multiples of the motor's electrical frequency."""
    carrier = rng.uniform(7e3, 10e3)
    phase = 2.0 * np.pi * np.cumsum(turns) / rate * float(rng.choice((3.0, 4.0)))
    time = np.arange(turns.size) / rate
    sound = np.zeros(turns.size)
    if carrier < 0.4 * rate:
        for side in (-4, -2, 0, 2, 4):
            angle = 2.0 * np.pi * carrier * time + side * phase + rng.uniform(0.0, 6.3)
            sound += rng.uniform(0.1, 1.0) * np.sin(angle)
    return sound
