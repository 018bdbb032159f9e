"""Parts of the unknown effects: constructors, and random signals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from noise.training.causes.cases.unknown_effects.hooks import table_hook
from sim.effects.effect import Effect, Signals, Stage
from sim.parameters import Parameter

Array = NDArray[np.float64]
Rng = np.random.Generator
Recipe = Callable[[float, float, float, Rng], Effect]
"""Of strength, kinetic torque [Nm], stiffness [Nm/rad] and a generator."""

SENSED = ("torque", "acceleration", "pressure")

STRENGTH = {"strength": Parameter(1.0, "", 0.0, 1.0, "nothing at 0")}


def unknown(stage: Stage, **acting: object) -> Effect:
    """Make an unknown effect."""
    return Effect("unknown_effect", stage, ("plain",), STRENGTH, "strength", **acting)  # type: ignore[arg-type]


def on_contact(pack: Callable[[Rng], Array]) -> Effect:
    """Make one that acts on the contact, by the numbers of its hook."""
    return unknown(
        Stage.FRICTION, contact=table_hook, pack=lambda _form, _values, rng: pack(rng), n_states=2
    )


def on_sensors(a: float, change: Callable[[Signals, float, Rng], Signals]) -> Effect:
    """Make one that changes what the channels read: ``change(signals, rate, rng)``."""
    return unknown(
        Stage.MEASUREMENT,
        sensors=lambda signals, rate, _form, _values, rng: (
            change(signals, rate, rng) if a > 0.0 else signals
        ),
    )


def added(
    a: float, levels: tuple[float, float, float], series: Callable[[int, float, Rng], Array]
) -> Effect:
    """Make one that adds a series of rms 1 to torque, acceleration and pressure, at levels."""

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        read = dict(signals)
        x = series(signals["torque"].size, rate, rng)
        x = x / (float(np.sqrt(np.mean(x**2))) + 1e-30)
        for name, level in zip(SENSED, levels, strict=True):
            read[name] = signals[name] + a * level * x
        return read

    return on_sensors(a, change)


def table(what: float, over: float, scale: float, values: Array) -> Array:
    """Pack a table as the hook reads it."""
    return np.concatenate([[what, over, scale, values.size], values])


def noise(rng: Rng, n: int, rate: float, low: float, high: float) -> Array:
    """Draw noise of a band, of unit variance."""
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    spectrum = np.zeros(frequency.size, dtype=complex)
    count = int(inside.sum())
    spectrum[inside] = rng.standard_normal(count) + 1j * rng.standard_normal(count)
    return normed(np.fft.irfft(spectrum, n))


def normed(x: Array) -> Array:
    """Take away the mean of a signal, and divide it by its standard deviation."""
    return np.asarray((x - x.mean()) / (float(x.std()) + 1e-30))


def where(rng: Rng) -> tuple[str, ...]:
    """Draw one channel, or all of them."""
    one = int(rng.integers(4))
    return SENSED if one == 3 else (SENSED[one],)
