"""Further forms of random noise on the channels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import butter, lfilter

from noise.diagnosis.cases.variants.common import (
    SENSED,
    Array,
    Recipe,
    Rng,
    log_uniform,
    log_uniforms,
    on_signals,
    telegraph,
    wander,
)  # fmt: skip
from sim.effects.effect import Effect, Signals

TimeSeries = Callable[[int, float, Rng], Array]

_LEVELS = (0.4, 25.0, 1.0)
"""Of torque, acceleration and pressure at strength 1, at most [Nm], [m/s2], [Pa]."""


def adds(
    name: str, form: str, a: float, rng: Rng, levels: tuple[float, float, float],
    time_series: TimeSeries, *, together: bool = False, uneven: float = 0.0,
) -> Effect:  # fmt: skip
    """Add a time series of rms 1 times a level to all channels, or to one or two of them.

    The same to all of them where they are disturbed together; louder in some runs than in others by
    so much (logarithmic).
    """
    sizes = np.array(levels) * np.exp(rng.uniform(np.log(0.1), 0.0, 3))
    if rng.random() < 0.4:
        sizes[rng.choice(3, int(rng.integers(1, 3)), replace=False)] = 0.0
    shares = {k: s for k, s in zip(SENSED, (a * sizes).tolist(), strict=True) if s > 0.0}

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        louder = float(np.exp(uneven * np.clip(rng.standard_normal(), -2.0, 2.0)))
        added: Array | None = None
        changed = dict(signals)
        for channel in (c for c in SENSED if c in shares and c in signals):
            if added is None or not together:
                added = time_series(signals[channel].size, rate, rng)
                added = added / (float(np.sqrt(np.mean(added**2))) + 1e-30)
            changed[channel] = signals[channel] + louder * shares[channel] * added
        return changed

    return on_signals(name, form, a, change)


def _noisy(
    form: str, a: float, rng: Rng, time_series: TimeSeries, *, together: bool = False,
    uneven: float = 0.0,
) -> Effect:  # fmt: skip
    return adds(
        "background_noise", form, a, rng, _LEVELS, time_series, together=together, uneven=uneven
    )


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


def _colour(a: float, rng: Rng) -> Effect:
    """Fall by any power of frequency, from white beyond brown."""
    exponent = float(rng.uniform(-1.0, 3.0))
    return _noisy("colour", a, rng, lambda n, rate, rng: _coloured(n, rate, rng, exponent))


def _together(a: float, rng: Rng) -> Effect:
    """Come from one source into all channels."""
    exponent = float(rng.uniform(0.0, 2.0))
    return _noisy("together", a, rng, lambda n, rate, rng: _coloured(n, rate, rng, exponent),
                  together=True)  # fmt: skip


def _some_runs(a: float, rng: Rng) -> Effect:
    """Be louder in some recordings than in others: a door, a compressor that starts."""
    exponent, uneven = float(rng.uniform(0.0, 2.0)), float(rng.uniform(0.5, 1.5))
    return _noisy("some_runs", a, rng, lambda n, rate, rng: _coloured(n, rate, rng, exponent),
                  uneven=uneven)  # fmt: skip


def _machine(a: float, rng: Rng) -> Effect:
    """Hum, whine and rush as a fan or a pump does: orders of a speed over coloured noise."""
    turning, blades = log_uniform(rng, 8.0, 100.0), int(rng.integers(3, 14))
    exponent, tonal = float(rng.uniform(0.5, 2.0)), log_uniform(rng, 0.5, 8.0)
    orders = np.array([1, 2, blades, 2 * blades, 3 * blades])
    sizes = rng.exponential(1.0, orders.size)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        turn = turning * (1.0 + 0.01 * rng.standard_normal()) * np.arange(n) / rate
        rush = _coloured(n, rate, rng, exponent)
        tones = sum(
            s * np.sin(2.0 * np.pi * (k * turn + rng.random()))
            for k, s in zip(orders.tolist(), sizes.tolist(), strict=True)
        )
        return np.asarray(rush / rush.std() + tonal / np.sqrt(orders.size) * tones)

    return _noisy("machine", a, rng, time_series)


def _popcorn(a: float, rng: Rng) -> Effect:
    """Jump between two levels by chance, as poor contacts and old transistors do."""
    often = log_uniform(rng, 5.0, 500.0)
    return _noisy("popcorn", a, rng, lambda n, rate, rng: telegraph(rng, n, rate, often))


def _spoken(a: float, rng: Rng) -> Effect:
    """Swell in syllables and sound in a few bands, as speech in the room does."""
    bands, pace = log_uniforms(rng, 200.0, 3500.0, 3), log_uniform(rng, 2.0, 8.0)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        frequency = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 1.0)
        gain = np.exp(-0.5 * (np.log2(frequency[:, None] / bands) / 0.25) ** 2).sum(axis=1)
        voice = np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n)
        syllables = np.sin(np.pi * (pace * np.arange(n) / rate + rng.random())) ** 2
        return np.asarray((0.05 + syllables) * voice)

    return _noisy("speech", a, rng, time_series)


def _following(a: float, rng: Rng) -> Effect:
    """Rise with the signal itself: rough contact of a slip ring, a noise of modulation."""
    levels, exponent = rng.uniform(0.1, 1.0, 3), float(rng.uniform(0.0, 1.0))
    shares = dict(zip(SENSED, (0.7 * a * levels).tolist(), strict=True))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        return {
            channel: x + shares[channel] * np.abs(x - x.mean()) * (
                (z := _coloured(x.size, rate, rng, exponent)) / z.std())
            if channel in shares else x
            for channel, x in signals.items()
        }  # fmt: skip

    return on_signals("background_noise", "following", a, change)


# Colours: Voss and Clarke 1978; popcorn: Hsu et al. 1970; bursts and clicks: Middleton 1977; the
# others are what laboratories hear.
NOISE: tuple[Recipe, ...] = (
    _bursts, _clicks, _band, _swelling, _colour, _together, _some_runs, _machine, _popcorn, _spoken,
    _following,
)  # fmt: skip
