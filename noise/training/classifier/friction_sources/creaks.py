"""Creaks of doors, floors, trees, hinges and panels: slips that strike a body.

Each slip of `noise.training.classifier.friction_sources.slider` lets go of a force in proportion to
its size, as a pulse of half a sine, 0.03 to 0.5 ms long, with the rattle of its asperities; the
body (`noise.training.classifier.friction_sources.modal_body`) rings from it. Two contacts may creak
at once, and the sliding between hisses softly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from noise.training.classifier.friction_sources.modal_body import overlapping_modes, random_body
from noise.training.classifier.friction_sources.slider import Slips, random_drive, slide
from noise.training.draws import coloured_noise, log_uniform

CREAKS = ("door", "floor", "tree", "hinge", "plastic")
"""What creaks; the names of its materials."""

_FASTEST = {"door": 350.0, "floor": 200.0, "tree": 300.0, "hinge": 500.0, "plastic": 250.0}
"""Of the slips' rates, where the drive is fast [1/s]."""


def creak(material: str, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a creak of unit peak.

    Parameters
    ----------
    material : str
        One of `CREAKS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> sound = creak("door", 24_000, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((24000,), 1.0)
    """
    sound = np.zeros(n)
    for _ in range(2 if rng.random() < 0.2 else 1):
        slips = random_slips(material, n, rate, rng)
        force = pulses(slips, n, rate, rng)
        parts = [_unit(random_body(material, rng).impulse_response(rate))]
        parts.append(10.0 ** (rng.uniform(-25.0, 20.0) / 20.0) * overlapping_modes(rate, rng))
        if rng.random() < 0.4:  # what it is fixed to sounds as well
            other = random_body(CREAKS[int(rng.integers(len(CREAKS)))], rng)
            parts.append(rng.uniform(0.1, 1.0) * _unit(other.impulse_response(rate)))
        body = np.zeros(max(part.size for part in parts))
        for part in parts:
            body[: part.size] += part
        struck = fftconvolve(force, body)[:n]
        # The contact itself is heard as well, as a click without a body's voice.
        click = np.diff(force, prepend=0.0)
        direct = 10.0 ** (rng.uniform(-30.0, 0.0) / 20.0) * float(np.abs(struck).max())
        struck = struck + direct * click / (np.abs(click).max() + 1e-300)
        peak = float(np.abs(struck).max())
        sound += rng.uniform(0.4, 1.0) * struck / peak if peak > 0.0 else 0.0
    level = float(np.abs(sound).max()) * 10.0 ** rng.uniform(-4.0, -1.6)
    sound = sound + level * coloured_noise(n, rng.uniform(0.3, 1.5), rng)
    return np.asarray(sound / np.abs(sound).max())


def _unit(response: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(response / np.abs(response).max())


def random_slips(material: str, n: int, rate: float, rng: np.random.Generator) -> Slips:
    """Draw a drive and a contact, and find their slips; at least eight a second on the whole.

    Examples
    --------
    >>> slips = random_slips("tree", 48_000, 48e3, np.random.default_rng(1))
    >>> slips.time.size >= 8
    True
    """
    while True:
        fastest = _FASTEST[material] * math.exp(rng.uniform(-1.6, 0.3))
        slowest = max(4.0, fastest * math.exp(-rng.uniform(0.7, 4.0)))
        if slowest > 0.7 * fastest:
            continue
        drive = random_drive(n, rate, slowest, fastest, rng)
        slips = slide(
            drive,
            rate,
            ageing_time=log_uniform(3e-4, 3e-2, rng),
            scatter=log_uniform(0.02, 0.35, rng),
            rng=rng,
        )
        if slips.time.size >= 8.0 * n / rate and slips.time.size < 900.0 * n / rate:
            return slips


def pulses(slips: Slips, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Force of the slips: pulses of random strength about their size, with a rattle.

    Parameters
    ----------
    slips : Slips
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> slips = Slips(np.array([0.01]), np.array([1.0]))
    >>> force = pulses(slips, 960, 48e3, np.random.default_rng(0))
    >>> bool(np.abs(force[:470]).max() < 1e-9), bool(force.max() > 0.0)
    (True, True)
    """
    strength = slips.size ** rng.uniform(0.6, 1.6) * np.exp(
        rng.normal(0.0, rng.uniform(0.02, 0.5), slips.size.size)
    )
    place = slips.time * rate
    first = np.clip(place.astype(int), 0, n - 2)
    part = np.clip(place - first, 0.0, 1.0)
    train = np.zeros(n)
    np.add.at(train, first, strength * (1.0 - part))
    np.add.at(train, first + 1, strength * part)
    m = max(2, int(log_uniform(3e-5, 5e-4, rng) * rate))
    shape = np.sin(np.pi * (np.arange(m) + 0.5) / m)
    rattle = rng.standard_normal(4 * m) * np.exp(-np.arange(4 * m) / m)
    shape = np.concatenate([shape, np.zeros(3 * m)]) + rng.uniform(0.0, 0.8) * rattle
    return np.asarray(fftconvolve(train, shape)[:n])
