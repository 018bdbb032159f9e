"""Further forms of channels whose sensitivity is not what it is taken for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import butter, lfilter, lfilter_zi

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    draw_shares,
    log_uniform,
    log_uniforms,
    on_sensors,
    slowly,
    telegraph,
)  # fmt: skip
from sim.effects.effect import Effect

TimeSeries = Callable[[int, float, Rng], Array]

_DECIBELS = 20.0
"""Of a gain's error at strength 1."""

_LEAST = 0.02
"""Of the gain that is left."""


def _factor(rng: Rng, a: float) -> float:
    """Draw a factor of the gain at a strength, up or down by as many decibels."""
    return float(10.0 ** (rng.choice([-1.0, 1.0]) * _DECIBELS * a / 20.0))


def _gains(form: str, a: float, rng: Rng, time_series: TimeSeries) -> Effect:
    error = _factor(rng, 0.7 * a) - 1.0

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        return np.asarray(
            x * np.maximum(1.0 + error * share * time_series(x.size, rate, rng), _LEAST)
        )

    return on_sensors("gain_error", form, a, draw_shares(rng), change)


def _decibels(a: float, rng: Rng) -> Effect:
    """Read with a wrong factor, the same in all recordings: another sensor, another range."""
    factor = _factor(rng, a)
    return on_sensors("gain_error", "decibels", a, draw_shares(rng),
                      lambda x, share, _rate, _rng: np.asarray(factor**share * x))  # fmt: skip


def _mixed(a: float, rng: Rng) -> Effect:
    """Read each channel with a factor of its own, one too high and another too low."""
    level = np.log(_factor(rng, a))

    def change(x: Array, share: float, _rate: float, _rng: Rng) -> Array:
        return np.asarray(np.exp(level * share) * x)

    return on_sensors("gain_error", "mixed", a, draw_shares(rng, signed=True), change)


def _each_run(a: float, rng: Rng) -> Effect:
    """Read with another factor in each recording: a switch of ranges, a microphone moved."""
    spread = 0.6 * _DECIBELS / 20.0 * np.log(10.0) * a

    def change(x: Array, share: float, _rate: float, rng: Rng) -> Array:
        return np.asarray(x * np.exp(spread * share * np.clip(rng.standard_normal(), -2.0, 2.0)))

    return on_sensors("gain_error", "each_run", a, draw_shares(rng), change)


def _wandering(a: float, rng: Rng) -> Effect:
    corner, mean = log_uniform(rng, 0.5, 15.0), float(rng.uniform(0.0, 1.0))
    return _gains(
        "wandering", a, rng, lambda n, rate, rng: mean + 0.7 * slowly(rng, n, rate, corner)
    )


def _switching(a: float, rng: Rng) -> Effect:
    """Lose and find a contact, or switch between two ranges."""
    often = log_uniform(rng, 3.0, 40.0)
    return _gains(
        "switching", a, rng, lambda n, rate, rng: 0.5 + 0.5 * telegraph(rng, n, rate, often)
    )


def _stepping(a: float, rng: Rng) -> Effect:
    """Change once, somewhere in the recording."""
    later = bool(rng.integers(2))

    def time_series(n: int, _rate: float, rng: Rng) -> Array:
        return np.where((np.arange(n) >= int(n * rng.uniform(0.1, 0.9))) == later, 1.0, 0.0)

    return _gains("stepping", a, rng, time_series)


def _settling(a: float, rng: Rng) -> Effect:
    time, sign = log_uniform(rng, 0.02, 0.5), bool(rng.integers(2))

    def time_series(n: int, rate: float, _rng: Rng) -> Array:
        gone = np.exp(-np.arange(n) / (time * rate))
        return np.asarray(gone if sign else 1.0 - gone)

    return _gains("settling", a, rng, time_series)


def _tilted(a: float, rng: Rng) -> Effect:
    """Let the error grow or fall with frequency, by no simple filter."""
    error = _factor(rng, 0.8 * a) - 1.0
    corner, steep = log_uniform(rng, 100.0, 5000.0), float(rng.uniform(0.3, 3.0))
    way = float(rng.choice([-1.0, 1.0]))

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        ratio = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0) / corner
        wrong = 1.0 / (1.0 + ratio ** (way * steep))
        mirrored = np.fft.rfft(x - x.mean()) * wrong
        return np.asarray(x + share * error * np.fft.irfft(mirrored, x.size))

    return on_sensors("gain_error", "tilted", a, draw_shares(rng), change)


def _equalised(a: float, rng: Rng) -> Effect:
    """Let the gain go up and down over frequency, as a poor response correction does."""
    n = int(rng.integers(2, 6))
    places, wide = log_uniforms(rng, 60.0, 9000.0, n), rng.uniform(0.2, 1.2, n)
    levels = 0.8 * _DECIBELS / 20.0 * np.log(10.0) * a * rng.uniform(-1.0, 1.0, n)
    levels[0] = abs(levels).max()

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        frequency = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0)
        octaves = np.log2(frequency[:, None] / places) / wide
        gain = np.exp(share * (levels * np.exp(-0.5 * octaves**2)).sum(axis=1))
        mean = x.mean()
        return np.asarray(mean + np.fft.irfft(gain * np.fft.rfft(x - mean), x.size))

    return on_sensors("gain_error", "equalised", a, draw_shares(rng), change)


def _filter(form: str, kind: str, corners: tuple[float, float]) -> Recipe:
    """Blend in what a filter of first or second order leaves."""

    def recipe(a: float, rng: Rng) -> Effect:
        corner, order = log_uniform(rng, *corners), int(rng.integers(1, 3))

        def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
            b, c = butter(order, min(2.0 * corner / rate, 0.9), kind)
            passed, _ = lfilter(b, c, x, zi=lfilter_zi(b, c) * x[0])
            return np.asarray(x + a * share * (passed - x))

        return on_sensors("gain_error", form, a, draw_shares(rng), change)

    return recipe


def _bent(form: str, power: float, *, swings: bool) -> Recipe:
    """Let the gain depend on the reading, or on its swing about the mean."""

    def recipe(a: float, rng: Rng) -> Effect:
        error = float(rng.choice([-0.6, 1.5])) * a

        def change(x: Array, share: float, _rate: float, _rng: Rng) -> Array:
            centre = float(x.mean()) if swings else 0.0
            y = x - centre
            peak = float(np.abs(y).max()) or 1.0
            return np.asarray(centre + y * (1.0 + error * share * (np.abs(y) / peak) ** power))

        return on_sensors("gain_error", form, a, draw_shares(rng), change)

    return recipe


def _one_sided(a: float, rng: Rng) -> Effect:
    """Read what is above the mean with another gain than what is below."""
    factor, above = _factor(rng, 0.7 * a), bool(rng.integers(2))

    def change(x: Array, share: float, _rate: float, _rng: Rng) -> Array:
        y = x - x.mean()
        return np.asarray(x + (factor**share - 1.0) * y * ((y > 0.0) == above))

    return on_sensors("gain_error", "one_sided", a, draw_shares(rng), change)


# Calibration errors as ISO 16063-21 and IEC 61672 list them: factor, linearity, frequency response,
# stability; the others are what workshops see of ranges, plugs and couplings.
GAIN: tuple[Recipe, ...] = (
    _decibels, _mixed, _each_run, _wandering, _switching, _stepping, _settling, _tilted, _equalised,
    _filter("rolling_off", "lowpass", (150.0, 6000.0)),
    _filter("alternating_current", "highpass", (0.5, 400.0)),
    _bent("bent", 1.0, swings=False), _bent("bent_swings", 1.0, swings=True),
    _bent("bent_late", 3.0, swings=True), _one_sided,
)  # fmt: skip
