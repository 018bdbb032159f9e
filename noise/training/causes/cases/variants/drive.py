"""Further forms of a drive that turns unevenly, and of pulses at slips."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import fftconvolve, lfilter

from noise.diagnosis.cases.draws import telegraph
from noise.training.causes.cases.variants.sensors import on_signals
from sim.effects.slip_pulse import torque_drops

_REFERENCE_DROP = 6.94
"""As of `sim.effects.slip_pulse` [Nm]."""


def uneven(a, form, most=0.6, **numbers):
    """Change the speed by a time series, of a depth at strength 1 as a sine has it."""

    def drive(speed, rate, _form, _values, rng):
        q = _SERIES[form](np.arange(speed.size) / rate, rate, rng, **numbers)
        q = q - q.mean()
        size = float(q.std())
        depth = most * a * math.sqrt(0.5) / size if size > 1e-9 else 0.0
        return speed * (1.0 + np.maximum(depth * q, -0.95))  # it does not turn back

    return {"drive": drive}


def _sawtooth(time, _rate, rng, frequency, width):
    turn = (frequency * time + rng.random()) % 1.0
    return np.where(turn < width, turn / width, (1.0 - turn) / (1.0 - width))


def _belt_slip(time, rate, rng, often, recovery):
    slips = (rng.random(time.size) < often / rate) * rng.exponential(1.0, time.size)
    slips[int(rng.integers(time.size))] += 1.0
    attack, decay = math.exp(-1.0 / (2e-3 * rate)), math.exp(-1.0 / (recovery * rate))
    return -lfilter([1.0], np.convolve([1.0, -attack], [1.0, -decay]), slips)


def _two(time, rng, one, other, balance):
    """Two sines of angular frequencies, of which the other is so much weaker."""
    phases = 2.0 * np.pi * rng.random(2)
    return np.sin(one * time + phases[0]) + balance * np.sin(other * time + phases[1])


def _controller(time, rate, rng, frequency, damping):
    coarse = 2000.0  # [Hz]; far above any controller
    n = math.ceil(time.size / rate * coarse) + 2
    before = math.ceil(coarse / (damping * frequency))
    radius = math.exp(-2.0 * math.pi * damping * frequency / coarse)
    poles = [1.0, -2.0 * radius * math.cos(2.0 * math.pi * frequency / coarse), radius**2]
    ringing = lfilter([1.0], poles, rng.standard_normal(n + before))[before:]
    return np.interp(time, np.arange(n) / coarse, ringing)


def _steps(time, rate, rng, often, rounding):
    decay = math.exp(-1.0 / (rounding * rate))
    smooth = [(1.0 - decay) ** 2], [1.0, -2.0 * decay, decay**2]
    return lfilter(*smooth, telegraph(rng, time.size, rate, often))


def _hunting(time, _rate, rng, frequency, wide, slow):
    """Hunt with a frequency that wanders."""
    wander = wide * frequency / slow * np.sin(2 * np.pi * (slow * time + rng.random()))
    return np.sin(2 * np.pi * (frequency * time + rng.random()) + wander)


_SERIES = {
    "sawtooth": _sawtooth, "belt_slip": _belt_slip, "controller_resonance": _controller,
    "steps": _steps, "hunting": _hunting,
    "beating": lambda time, _rate, rng, frequency, apart, balance: _two(
        time, rng, 2 * np.pi * frequency, 2 * np.pi * (frequency * (1.0 + apart)), balance),
    "ripple": lambda time, _rate, rng, frequency, second, balance: _two(
        time, rng, 2 * np.pi * frequency, 2 * np.pi * second * frequency, balance),
    "ramp": lambda time, _rate, _rng, bend, sign: sign * (time / (float(time[-1]) or 1.0)) ** bend,
}  # fmt: skip
"""A ripple pulses with poles, teeth or the inverter; a ramp is a drive that warms or is let go."""


def impacts(
    a, form, threshold, seed, *, power=0.5, late=0.0, uneven=0.0, chance=1.0, caught=0.0,
    either_sense=False, **numbers
):  # fmt: skip
    """Put an impact of unit peak where the contact slips.

    Its size goes with a power of the torque's drop and differs by so much (logarithmic); it comes
    late by so much at most [s], with a chance, where the slip breaks loose, where it is caught (1),
    or both (0.5).
    """
    impact = _IMPACTS[str(numbers.pop("shape", form))]
    senses = (-1.0, 1.0) if either_sense else (1.0,)

    def force(motion, _form, _values):
        struck = np.zeros_like(motion.torque)
        if a == 0.0:
            return struck
        where, drops = torque_drops(motion.torque, max(threshold, 1e-6))
        # Other impacts in each run, but the same in the same run.
        own = np.random.default_rng([seed, where.size, int(where.sum())])
        excess = np.maximum((drops - threshold) / (_REFERENCE_DROP - threshold), 0.0)
        peaks = 800.0 * a * np.minimum(excess, 3.0) ** power
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


def _catches(motion, where):
    """Find the samples at which slips are caught; a slip that goes on keeps its own."""
    stuck = np.append(motion.stuck, True)
    begins = np.append(np.flatnonzero(stuck[1:] & ~stuck[:-1]) + 1, stuck.size)
    caught = begins[np.searchsorted(begins, where)]
    return np.where(caught < stuck.size - 1, caught, where).astype(np.float64)


def _half_sine(rate, _rng, duration):
    n = max(2, round(duration * rate))
    return np.sin(np.pi * (np.arange(n) + 0.5) / n)


def _shaped(shape, longer=1.0):
    """Sample a shape over 0 to 1, its mean over each sample, so that a short one is not lost."""

    def impact(rate, _rng, duration):
        n = max(2, round(longer * duration * rate))
        return shape((np.arange(8 * n) + 0.5) / (8 * n)).reshape(n, 8).mean(axis=1)

    return impact


def _ricker(x):
    y = 25.0 * (x - 0.5) ** 2
    return (1.0 - 2.0 * y) * np.exp(-y)


def _bounce(rate, _rng, duration, apart, restitution, n):
    pulse = _half_sine(rate, None, duration)
    starts = np.concatenate([[0.0], np.cumsum(apart * restitution ** np.arange(n))])
    shape = np.zeros(int(starts[-1] * rate) + pulse.size + 2)
    for i, start in enumerate(starts.tolist()):
        at = int(start * rate)
        shape[at : at + pulse.size] += restitution**i * pulse
    return shape


def _crunch(rate, rng, length, dull, sparse):
    n = max(8, round(3.0 * length * rate))
    grains = rng.standard_normal(n) * (rng.random(n) < sparse)
    grains[0] = 1.0
    decay = np.exp(-np.arange(n) / (length * rate))
    shape = np.convolve(grains * decay, _half_sine(rate, None, dull))
    return shape / np.abs(shape).max()


def _ring(rate, _rng, frequency, cycles, lasting=4.0, more=0):
    turn = frequency * np.arange(round(lasting * cycles / frequency * rate) + more) / rate
    return np.sin(2.0 * np.pi * turn) * np.exp(-turn / cycles)


_IMPACTS = {
    "half_sine": _half_sine, "bounce": _bounce, "crunch": _crunch, "ringing": _ring,
    "rectangle": _shaped(np.ones_like),
    "doublet": _shaped(lambda x: np.sin(2.0 * np.pi * x), 2.0),
    "ricker": _shaped(_ricker, 3.0),
    "step_decay": _shaped(lambda x: np.exp(-6.0 * x), 8.0),
    "rising": _shaped(lambda x: x),
}  # fmt: skip


def clicks_beside(a, frequency, cycles, power, level):
    """Click into the air alone, from the bushing's own rim."""

    def change(signals, rate, _rng):
        where, drops = torque_drops(signals["torque"], 0.05)
        clicks = np.zeros_like(signals["pressure"])
        clicks[where] = a * level * (drops / _REFERENCE_DROP) ** power
        ringing = fftconvolve(clicks, _ring(rate, None, frequency, cycles, 5.0, 2))[: clicks.size]
        return signals | {"pressure": signals["pressure"] + ringing}

    return on_signals(a, change)
