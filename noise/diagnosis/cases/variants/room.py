"""Further forms of sound that reaches the microphone by way of the room."""

from __future__ import annotations

from collections.abc import Callable
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
from noise.diagnosis.cases.variants.paths import rings, waveguide
from sim.chain import filter_pressure, padded_sum
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses


def _reflected(form: str, a: float, taps: Callable[[float, Rng], Array]) -> Effect:
    """Add to the direct sound what ``taps(rate, rng)`` makes of it."""

    def change(paths: ImpulseResponses, rng: Rng) -> ImpulseResponses:
        return filter_pressure(paths, padded_sum([np.ones(1), a * taps(paths.rate, rng)]))

    return on_chain("room_reflections", form, a, change)


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
        flutter = _spaced(orders * way, 3.0 * wall**orders / np.sqrt(orders), rate)
        few = np.arange(1.0, 4.0)
        return padded_sum([flutter, _spaced(few * apart, 3.0 * side**few, rate)])

    return _reflected("corridor", a, taps)


def _few_echoes(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 10))
    times = log_uniforms(rng, 1.0e-3, 0.08, n)
    gains = 5.0 * rng.choice([-1.0, 1.0], n, p=[0.25, 0.75]) * rng.uniform(0.2, 1.0, n) / np.sqrt(n)
    return _reflected("few", a, lambda rate, _rng: _spaced(times, gains, rate))


def _one_echo(a: float, rng: Rng) -> Effect:
    """Reflect once, from a wall, a bench or the floor: a comb."""
    time, gain = log_uniform(rng, 4e-4, 0.05), float(rng.choice([-1.0, 1.0, 1.0]))
    size = float(rng.uniform(0.8, 2.5))
    corner = log_uniform(rng, 2000.0, 20e3)

    def taps(rate: float, _rng: Rng) -> Array:
        b, c = butter(1, min(2.0 * corner / rate, 0.95))
        echo = np.append(_spaced(np.array([time]), np.array([gain * size]), rate), np.zeros(256))
        return np.asarray(lfilter(b, c, echo))

    return _reflected("one", a, taps)


def _flutter(a: float, rng: Rng) -> Effect:
    """Go to and fro between two hard walls, duller each time."""
    first, dullness = log_uniform(rng, 12.0, 150.0), float(rng.uniform(0.05, 0.5))
    reflection, size = float(rng.uniform(0.6, 0.96)), log_uniform(rng, 0.7, 3.0)
    return _reflected(
        "flutter", a,
        lambda rate, _rng: size / reflection * waveguide(rate, first, reflection, dullness),
    )  # fmt: skip


def _standing(a: float, rng: Rng) -> Effect:
    """Stand in the room at its lowest modes (Morse and Bolt 1944)."""
    n = int(rng.integers(3, 9))
    frequencies = log_uniform(rng, 25.0, 80.0) * (1.0 + np.cumsum(rng.exponential(0.4, n)))
    damping = log_uniform(rng, 0.006, 0.05)
    sizes = 8.0 * rng.choice([-1.0, 1.0], n) * rng.uniform(0.3, 1.0, n)
    modes = [(f, damping, s) for f, s in zip(frequencies.tolist(), sizes.tolist(), strict=True)]
    delay = float(rng.uniform(2e-3, 1e-2))

    def taps(rate: float, _rng: Rng) -> Array:
        return np.concatenate([np.zeros(round(delay * rate)), rings(rate, modes)])

    return _reflected("standing", a, taps)


def _decay(rate: float, rng: Rng, lasting: float, start: float) -> Array:
    """Tail of unit energy that decays by 60 dB in its time [s]."""
    n = round(lasting * rate)
    tail = rng.standard_normal(n) * np.exp(-6.9 * np.arange(n) / n)
    return np.concatenate([np.zeros(max(1, round(start * rate))), tail / np.sqrt((tail**2).sum())])


def _coupled(a: float, rng: Rng) -> Effect:
    """Decay twice: a room beside the room, or a booth with its door open (Eyring 1931)."""
    fast, slow = log_uniform(rng, 0.05, 0.25), log_uniform(rng, 0.4, 1.5)
    starts, share = rng.uniform(2e-3, 1.5e-2, 2), float(rng.uniform(0.2, 0.8))
    size = float(rng.uniform(1.0, 6.0))

    def taps(rate: float, rng: Rng) -> Array:
        near, far = _decay(rate, rng, fast, starts[0]), _decay(rate, rng, slow, starts.sum())
        return size * padded_sum([(1.0 - share) * near, share * far])

    return _reflected("coupled", a, taps)


def _dull(a: float, rng: Rng) -> Effect:
    """Add a tail of which the high frequencies, or the low ones, are absorbed."""
    lasting, start = log_uniform(rng, 0.1, 1.2), float(rng.uniform(2e-3, 1.5e-2))
    corner, kind = log_uniform(rng, 600.0, 4000.0), str(rng.choice(["lowpass", "highpass"]))
    size = float(rng.uniform(1.0, 6.0))

    def taps(rate: float, rng: Rng) -> Array:
        b, c = butter(1, 2.0 * corner / rate, kind)
        return size * np.asarray(lfilter(b, c, _decay(rate, rng, lasting, start)))

    return _reflected("coloured", a, taps)


def _booth(a: float, rng: Rng) -> Effect:
    """Add the dense, short tail of a booth or a hood about the rig."""
    lasting, start = log_uniform(rng, 0.02, 0.12), float(rng.uniform(5e-4, 5e-3))
    size = float(rng.uniform(1.0, 6.0))
    return _reflected("booth", a, lambda rate, rng: size * _decay(rate, rng, lasting, start))


def _early_and_late(a: float, rng: Rng) -> Effect:
    """Reflect by single walls first, and as a tail after (Moorer 1979)."""
    n, lasting = int(rng.integers(3, 15)), log_uniform(rng, 0.15, 1.5)
    times = log_uniforms(rng, 1e-3, 0.04, n)
    gains = rng.uniform(0.2, 1.0, n) * np.exp(-times / 0.03)
    late, size = float(rng.uniform(0.2, 1.5)), float(rng.uniform(0.6, 2.5))

    def taps(rate: float, rng: Rng) -> Array:
        return size * padded_sum(
            [_spaced(times, gains, rate), late * _decay(rate, rng, lasting, 0.02)]
        )

    return _reflected("early_and_late", a, taps)


ROOM: tuple[Recipe, ...] = (
    _corridor, _few_echoes, _one_echo, _flutter, _standing, _coupled, _dull, _booth,
    _early_and_late,
)  # fmt: skip
