"""Further forms of what rings along with the plate, and of what the room adds."""

from __future__ import annotations

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
from noise.diagnosis.cases.variants.structure import waveguide
from sim.chain import HIGHEST_SHARE, filter_pressure, padded_sum, resonance

if TYPE_CHECKING:
    from collections.abc import Callable

    from models.radiation.impulse_responses import ImpulseResponses
    from sim.effects.effect import Effect

__all__ = ["PLATE", "ROOM"]


def _added(name: str, form: str, a: float, taps: Callable[[float, Rng], Array]) -> Effect:
    """Add to the direct sound what ``taps(rate, rng)`` makes of it."""

    def change(paths: ImpulseResponses, rng: Rng) -> ImpulseResponses:
        return filter_pressure(paths, padded_sum([np.ones(1), a * taps(paths.rate, rng)]))

    return on_chain(name, form, a, change)


def _rings(rate: float, modes: list[tuple[float, float, float]]) -> Array:
    """Resonances of unit peak: frequency [Hz], damping ratio, sense and strength."""
    return padded_sum(
        [np.zeros(1)]
        + [
            strength * resonance([0.0, 2.0 * damping, 0.0], frequency, damping, rate)
            for frequency, damping, strength in modes
            if frequency < HIGHEST_SHARE * rate
        ]
    )


def _several(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 7))
    frequencies = log_uniforms(rng, 150.0, 8000.0, n).tolist()
    dampings = log_uniforms(rng, 0.005, 0.1, n).tolist()
    strengths = (2.0 * rng.choice([-1.0, 1.0], n) * rng.uniform(0.3, 1.0, n)).tolist()
    modes = list(zip(frequencies, dampings, strengths, strict=True))
    return _added("plate_modes", "several", a, lambda rate, _rng: _rings(rate, modes))


def _crowding(a: float, rng: Rng) -> Effect:
    """Add modes that lie closer or wider with frequency, as of stiffened plates and shells."""
    first, power = log_uniform(rng, 150.0, 1200.0), float(rng.uniform(0.5, 2.0))
    n, damping = int(rng.integers(8, 20)), log_uniform(rng, 0.006, 0.06)
    strengths = rng.standard_normal(n).tolist()
    modes = [(first * (i + 1) ** power, damping, 1.5 * s) for i, s in enumerate(strengths)]
    return _added("plate_modes", "crowding", a, lambda rate, _rng: _rings(rate, modes))


def _plate_waveguide(a: float, rng: Rng) -> Effect:
    first, dullness = log_uniform(rng, 150.0, 2500.0), float(rng.uniform(0.05, 0.5))
    reflection = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.6, 0.97))
    size = 2.0 * (1.0 - abs(reflection)) / abs(reflection)
    return _added(
        "plate_modes", "waveguide", a,
        lambda rate, _rng: size * waveguide(rate, first, reflection, dullness),
    )  # fmt: skip


def _notched(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(1, 5))
    frequencies = log_uniforms(rng, 200.0, 6000.0, n).tolist()
    damping = log_uniform(rng, 0.02, 0.2)
    modes = [(f, damping, -1.0) for f in frequencies]
    return _added("plate_modes", "notches", a, lambda rate, _rng: _rings(rate, modes))


def _spaced(times: Array, gains: Array, rate: float) -> Array:
    """Echoes after so many seconds, each shared between two samples."""
    place = times * rate
    taps = np.zeros(int(place.max()) + 3)
    whole = place.astype(np.int64)
    np.add.at(taps, whole, gains * (1.0 - (place - whole)))
    np.add.at(taps, whole + 1, gains * (place - whole))
    return taps


def _corridor(a: float, rng: Rng) -> Effect:
    way, wall = float(rng.uniform(4e-3, 2.5e-2)), float(rng.uniform(0.6, 0.95))
    side, apart = float(rng.uniform(0.2, 0.8)), float(rng.uniform(2.0, 8.0)) * way
    orders = np.arange(1.0, 1.0 + int(np.log(1e-3) / np.log(wall)))

    def taps(rate: float, _rng: Rng) -> Array:
        flutter = _spaced(orders * way, 1.5 * wall**orders / np.sqrt(orders), rate)
        few = np.arange(1.0, 4.0)
        return padded_sum([flutter, _spaced(few * apart, 1.5 * side**few, rate)])

    return _added("room_reflections", "corridor", a, taps)


def _few_echoes(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 10))
    times = log_uniforms(rng, 1.5e-3, 0.08, n)
    gains = 3.0 * rng.choice([-1.0, 1.0], n, p=[0.25, 0.75]) * rng.uniform(0.2, 1.0, n) / np.sqrt(n)
    return _added("room_reflections", "few", a, lambda rate, _rng: _spaced(times, gains, rate))


def _decay(rate: float, rng: Rng, lasting: float, start: float) -> Array:
    """Tail of unit energy that decays by 60 dB in its time [s]."""
    n = round(lasting * rate)
    tail = rng.standard_normal(n) * np.exp(-6.9 * np.arange(n) / n)
    return np.concatenate([np.zeros(max(1, round(start * rate))), tail / np.sqrt((tail**2).sum())])


def _coupled(a: float, rng: Rng) -> Effect:
    fast, slow = log_uniform(rng, 0.05, 0.25), log_uniform(rng, 0.4, 1.5)
    starts, share = rng.uniform(2e-3, 1.5e-2, 2), float(rng.uniform(0.2, 0.8))
    size = float(rng.uniform(1.0, 4.0))

    def taps(rate: float, rng: Rng) -> Array:
        near, far = _decay(rate, rng, fast, starts[0]), _decay(rate, rng, slow, starts.sum())
        return size * padded_sum([(1.0 - share) * near, share * far])

    return _added("room_reflections", "coupled", a, taps)


def _dull(a: float, rng: Rng) -> Effect:
    """Add a tail of which the high frequencies, or the low ones, are absorbed."""
    lasting, start = log_uniform(rng, 0.1, 1.2), float(rng.uniform(2e-3, 1.5e-2))
    corner, kind = log_uniform(rng, 600.0, 4000.0), str(rng.choice(["lowpass", "highpass"]))
    size = float(rng.uniform(1.0, 4.0))

    def taps(rate: float, rng: Rng) -> Array:
        b, c = butter(1, 2.0 * corner / rate, kind)
        return size * np.asarray(lfilter(b, c, _decay(rate, rng, lasting, start)))

    return _added("room_reflections", "coloured", a, taps)


PLATE: tuple[Recipe, ...] = (_several, _crowding, _plate_waveguide, _notched)
ROOM: tuple[Recipe, ...] = (_corridor, _few_echoes, _coupled, _dull)
