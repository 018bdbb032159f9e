"""Further forms of what clamp, beams and anchors add: modes, waves and impacts."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import butter, fftconvolve, lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    log_uniform,
    log_uniforms,
    on_chain,
    on_joint,
)  # fmt: skip
from sim.chain import HIGHEST_SHARE, padded_sum, resonance
from sim.effects.slip_pulse import torque_drops

if TYPE_CHECKING:
    from collections.abc import Callable

    from models.radiation.impulse_responses import ImpulseResponses
    from sim.effects.effect import Effect
    from sim.motion import Motion

__all__ = ["BEAMS", "PULSES", "waveguide"]

_REFERENCE_DROP = 6.94
_LONGEST = 0.25
"""Waves are followed so long at most [s]."""


def waveguide(rate: float, first: float, reflection: float, dullness: float) -> Array:
    """Impulse response of a way that a wave goes to and fro, its echoes without the first pass.

    Parameters
    ----------
    rate, first : float
        Sampling rate; how often a second it returns [Hz].
    reflection : float
        Signed, below 1 in magnitude [-].
    dullness : float
        From 0 to 0.5: of what is reflected, how much is smoothed away at the highest frequencies
        [-].

    Returns
    -------
    ndarray, shape (n,)
        Over the impulse [-].

    Examples
    --------
    >>> waveguide(8.0, 2.0, 0.5, 0.0)[:9]
    array([0.  , 0.  , 0.  , 0.  , 0.5 , 0.  , 0.  , 0.  , 0.25])
    """
    way = max(2, round(rate / first))
    passes = np.log(1e-4) / np.log(abs(reflection))
    unit = np.zeros(int(min(passes * way + way, max(_LONGEST * rate, 3 * way))))
    unit[0] = 1.0
    echo = np.zeros(way + 2)
    echo[way - 1 :] = reflection * np.array([0.5 * dullness, 1.0 - dullness, 0.5 * dullness])
    denominator = -echo
    denominator[0] += 1.0
    return np.asarray(lfilter(echo, denominator, unit))


def _with_modes(form: str, a: float, rng: Rng, modes: list[tuple[float, float, float]]) -> Effect:
    """Add modes: frequency [Hz], damping ratio, constant."""
    mass = log_uniform(rng, 0.005, 0.08)

    def change(paths: ImpulseResponses, _rng: Rng) -> ImpulseResponses:
        if not np.any(paths.pulse_to_acceleration):
            return paths  # the clamp is bolted down
        accelerations, forces = [paths.torque_to_acceleration], [np.zeros(1)]
        for frequency, damping, constant in modes:
            if frequency > HIGHEST_SHARE * paths.rate:
                continue
            mode = frequency, damping, paths.rate
            accelerations.append(a * constant * resonance([1.0, 0.0, 0.0], *mode))
            forces.append(a * mass * constant * resonance([0.0, 0.0, 1.0], *mode))
        return _with_force(paths, padded_sum(accelerations), padded_sum(forces))

    return on_chain("beam_modes", form, a, change)


def _with_force(paths: ImpulseResponses, acceleration: Array, force: Array) -> ImpulseResponses:
    pressure = fftconvolve(force, paths.pulse_to_pressure)
    return replace(
        paths,
        torque_to_acceleration=acceleration,
        torque_to_pressure=padded_sum([paths.torque_to_pressure, pressure]),
    )


def _several(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(3, 8))
    frequencies = log_uniforms(rng, 350.0, 9000.0, n)
    constants = log_uniform(rng, 8.0, 40.0) * rng.choice([-1.0, 1.0], n) * rng.uniform(0.2, 1.0, n)
    dampings = log_uniforms(rng, 0.004, 0.06, n)
    columns = (frequencies.tolist(), dampings.tolist(), constants.tolist())
    return _with_modes("several", a, rng, list(zip(*columns, strict=True)))


def _split(a: float, rng: Rng) -> Effect:
    frequency, constant = log_uniform(rng, 350.0, 6000.0), log_uniform(rng, 8.0, 40.0)
    damping = log_uniform(rng, 0.003, 0.02)
    other = frequency * (1.0 + float(rng.uniform(1.0, 8.0)) * damping)
    second = constant * float(rng.uniform(-1.0, 1.0))
    return _with_modes("split", a, rng, [(frequency, damping, constant), (other, damping, second)])


def _crowd(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(15, 35))
    low = log_uniform(rng, 400.0, 3000.0)
    frequencies = rng.uniform(low, low * float(rng.uniform(2.0, 5.0)), n)
    constants = 25.0 / np.sqrt(n) * rng.standard_normal(n) * float(rng.uniform(0.5, 1.5))
    damping = log_uniform(rng, 0.01, 0.05)
    pairs = zip(frequencies.tolist(), constants.tolist(), strict=True)
    return _with_modes("crowd", a, rng, [(f, damping, c) for f, c in pairs])


def _beam_waveguide(a: float, rng: Rng) -> Effect:
    first, constant = log_uniform(rng, 300.0, 3000.0), log_uniform(rng, 8.0, 40.0)
    reflection = float(rng.choice([-1.0, 1.0])) * (1.0 - log_uniform(rng, 0.02, 0.25))
    dullness, mass = float(rng.uniform(0.05, 0.5)), log_uniform(rng, 0.005, 0.08)

    def change(paths: ImpulseResponses, _rng: Rng) -> ImpulseResponses:
        if not np.any(paths.pulse_to_acceleration):
            return paths
        echoes = waveguide(paths.rate, first, reflection, dullness)
        b, c = butter(2, 2.0 * 0.4 * first / paths.rate, "highpass")
        acceleration = a * constant * np.asarray(lfilter(b, c, np.append(echoes, np.zeros(512))))
        b, c = butter(2, 2.0 * min(6.0 * first, 0.4 * paths.rate) / paths.rate)
        both = padded_sum([paths.torque_to_acceleration, acceleration])
        return _with_force(paths, both, mass * np.asarray(lfilter(b, c, acceleration)))

    return on_chain("beam_modes", "waveguide", a, change)


def _impacts(
    form: str,
    a: float,
    rng: Rng,
    impact: Callable[[float, Rng], Array],
    *,
    power: float = 0.5,
    late: float = 0.0,
) -> Effect:
    """Put a impact ``impact(rate, rng)`` of unit peak at each drop, late by so much at most [s]."""
    threshold, seed = float(rng.choice([0.0, 0.0, 1.0, 3.0])), int(rng.integers(2**31))

    def force(motion: Motion) -> Array:
        struck = np.zeros_like(motion.torque)
        if a == 0.0:
            return struck
        where, drops = torque_drops(motion.torque, max(threshold, 1e-6))
        # Other impacts in each run, but the same in the same run.
        chance = np.random.default_rng([seed, where.size, int(where.sum())])
        excess = np.maximum((drops - threshold) / (_REFERENCE_DROP - threshold), 0.0)
        for at, peak in zip(where, 250.0 * a * excess**power, strict=True):
            if peak < 1e-3:
                continue
            shape = impact(motion.rate, chance)
            start = int(at + late * motion.rate * chance.random())
            stop = min(start + shape.size, struck.size)
            struck[start:stop] += peak * shape[: max(stop - start, 0)]
        return struck

    return on_joint("slip_pulse", form, a, force)


def _half_sine(rate: float, duration: float) -> Array:
    n = max(2, round(duration * rate))
    return np.sin(np.pi * (np.arange(n) + 0.5) / n)


def _bounce(a: float, rng: Rng) -> Effect:
    duration, apart = log_uniform(rng, 2e-5, 2e-4), log_uniform(rng, 4e-4, 4e-3)
    kept, n = float(rng.uniform(0.4, 0.85)), int(rng.integers(3, 8))

    def impact(rate: float, _rng: Rng) -> Array:
        pulse = _half_sine(rate, duration)
        starts = np.concatenate([[0.0], np.cumsum(apart * kept ** np.arange(n))])
        shape = np.zeros(int(starts[-1] * rate) + pulse.size + 2)
        for i, start in enumerate(starts.tolist()):
            at = int(start * rate)
            shape[at : at + pulse.size] += kept**i * pulse
        return shape

    return _impacts("bounce", a, rng, impact)


def _crunch(a: float, rng: Rng) -> Effect:
    length, dull = log_uniform(rng, 5e-4, 6e-3), log_uniform(rng, 2e-5, 2e-4)
    sparse = float(rng.uniform(0.05, 1.0))

    def impact(rate: float, rng: Rng) -> Array:
        n = max(8, round(3.0 * length * rate))
        grains = rng.standard_normal(n) * (rng.random(n) < sparse)
        grains[0] = 1.0
        decay = np.exp(-np.arange(n) / (length * rate))
        shape = np.convolve(grains * decay, _half_sine(rate, dull))
        return np.asarray(shape / np.abs(shape).max())

    return _impacts("crunch", a, rng, impact)


def _ring(a: float, rng: Rng) -> Effect:
    frequency, cycles = log_uniform(rng, 1500.0, 12e3), float(rng.uniform(0.7, 4.0))

    def impact(rate: float, _rng: Rng) -> Array:
        turn = frequency * np.arange(round(4.0 * cycles / frequency * rate)) / rate
        return np.asarray(np.sin(2.0 * np.pi * turn) * np.exp(-turn / cycles))

    return _impacts("ringing", a, rng, impact)


def _proportional(a: float, rng: Rng) -> Effect:
    duration, power = log_uniform(rng, 2e-5, 2.5e-4), float(rng.uniform(0.8, 2.0))
    return _impacts("power", a, rng, lambda rate, _rng: _half_sine(rate, duration), power=power)


def _late(a: float, rng: Rng) -> Effect:
    duration, late = log_uniform(rng, 2e-5, 2.5e-4), log_uniform(rng, 2e-4, 3e-3)

    def impact(rate: float, rng: Rng) -> Array:
        return np.asarray(np.exp(0.5 * rng.standard_normal()) * _half_sine(rate, duration))

    return _impacts("late", a, rng, impact, late=late)


BEAMS: tuple[Recipe, ...] = (_several, _split, _crowd, _beam_waveguide)
PULSES: tuple[Recipe, ...] = (_bounce, _crunch, _ring, _proportional, _late)
