"""Parts of the variants: constructors of effects, and random curves and signals.

A monotone shape with random increments stands for the forms that nobody foresees: whoever has
learnt a hundred such shapes has learnt the effect rather than a formula of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.signal import butter, lfilter

from sim.effects import EFFECTS
from sim.effects.effect import Effect, Signals
from sim.parameters import Parameter

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses

Array = NDArray[np.float64]
Rng = np.random.Generator

Recipe = Callable[[float, Rng], Effect]
"""Of a strength from 0 to 1, and a generator."""

_N_CURVE = 129
SENSED = ("torque", "acceleration", "pressure")


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """Draw a number whose logarithm is uniform."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def log_uniforms(rng: Rng, low: float, high: float, n: int) -> Array:
    """Draw numbers whose logarithms are uniform."""
    return np.exp(rng.uniform(np.log(low), np.log(high), n))


def family(
    make: Callable[[str, float, Rng, Array], Effect],
    *shapes: tuple[str, Callable[[Rng], Array]],
) -> tuple[Recipe, ...]:
    """Make a recipe of each form and the shape that is drawn for it."""

    def recipe(form: str, shape: Callable[[Rng], Array]) -> Recipe:
        return lambda strength, rng: make(form, strength, rng, shape(rng))

    return tuple(recipe(form, shape) for form, shape in shapes)


def _variant(name: str, form: str, strength: float, **acting: Any) -> Effect:
    plain = EFFECTS[name]
    given = {"strength": Parameter(strength, "", 0.0, 1.0, "nothing at 0")}
    return Effect(name, plain.stage, (form,), given, "strength", **acting)


def on_contact(
    name: str,
    form: str,
    strength: float,
    hook: Any,
    numbers: Callable[[Rng], Array],
    n_states: int = 0,
) -> Effect:
    """Make an effect on the contact; a run's own generator draws the numbers of its hook."""
    return _variant(
        name, form, strength, contact=hook, pack=lambda _form, _values, rng: numbers(rng),
        n_states=n_states,
    )  # fmt: skip


def on_drive(
    name: str,
    form: str,
    strength: float,
    change: Callable[[Array, float, Rng], Array],
) -> Effect:
    """Make an effect on the speed, the relative change of which is `change`."""
    return _variant(
        name, form, strength,
        drive=lambda speed, rate, _form, _values, rng: speed * (1.0 + change(speed, rate, rng)),
    )  # fmt: skip


def on_joint(name: str, form: str, strength: float, force: Callable[[Any], Array]) -> Effect:
    """Make an effect that strikes the joint of the anchors."""
    return _variant(name, form, strength, force=lambda motion, _form, _values: force(motion))


def on_chain(
    name: str,
    form: str,
    strength: float,
    change: Callable[[ImpulseResponses, Rng], ImpulseResponses],
) -> Effect:
    """Make an effect on the way from torque to sound; neutral at strength 0."""

    def chain(response: ImpulseResponses, _form: str, _values: Any, rng: Rng) -> ImpulseResponses:
        return change(response, rng) if strength > 0.0 else response

    return _variant(name, form, strength, chain=chain)


def on_sensors(
    name: str,
    form: str,
    strength: float,
    shares: dict[str, float],
    change: Callable[[Array, float, float, Rng], Array],
) -> Effect:
    """Make an effect on channels; ``change(x, share, rate, rng)`` where the share is not 0."""

    def sensors(signals: Signals, rate: float, _form: str, _values: Any, rng: Rng) -> Signals:
        return {
            channel: change(x, shares.get(channel, 0.0), rate, rng)
            if strength > 0.0 and shares.get(channel, 0.0) != 0.0
            else x
            for channel, x in signals.items()
        }

    return _variant(name, form, strength, sensors=sensors)


def on_signals(
    name: str, form: str, strength: float, change: Callable[[Signals, float, Rng], Signals]
) -> Effect:
    """Make an effect that changes all signals at once: ``change(signals, rate, rng)``."""

    def sensors(signals: Signals, rate: float, _form: str, _values: Any, rng: Rng) -> Signals:
        return change(signals, rate, rng) if strength > 0.0 else signals

    return _variant(name, form, strength, sensors=sensors)


def draw_shares(
    rng: Rng, names: tuple[str, ...] = SENSED, *, signed: bool = False
) -> dict[str, float]:
    """Draw shares of a fault: mostly of one channel alone."""
    chosen = [str(rng.choice(names))]
    if rng.random() > 0.65:
        chosen = [name for name in names if rng.random() < 0.7] or chosen
    sizes = rng.uniform(0.5, 1.0, len(chosen)) if len(chosen) > 1 else np.ones(1)
    signs = rng.choice([-1.0, 1.0], len(chosen)) if signed else np.ones(len(chosen))
    return dict(zip(chosen, (sizes * signs).tolist(), strict=True))


def curve(shape: Callable[[Array], Array]) -> Array:
    """Tabulate a shape over 0 to 1 as hooks read it."""
    return np.concatenate([[_N_CURVE], shape(np.linspace(0.0, 1.0, _N_CURVE))])


def far_curve(shape: Callable[[Array], Array]) -> Array:
    """Tabulate a shape over x from 0 to infinity, in equal steps of x / (1 + x)."""
    return curve(lambda u: shape(u / np.maximum(1.0 - u, 1e-6)))


def hill(power: float) -> Array:
    """Tabulate a rise from 0 to 1 that begins late."""
    return far_curve(lambda x: 1.0 / (1.0 + (1.0 / (x + 1e-9)) ** power))


def overshoot(left: float) -> Array:
    """Tabulate a rise to a peak, and a fall to what is left of it."""
    return far_curve(lambda x: (1 - left) * x * np.exp(1 - np.minimum(x, 99)) - left * np.expm1(-x))


def drawn_curve(rng: Rng) -> Array:
    """Draw a monotone shape from 0 to 1, with few steep parts or many even ones."""
    n, evenness = int(rng.integers(4, 9)), log_uniform(rng, 0.6, 4.0)
    steps = np.cumsum(rng.dirichlet(np.full(n, evenness)))
    knots = np.linspace(0.0, 1.0, n + 1)
    return curve(PchipInterpolator(knots, np.concatenate([[0.0], steps])))


def noise(rng: Rng, n: int, rate: float, low: float, high: float) -> Array:
    """Draw periodic noise of a band, of unit variance."""
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    inside[1] |= not inside[1:].any()
    spectrum = inside * np.exp(2j * np.pi * rng.random(frequency.size))
    time_series = np.fft.irfft(spectrum, n)
    return np.asarray(time_series / time_series.std())


def wander(rng: Rng, n: int, rate: float, corner: float) -> Array:
    """Draw a slow random time series of about unit variance."""
    b, a = butter(2, min(2.0 * corner / rate, 0.9))
    settling = round(min(2.0 * rate / corner, 4.0 * n))
    time_series = lfilter(b, a, rng.standard_normal(n + settling))[settling:]
    return np.asarray(time_series * math.sqrt(0.5 * rate / (1.11 * corner)))


def slowly(rng: Rng, n: int, rate: float, corner: float) -> Array:
    """Draw as `wander` does, at the price of few samples where the corner lies far below `rate`."""
    coarse = max(1, int(rate / (20.0 * corner)))
    slow = wander(rng, n // coarse + 2, rate / coarse, corner)
    return np.interp(np.arange(n), coarse * np.arange(slow.size), slow)


def telegraph(rng: Rng, n: int, rate: float, often: float) -> Array:
    """Draw a time series that switches between -1 and 1, so often a second [Hz]."""
    return np.where(np.cumsum(rng.random(n) < often / rate) % 2 == int(rng.integers(2)), 1.0, -1.0)
