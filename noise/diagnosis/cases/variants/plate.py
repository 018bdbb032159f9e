"""Further forms of what radiates: modes, waves, and modes that lie elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import butter, lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    log_uniform,
    log_uniforms,
    on_chain,
)  # fmt: skip
from noise.diagnosis.cases.variants.paths import (
    band_level,
    damped,
    on_pressure,
    rings,
    shifted,
    split,
    waveguide,
)
from sim.chain import filter_pressure, padded_sum
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses


_HIGHEST_PEAK = 8.0
"""Of a resonance over the direct sound at strength 1: 19 dB [-]."""


def _rung(form: str, a: float, taps: Callable[[float, Rng], Array]) -> Effect:
    """Add to the direct sound what ``taps(rate, rng)`` makes of it."""

    def change(paths: ImpulseResponses, rng: Rng) -> ImpulseResponses:
        return filter_pressure(paths, padded_sum([np.ones(1), a * taps(paths.rate, rng)]))

    return on_chain("plate_modes", form, a, change)


def _some(
    form: str, band: tuple[float, float], dampings: tuple[float, float], count: tuple[int, int],
    most: float = _HIGHEST_PEAK,
) -> Recipe:  # fmt: skip
    def recipe(a: float, rng: Rng) -> Effect:
        n = int(rng.integers(*count))
        sizes = most * rng.choice([-1.0, 1.0], n) * rng.uniform(0.3, 1.0, n)
        columns = (log_uniforms(rng, *band, n), log_uniforms(rng, *dampings, n), sizes)
        modes = list(zip(*(column.tolist() for column in columns), strict=True))
        return _rung(form, a, lambda rate, _rng: rings(rate, modes))

    return recipe


def _crowding(a: float, rng: Rng) -> Effect:
    """Add modes that lie closer or wider with frequency, as of stiffened plates and shells."""
    first, power = log_uniform(rng, 100.0, 1200.0), float(rng.uniform(0.5, 2.0))
    n, damping = int(rng.integers(8, 20)), log_uniform(rng, 0.004, 0.06)
    strengths = rng.standard_normal(n).tolist()
    modes = [(first * (i + 1) ** power, damping, 4.0 * s) for i, s in enumerate(strengths)]
    return _rung("crowding", a, lambda rate, _rng: rings(rate, modes))


def _plate_waveguide(a: float, rng: Rng) -> Effect:
    first, dullness = log_uniform(rng, 150.0, 2500.0), float(rng.uniform(0.05, 0.5))
    reflection = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.6, 0.97))
    size = 5.0 * (1.0 - abs(reflection)) / abs(reflection)
    return _rung(
        "waveguide", a,
        lambda rate, _rng: size * waveguide(rate, first, reflection, dullness),
    )  # fmt: skip


def _notched(a: float, rng: Rng) -> Effect:
    """Swallow bands: absorbers, or paths that cancel."""
    n = int(rng.integers(1, 6))
    frequencies = log_uniforms(rng, 150.0, 8000.0, n).tolist()
    damping = log_uniform(rng, 0.02, 0.3)
    modes = [(f, damping, -1.0) for f in frequencies]
    return _rung("notches", a, lambda rate, _rng: rings(rate, modes))


def _diffuse(a: float, rng: Rng) -> Effect:
    """Ring along as a whole field of modes that overlap (Schroeder 1954)."""
    lasting, size = log_uniform(rng, 3e-3, 0.05), log_uniform(rng, 1.0, 5.0)

    def taps(rate: float, rng: Rng) -> Array:
        n = round(lasting * rate)
        tail = rng.standard_normal(n) * np.exp(-6.9 * np.arange(n) / n)
        return np.asarray(size * tail / np.sqrt((tail**2).sum()))

    return _rung("diffuse", a, taps)


def _beside(a: float, rng: Rng) -> Effect:
    """Radiate by a part of its own that torque and pulses shake directly: a guard, a cover."""
    n = int(rng.integers(1, 6))
    columns = (log_uniforms(rng, 100.0, 8000.0, n), log_uniforms(rng, 0.004, 0.1, n),
               6.0 * rng.standard_normal(n))  # fmt: skip
    modes = list(zip(*(column.tolist() for column in columns), strict=True))

    def change(paths: ImpulseResponses, _rng: Rng) -> ImpulseResponses:
        own = a * rings(paths.rate, modes)
        of_torque = band_level(paths.torque_to_pressure, paths.rate)
        of_pulse = band_level(paths.pulse_to_pressure, paths.rate)
        return replace(
            paths,
            torque_to_pressure=padded_sum([paths.torque_to_pressure, of_torque * own]),
            pulse_to_pressure=padded_sum([paths.pulse_to_pressure, of_pulse * own]),
        )

    return on_chain("plate_modes", "beside", a, change)


def _on_both(form: str, a: float, change: Callable[[Array, float], Array]) -> Effect:
    return on_chain(
        "plate_modes", form, a,
        lambda paths, _rng: on_pressure(paths, lambda h: change(h, paths.rate)),
    )  # fmt: skip


def _elsewhere(a: float, rng: Rng) -> Effect:
    """Have all modes higher or lower than they were measured: another thickness, warmer, bolted."""
    octaves = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.5)) * a
    return _on_both("shifted", a, lambda h, _rate: shifted(h, 2.0**octaves))


def _damped(a: float, rng: Rng) -> Effect:
    """Damp all modes more: a mat on the plate."""
    decay = a * log_uniform(rng, 60.0, 2000.0)
    return _on_both("damped", a, lambda h, rate: damped(h, rate, decay))


def _all_split(a: float, rng: Rng) -> Effect:
    apart = a * log_uniform(rng, 30.0, 500.0)
    return _on_both("all_split", a, lambda h, rate: split(h, rate, apart))


def _louder_band(a: float, rng: Rng) -> Effect:
    """Radiate better above a coincidence, or below a cut (Maidanik 1962)."""
    corner, kind = log_uniform(rng, 300.0, 5000.0), str(rng.choice(["lowpass", "highpass"]))
    order, gain = int(rng.integers(1, 4)), float(rng.choice([-0.9, 2.0, 4.0]))

    def change(h: Array, rate: float) -> Array:
        b, c = butter(order, 2.0 * corner / rate, kind)
        return np.asarray(h + a * gain * lfilter(b, c, h))

    return _on_both("louder_band", a, change)


# Cremer and Heckl (plates), Leissa 1969 (stiffened), Fahy and Gardonio 2007 (covers beside).
PLATE: tuple[Recipe, ...] = (
    _some("several", (120.0, 9000.0), (0.004, 0.1), (2, 9)),
    _some("one_low", (50.0, 400.0), (0.005, 0.15), (1, 2)),
    _some("one_sharp", (200.0, 9000.0), (0.0015, 0.01), (1, 3), 16.0),
    _some("broad", (150.0, 8000.0), (0.1, 0.5), (1, 4), 5.0),
    _crowding, _plate_waveguide, _notched, _diffuse, _beside, _elsewhere, _damped, _all_split,
    _louder_band,
)  # fmt: skip
