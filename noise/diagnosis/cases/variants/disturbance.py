"""Further forms of noise and hum on the channels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import butter, lfilter

from noise.diagnosis.cases.variants.common import (
    SENSED,
    Array,
    Recipe,
    Rng,
    log_uniform,
    on_sensors,
    telegraph,
    wander,
)  # fmt: skip

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.effects.effect import Effect

__all__ = ["HUM", "NOISE"]


def _adds(
    name: str,
    form: str,
    a: float,
    rng: Rng,
    levels: tuple[float, float, float],
    time_series: Callable[[int, float, Rng], Array],
) -> Effect:
    """Add a time series of rms 1 times a level to all channels, or to one or two of them."""
    sizes = np.array(levels) * rng.uniform(0.2, 1.0, 3)
    if rng.random() < 0.4:
        sizes[rng.choice(3, int(rng.integers(1, 3)), replace=False)] = 0.0
    shares = dict(zip(SENSED, (a * sizes).tolist(), strict=True))

    def change(x: Array, level: float, rate: float, rng: Rng) -> Array:
        added = time_series(x.size, rate, rng)
        return np.asarray(x + level * added / (float(np.sqrt(np.mean(added**2))) + 1e-30))

    return on_sensors(name, form, a, shares, change)


def _noisy(
    form: str, a: float, rng: Rng, time_series: Callable[[int, float, Rng], Array]
) -> Effect:
    return _adds("background_noise", form, a, rng, (0.15, 8.0, 0.3), time_series)


def _coloured(n: int, rate: float, rng: Rng, exponent: float) -> Array:
    gain = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 20.0) ** (-0.5 * exponent)
    return np.asarray(np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n))


def _bursts(a: float, rng: Rng) -> Effect:
    often, quiet = log_uniform(rng, 6.0, 80.0), float(rng.uniform(0.0, 0.2))
    exponent = float(rng.uniform(0.0, 2.0))

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        b, c = butter(1, 2.0 * 300.0 / rate)
        gate = lfilter(b, c, telegraph(rng, n, rate, often) > 0.0)
        return np.asarray((quiet + gate) * _coloured(n, rate, rng, exponent))

    return _noisy("bursts", a, rng, time_series)


def _clicks(a: float, rng: Rng) -> Effect:
    often, frequency = log_uniform(rng, 8.0, 300.0), log_uniform(rng, 400.0, 10e3)
    cycles, tails = log_uniform(rng, 0.2, 5.0), float(rng.uniform(0.3, 1.0))

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        heights = rng.standard_normal(n) * np.exp(tails * rng.standard_normal(n))
        impacts = heights * (rng.random(n) < often / rate)
        impacts[int(rng.integers(n))] += 1.0
        turn = frequency * np.arange(round(6.0 * cycles / frequency * rate) + 2) / rate
        ring = np.cos(2.0 * np.pi * turn) * np.exp(-turn / cycles)
        return (
            np.asarray(lfilter(ring, [1.0], impacts))
            if ring.size < 64
            else _convolved(impacts, ring)
        )

    return _noisy("clicks", a, rng, time_series)


def _convolved(x: Array, taps: Array) -> Array:
    n = x.size + taps.size
    return np.asarray(np.fft.irfft(np.fft.rfft(x, n) * np.fft.rfft(taps, n), n)[: x.size])


def _band(a: float, rng: Rng) -> Effect:
    middle, octaves = log_uniform(rng, 60.0, 8000.0), log_uniform(rng, 0.1, 2.0)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        frequency = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 1.0)
        gain = np.exp(-0.5 * (np.log2(frequency / middle) / octaves) ** 2)
        return np.asarray(np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n))

    return _noisy("band", a, rng, time_series)


def _swelling(a: float, rng: Rng) -> Effect:
    corner, exponent = log_uniform(rng, 1.0, 30.0), float(rng.uniform(-0.5, 2.0))
    depth = float(rng.uniform(0.5, 1.5))

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        slow = wander(rng, n // 64 + 2, rate / 64.0, corner)
        swell = np.interp(np.arange(n), 64.0 * np.arange(slow.size), np.exp(depth * slow))
        return np.asarray(swell * _coloured(n, rate, rng, exponent))

    return _noisy("swelling", a, rng, time_series)


def _hums(
    form: str,
    a: float,
    rng: Rng,
    wave: Callable[[Array, float, Rng], Array],
    *,
    wobble: float = 0.0,
    depth: float = 0.0,
) -> Effect:
    """Add a wave over the periods passed; frequency and level may wander."""
    frequency = float(rng.choice([50.0, 60.0])) * (1.0 + 2e-3 * float(rng.standard_normal()))
    corner = log_uniform(rng, 1.0, 15.0)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        time = np.arange(n) / rate
        phases = rng.random(3)
        turns = (
            frequency * time + phases[0] + wobble * np.sin(2 * np.pi * (corner * time + phases[1]))
        )
        level = 1.0 + depth * np.sin(2 * np.pi * (0.7 * corner * time + phases[2]))
        return np.asarray(level * wave(turns, rate, rng))

    return _adds("mains_hum", form, a, rng, (0.3, 6.0, 0.25), time_series)


def _partials(rng: Rng) -> Callable[[Array, float, Rng], Array]:
    """Draw a wave of few harmonics."""
    orders = np.unique(rng.integers(1, 12, int(rng.integers(1, 7))))
    sizes = rng.exponential(1.0, orders.size) / np.sqrt(orders)
    phases = rng.random(orders.size)

    def wave(turns: Array, _rate: float, _rng: Rng) -> Array:
        parts = zip(orders.tolist(), sizes.tolist(), phases.tolist(), strict=True)
        return np.asarray(sum(c * np.sin(2 * np.pi * (k * turns + p)) for k, c, p in parts))

    return wave


def _hum_modulated(a: float, rng: Rng) -> Effect:
    return _hums("modulated", a, rng, _partials(rng), depth=float(rng.uniform(0.4, 1.2)))


def _hum_wobbling(a: float, rng: Rng) -> Effect:
    return _hums("wobbling", a, rng, _partials(rng), wobble=float(rng.uniform(0.05, 0.4)))


def _hum_drawn(a: float, rng: Rng) -> Effect:
    return _hums("drawn_harmonics", a, rng, _partials(rng))


def _hum_cut(a: float, rng: Rng) -> Effect:
    """Cut the phase: the sine begins late in each half-wave."""
    late = float(rng.uniform(0.1, 0.9))
    return _hums(
        "phase_cut", a, rng,
        lambda turns, _rate, _rng: np.where((2 * turns) % 1.0 > late, np.sin(2 * np.pi * turns), 0),
    )  # fmt: skip


def _hum_broken(a: float, rng: Rng) -> Effect:
    often, wave = log_uniform(rng, 3.0, 25.0), _partials(rng)

    def broken(turns: Array, rate: float, rng: Rng) -> Array:
        return wave(turns, rate, rng) * (0.05 + (telegraph(rng, turns.size, rate, often) > 0.0))

    return _hums("intermittent", a, rng, broken)


NOISE: tuple[Recipe, ...] = (_bursts, _clicks, _band, _swelling)
HUM: tuple[Recipe, ...] = (_hum_modulated, _hum_wobbling, _hum_drawn, _hum_cut, _hum_broken)
