"""Squawks: several discrete frequencies, sustained, as `noise.noise_definition` defines them.

- chatter: a slider on a spring at a steady drive sticks and slips some 60 to 500 times a second,
  and the sawtooth of its force, whose harmonics lie within 18 dB of the first, is heard through a
  body that is damped too well to knock.
- modes: friction feeds two to five modes at once, none of which wins, with harmonics.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from noise.training.classifier.friction_sources.limit_cycle import (
    ENVELOPE_RATE,
    amplitudes,
    carried,
)
from noise.training.classifier.friction_sources.modal_body import ModalBody
from noise.training.classifier.friction_sources.slider import slide
from noise.training.draws import coloured_noise, log_uniform, wandering

SQUAWKS = ("chatter", "modes")
"""What squawks."""


def squawk(kind: str, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a squawk of unit peak.

    Parameters
    ----------
    kind : str
        One of `SQUAWKS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> sound = squawk("chatter", 24_000, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((24000,), 1.0)
    """
    sound = _chatter(n, rate, rng) if kind == "chatter" else _modes(n, rate, rng)
    hiss = coloured_noise(n, rng.uniform(0.2, 1.5), rng)
    sound = sound + float(sound.std()) * 10.0 ** (rng.uniform(-40.0, -10.0) / 20.0) * hiss
    return np.asarray(sound / np.abs(sound).max())


def _chatter(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    slips_a_second = log_uniform(60.0, 500.0, rng)
    drive = np.full(n, slips_a_second)
    drive *= 1.0 + rng.uniform(0.0, 0.03) * wandering(n, rate, rng.uniform(0.5, 5.0), rng)
    slips = slide(
        drive,
        rate,
        ageing_time=rng.uniform(0.02, 0.1) / slips_a_second,
        scatter=rng.uniform(0.0, 0.04),
        rng=rng,
    )
    # The spring's force: it rises with the drive and falls at each slip, in a millisecond or so.
    force = np.cumsum(drive) / rate
    fallen = np.zeros(n)
    np.add.at(fallen, np.minimum((slips.time * rate).astype(int), n - 1), slips.size)
    m = max(2, int(rng.uniform(0.03, 0.25) / slips_a_second * rate))
    fall = np.hanning(m + 2)[1:-1]
    force -= np.cumsum(fftconvolve(fallen, fall / fall.sum())[:n])
    body = ModalBody(
        np.exp(rng.uniform(math.log(120.0), math.log(2500.0), int(rng.integers(3, 9)))),
        rng.uniform(0.08, 0.3, 1),
        np.ones(1),
    )
    # Broad resonances over the force itself: no blow rings on until the next.
    response = ModalBody(
        body.frequency,
        np.broadcast_to(body.damping_ratio, body.frequency.shape),
        rng.standard_normal(body.frequency.size),
    ).impulse_response(rate)
    through = fftconvolve(np.gradient(force), response)[:n]
    direct = np.gradient(force)
    return np.asarray(
        through / (through.std() + 1e-12) + rng.uniform(0.2, 1.0) * direct / (direct.std() + 1e-12)
    )


def _modes(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    n_modes = int(rng.integers(2, 6))
    m = int(n / rate * ENVELOPE_RATE) + 2
    frequency = np.exp(rng.uniform(math.log(110.0), math.log(2200.0), n_modes))
    pace = 2.0 * np.pi * frequency * rng.uniform(0.003, 0.03)
    wander = [wandering(m, ENVELOPE_RATE, rng.uniform(0.5, 4.0), rng) for _ in range(n_modes)]
    growth = pace[:, None] * (1.0 + 0.2 * np.array(wander))
    detuning = 2.0 * np.pi * frequency[:, None] * rng.uniform(0.0, 0.01) * np.array(wander)
    weak = rng.uniform(0.0, 0.3)
    coupling = pace[:, None] * (np.eye(n_modes) * (1.0 - weak) + weak)
    noise = rng.uniform(0.02, 0.4) * np.sqrt(pace)
    solved = amplitudes(growth, detuning, coupling, noise, rng)
    sound = np.zeros(n)
    for i in range(n_modes):
        fall = rng.uniform(-25.0, -6.0)
        harmonics = np.power(10.0, fall * np.arange(float(rng.integers(1, 5))) / 20.0)
        strength = 10.0 ** (rng.uniform(-12.0, 0.0) / 20.0)
        sound += strength * carried(solved[i], float(frequency[i]), harmonics, n, rate)
    return sound
