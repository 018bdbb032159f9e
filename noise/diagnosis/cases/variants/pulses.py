"""Further forms of pulses at slips: their shapes, their sizes, when they come, and where."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    log_uniform,
    on_joint,
    on_signals,
)  # fmt: skip
from sim.effects.effect import Effect, Signals
from sim.effects.slip_pulse import torque_drops

if TYPE_CHECKING:
    from sim.motion import Motion


_REFERENCE_DROP = 6.94
"""As of `sim.effects.slip_pulse` [Nm]."""

_STRONGEST = 800.0
"""Force of strength 1 at that drop [N]."""

_DURATIONS = (1.5e-5, 6e-4)
"""[s]"""


def _impacts(
    form: str, a: float, rng: Rng, impact: Callable[[float, Rng], Array], *, power: float = 0.5,
    late: float = 0.0, uneven: float = 0.0, chance: float = 1.0, caught: float = 0.0,
    signs: tuple[float, ...] = (1.0,),
) -> Effect:  # fmt: skip
    """Put an impact ``impact(rate, rng)`` of unit peak where the contact slips.

    Its size goes with a power of the torque's drop and differs by so much (logarithmic); it comes
    late by so much at most [s], with a chance, where the slip breaks loose, where it is caught (1),
    or both (0.5).
    """
    threshold, seed = float(rng.choice([0.0, 0.0, 0.3, 1.0])), int(rng.integers(2**31))

    def force(motion: Motion) -> Array:
        struck = np.zeros_like(motion.torque)
        if a == 0.0:
            return struck
        where, drops = torque_drops(motion.torque, max(threshold, 1e-6))
        # Other impacts in each run, but the same in the same run.
        own = np.random.default_rng([seed, where.size, int(where.sum())])
        excess = np.maximum((drops - threshold) / (_REFERENCE_DROP - threshold), 0.0)
        peaks = _STRONGEST * a * np.minimum(excess, 3.0) ** power
        peaks *= np.exp(uneven * own.standard_normal(peaks.size)) * own.choice(signs, peaks.size)
        peaks[own.random(peaks.size) > chance] = 0.0
        starts = where + late * motion.rate * own.random(where.size)
        if caught > 0.0:
            broken = starts if caught < 1.0 else starts[:0]
            starts = np.concatenate([broken, _catches(motion, where)])
            peaks = np.resize(peaks, starts.size)
        for start, peak in zip(starts.astype(np.int64).tolist(), peaks.tolist(), strict=True):
            if abs(peak) < 1e-3:
                continue
            shape = impact(motion.rate, own)
            stop = min(start + shape.size, struck.size)
            struck[start:stop] += peak * shape[: max(stop - start, 0)]
        return struck

    return on_joint("slip_pulse", form, a, force)


def _catches(motion: Motion, where: NDArray[np.int64]) -> Array:
    """Find the samples at which slips are caught; a slip that goes on keeps its own."""
    stuck = np.append(motion.stuck, True)
    begins = np.append(np.flatnonzero(stuck[1:] & ~stuck[:-1]) + 1, stuck.size)
    caught = begins[np.searchsorted(begins, where)]
    return np.where(caught < stuck.size - 1, caught, where).astype(np.float64)


def _half_sine(rate: float, duration: float) -> Array:
    n = max(2, round(duration * rate))
    return np.sin(np.pi * (np.arange(n) + 0.5) / n)


def _sampled(rate: float, duration: float, shape: Callable[[Array], Array]) -> Array:
    """Sample a shape over 0 to 1, its mean over each sample, so that a short one is not lost."""
    n = max(2, round(duration * rate))
    fine = np.asarray(shape((np.arange(8 * n) + 0.5) / (8 * n)))
    return np.asarray(fine.reshape(n, 8).mean(axis=1))


def _ricker(x: Array) -> Array:
    y = 25.0 * (x - 0.5) ** 2
    return np.asarray((1.0 - 2.0 * y) * np.exp(-y))


def _shaped(form: str, shape: Callable[[Array], Array], longer: float = 1.0) -> Recipe:
    """Make a recipe of a shape over 0 to 1."""

    def recipe(a: float, rng: Rng) -> Effect:
        duration = longer * log_uniform(rng, *_DURATIONS)
        return _impacts(form, a, rng, lambda rate, _rng: _sampled(rate, duration, shape),
                        power=float(rng.choice([0.5, 1.0])))  # fmt: skip

    return recipe


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
    frequency, cycles = log_uniform(rng, 800.0, 12e3), float(rng.uniform(0.7, 6.0))

    def impact(rate: float, _rng: Rng) -> Array:
        turn = frequency * np.arange(round(4.0 * cycles / frequency * rate)) / rate
        return np.asarray(np.sin(2.0 * np.pi * turn) * np.exp(-turn / cycles))

    return _impacts("ringing", a, rng, impact)


def _half_sines(form: str, **how: object) -> Recipe:
    """Make a recipe of half-sines that come otherwise; numbers may be ranges."""

    def recipe(a: float, rng: Rng) -> Effect:
        duration = log_uniform(rng, *_DURATIONS)
        drawn = {k: float(rng.uniform(*v)) if isinstance(v, list) else v for k, v in how.items()}
        return _impacts(form, a, rng, lambda rate, _rng: _half_sine(rate, duration), **drawn)  # type: ignore[arg-type]

    return recipe


def _heard(a: float, rng: Rng) -> Effect:
    """Click into the air alone, from the bushing's own rim."""
    frequency, cycles = log_uniform(rng, 500.0, 10e3), float(rng.uniform(0.4, 5.0))
    power, level = float(rng.uniform(0.3, 1.5)), log_uniform(rng, 1.0, 15.0)

    def change(signals: Signals, rate: float, _rng: Rng) -> Signals:
        where, drops = torque_drops(signals["torque"], 0.05)
        clicks = np.zeros_like(signals["pressure"])
        clicks[where] = a * level * (drops / _REFERENCE_DROP) ** power
        turn = frequency * np.arange(round(5.0 * cycles / frequency * rate) + 2) / rate
        ring = np.sin(2.0 * np.pi * turn) * np.exp(-turn / cycles)
        return signals | {"pressure": signals["pressure"]
                          + fftconvolve(clicks, ring)[: clicks.size]}  # fmt: skip

    return on_signals("slip_pulse", "heard", a, change)


# Shapes of impacts: Hunter 1957 and Goldsmith 1960; of sources: Ricker 1953; standard practice.
PULSES: tuple[Recipe, ...] = (
    _bounce, _crunch, _ring, _heard,
    _half_sines("power", power=[0.8, 2.0]), _half_sines("same", power=0.0),
    _half_sines("late", late=[2e-4, 3e-3], uneven=0.5), _half_sines("uneven", uneven=[0.4, 1.5]),
    _half_sines("sometimes", chance=[0.1, 0.7]), _half_sines("catching", caught=1.0),
    _half_sines("both", caught=0.5), _half_sines("either_sense", signs=(-1.0, 1.0)),
    _shaped("rectangle", np.ones_like), _shaped("doublet", lambda x: np.sin(2.0 * np.pi * x), 2.0),
    _shaped("ricker", _ricker, 3.0),
    _shaped("step_decay", lambda x: np.exp(-6.0 * x), 8.0),
    _shaped("rising", lambda x: x),
)  # fmt: skip
