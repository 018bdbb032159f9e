"""Further forms of pulses at slips: their shapes, their sizes, when they come, and where."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from noise.diagnosis.cases.draws import Array, Rng
from sim.effects.effect import Signals
from sim.effects.slip_pulse import torque_drops

if TYPE_CHECKING:
    from sim.motion import Motion


_REFERENCE_DROP = 6.94
"""As of `sim.effects.slip_pulse` [Nm]."""

_STRONGEST = 800.0
"""Force of strength 1 at that drop [N]."""


def impacts(
    a: float, form: str, threshold: float, seed: int, *, power: float = 0.5, late: float = 0.0,
    uneven: float = 0.0, chance: float = 1.0, caught: float = 0.0, either_sense: bool = False,
    **numbers: Any,
) -> dict[str, Any]:  # fmt: skip
    """Put an impact of unit peak where the contact slips.

    Its size goes with a power of the torque's drop and differs by so much (logarithmic); it comes
    late by so much at most [s], with a chance, where the slip breaks loose, where it is caught (1),
    or both (0.5).
    """
    impact = _IMPACTS[str(numbers.pop("shape", form))]
    senses = (-1.0, 1.0) if either_sense else (1.0,)

    def force(motion: Motion, _form: str, _values: Any) -> Array:
        struck = np.zeros_like(motion.torque)
        if a == 0.0:
            return struck
        where, drops = torque_drops(motion.torque, max(threshold, 1e-6))
        # Other impacts in each run, but the same in the same run.
        own = np.random.default_rng([seed, where.size, int(where.sum())])
        excess = np.maximum((drops - threshold) / (_REFERENCE_DROP - threshold), 0.0)
        peaks = _STRONGEST * a * np.minimum(excess, 3.0) ** power
        peaks *= np.exp(uneven * own.standard_normal(peaks.size)) * own.choice(senses, peaks.size)
        peaks[own.random(peaks.size) > chance] = 0.0
        starts = where + late * motion.rate * own.random(where.size)
        if caught > 0.0:
            broken = starts if caught < 1.0 else starts[:0]
            starts = np.concatenate([broken, _catches(motion, where)])
            peaks = np.resize(peaks, starts.size)
        for start, peak in zip(starts.astype(np.int64).tolist(), peaks.tolist(), strict=True):
            if abs(peak) < 1e-3:
                continue
            shape = impact(motion.rate, own, **numbers)
            stop = min(start + shape.size, struck.size)
            struck[start:stop] += peak * shape[: max(stop - start, 0)]
        return struck

    return {"force": force}


def _catches(motion: Motion, where: NDArray[np.int64]) -> Array:
    """Find the samples at which slips are caught; a slip that goes on keeps its own."""
    stuck = np.append(motion.stuck, True)
    begins = np.append(np.flatnonzero(stuck[1:] & ~stuck[:-1]) + 1, stuck.size)
    caught = begins[np.searchsorted(begins, where)]
    return np.where(caught < stuck.size - 1, caught, where).astype(np.float64)


def _half_sine(rate: float, _rng: Rng | None, duration: float) -> Array:
    n = max(2, round(duration * rate))
    return np.sin(np.pi * (np.arange(n) + 0.5) / n)


def _shaped(shape: Callable[[Array], Array], longer: float = 1.0) -> Callable[..., Array]:
    """Sample a shape over 0 to 1, its mean over each sample, so that a short one is not lost."""

    def impact(rate: float, _rng: Rng, duration: float) -> Array:
        n = max(2, round(longer * duration * rate))
        fine = np.asarray(shape((np.arange(8 * n) + 0.5) / (8 * n)))
        return np.asarray(fine.reshape(n, 8).mean(axis=1))

    return impact


def _ricker(x: Array) -> Array:
    y = 25.0 * (x - 0.5) ** 2
    return np.asarray((1.0 - 2.0 * y) * np.exp(-y))


def _bounce(rate: float, _rng: Rng, duration: float, apart: float, kept: float, n: int) -> Array:
    pulse = _half_sine(rate, None, duration)
    starts = np.concatenate([[0.0], np.cumsum(apart * kept ** np.arange(n))])
    shape = np.zeros(int(starts[-1] * rate) + pulse.size + 2)
    for i, start in enumerate(starts.tolist()):
        at = int(start * rate)
        shape[at : at + pulse.size] += kept**i * pulse
    return shape


def _crunch(rate: float, rng: Rng, length: float, dull: float, sparse: float) -> Array:
    n = max(8, round(3.0 * length * rate))
    grains = rng.standard_normal(n) * (rng.random(n) < sparse)
    grains[0] = 1.0
    decay = np.exp(-np.arange(n) / (length * rate))
    shape = np.convolve(grains * decay, _half_sine(rate, None, dull))
    return np.asarray(shape / np.abs(shape).max())


def _ring(rate: float, _rng: Rng, frequency: float, cycles: float) -> Array:
    turn = frequency * np.arange(round(4.0 * cycles / frequency * rate)) / rate
    return np.asarray(np.sin(2.0 * np.pi * turn) * np.exp(-turn / cycles))


_IMPACTS: dict[str, Callable[..., Array]] = {
    "half_sine": _half_sine,
    "bounce": _bounce,
    "crunch": _crunch,
    "ringing": _ring,
    "rectangle": _shaped(np.ones_like),
    "doublet": _shaped(lambda x: np.sin(2.0 * np.pi * x), 2.0),
    "ricker": _shaped(_ricker, 3.0),
    "step_decay": _shaped(lambda x: np.exp(-6.0 * x), 8.0),
    "rising": _shaped(lambda x: x),
}


def heard_clicks(
    a: float, frequency: float, cycles: float, power: float, level: float
) -> dict[str, Any]:
    """Click into the air alone, from the bushing's own rim."""

    def sensors(signals: Signals, rate: float, _form: str, _values: Any, _rng: Rng) -> Signals:
        if a == 0.0:
            return signals
        where, drops = torque_drops(signals["torque"], 0.05)
        clicks = np.zeros_like(signals["pressure"])
        clicks[where] = a * level * (drops / _REFERENCE_DROP) ** power
        turn = frequency * np.arange(round(5.0 * cycles / frequency * rate) + 2) / rate
        ring = np.sin(2.0 * np.pi * turn) * np.exp(-turn / cycles)
        return signals | {"pressure": signals["pressure"]
                          + fftconvolve(clicks, ring)[: clicks.size]}  # fmt: skip

    return {"sensors": sensors}
