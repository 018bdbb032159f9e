"""Random draws of the numbers, curves and signals in the tables of effect forms.

Monotone curves with random increments represent unforeseen forms: a model that is trained on a
hundred such curves learns the effect rather than one formula.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.signal import butter, lfilter

from models.rig import LawSpec
from noise.base import log_uniform, packaged_toml
from noise.base.arrays import Array
from sim.effects import EFFECTS

Rng = np.random.Generator

SENSED = ("torque", "acceleration", "pressure")
"""Kinds of channels with a sensor."""

_N_CURVE = 129
"""Number of points of a tabulated curve."""


def log_uniforms(rng: Rng, low: float, high: float, n: int) -> Array:
    """Draw `n` numbers from a log-uniform distribution between two bounds, shape (n,)."""
    return np.exp(rng.uniform(np.log(low), np.log(high), n))


def draw_numbers(specs: Mapping[str, Any], rng: Rng, strength: float = 1.0) -> dict[str, Any]:
    """Draw the parameters of a row of a table in order.

    Parameters
    ----------
    specs : mapping of str to object
        Specification of each parameter, in the format that the tables explain. It may refer to
        earlier parameters by name.
    rng : numpy.random.Generator
    strength : float
        Strength of the effect, for specifications that refer to it [-].

    Returns
    -------
    dict of str to object
        Drawn values by name.

    Examples
    --------
    >>> specs = {"n": 3, "sizes": {"even": [0.0, 1.0], "n": "n"}, "fixed": True}
    >>> drawn = draw_numbers(specs, np.random.default_rng(0))
    >>> drawn["sizes"].shape, drawn["fixed"]
    ((3,), True)
    """
    drawn: dict[str, Any] = {}
    for name, spec in specs.items():
        drawn[name] = _drawn(spec, rng, {"strength": strength, **drawn})
    return drawn


def _drawn(spec: Any, rng: Rng, names: Mapping[str, Any]) -> Any:
    """Draw a value from its specification; `names` are the values of earlier parameters."""

    def value(part: Any) -> Any:
        return _drawn(part, rng, names)

    if isinstance(spec, str):
        return names.get(spec, spec)
    if isinstance(spec, list):
        return float(rng.uniform(*map(value, spec)))
    if not isinstance(spec, dict):
        return spec
    kind, given = next(iter(spec.items()))
    if kind == "curve":
        numbers = {**names}
        for name, part in list(spec.items())[1:]:
            numbers[name] = _drawn(part, rng, numbers)
        return _tabulated(given, {name: numbers[name] for name in spec if name != "curve"}, rng)
    n = value(spec["n"]) if "n" in spec else None
    if kind == "log":
        low, high = given
        return log_uniform(low, high, rng) if n is None else log_uniforms(rng, low, high, n)
    if kind == "when":
        return value(spec["yes" if names[given] else "no"])
    if kind == "shares":
        mostly = spec.get("mostly")
        some = SENSED if mostly is None or rng.random() >= 0.7 else (mostly,)
        return _shares(rng, some, signed=given)
    if kind == "one":
        chosen: Any = rng.choice(given, n, p=spec.get("p"))
        return chosen if n is not None else chosen.item()
    simple: dict[str, Callable[[], Any]] = {
        "even": lambda: rng.uniform(value(given[0]), value(given[1]), n),
        "int": lambda: int(rng.integers(*given)),
        "chance": lambda: bool(rng.random() < given),
        "normal": lambda: rng.standard_normal(n),
        "exponential": lambda: rng.exponential(given, n),
        "dirichlet": lambda: rng.dirichlet(np.full(n, given)),
        "random": lambda: rng.random() if n is None else rng.random((n, given)),
        "of_strength": lambda: names["strength"] * value(given),
        "decibels": lambda: 20.0 * math.log10(given * float(rng.uniform(0.2, 1.0)) / 20e-6),
        "about": lambda: float(rng.choice(given)) * (1.0 + 2e-3 * float(rng.standard_normal())),
        "times": lambda: math.prod(map(value, given)),
        "geom": lambda: np.geomspace(*map(value, given)),
        "list": lambda: np.array(list(map(value, given))),
        "levels": lambda: _levels(rng, given),
        "beside": lambda: _levels_beside(rng, given),
        "mains": lambda: _mains(rng),
        "partials": lambda: _partials(rng, given),
        "doubled": lambda: _doubled(rng, given),
    }
    return simple[kind]()


def _shares(rng: Rng, names: tuple[str, ...], *, signed: bool) -> dict[str, float]:
    """Draw the shares of a fault in its channels; mostly a single channel has it."""
    chosen = [str(rng.choice(names))]
    if rng.random() > 0.65:
        chosen = [name for name in names if rng.random() < 0.7] or chosen
    sizes = rng.uniform(0.5, 1.0, len(chosen)) if len(chosen) > 1 else np.ones(1)
    signs = rng.choice([-1.0, 1.0], len(chosen)) if signed else np.ones(len(chosen))
    return dict(zip(chosen, (sizes * signs).tolist(), strict=True))


def _levels(rng: Rng, most: list[float]) -> Array:
    """Draw levels of the channels, shape (3,) [Nm], [m/s2], [Pa]; one or two are sometimes 0."""
    sizes = np.array(most) * np.exp(rng.uniform(np.log(0.1), 0.0, 3))
    if rng.random() < 0.4:
        sizes[rng.choice(3, int(rng.integers(1, 3)), replace=False)] = 0.0
    return np.asarray(sizes)


def _levels_beside(rng: Rng, most: list[float]) -> Array:
    """Draw channel levels of a sound source beside the rig, shape (3,) [Nm], [m/s2], [Pa].

    The level of the torque is 0 in half of the draws.
    """
    levels = np.array([level * log_uniform(0.1, 1.0, rng) for level in most])
    levels[0] *= rng.random() < 0.5
    return levels


def _mains(rng: Rng) -> float:
    """Draw a mains frequency, sometimes of railways or aircraft [Hz]."""
    usual = rng.random() < 0.9
    nominal = float(rng.choice((50.0, 60.0) if usual else (50.0 / 3.0, 25.0, 400.0)))
    return nominal * (1.0 + 2e-3 * rng.standard_normal())


def _partials(rng: Rng, orders_below: int) -> tuple[Any, Any, Any]:
    """Draw orders, amplitudes and phases of a wave with few harmonics."""
    orders = np.unique(rng.integers(1, orders_below, int(rng.integers(1, 7))))
    sizes = rng.exponential(1.0, orders.size) / np.sqrt(orders)
    return orders, sizes, rng.random(orders.size)


def _doubled(rng: Rng, orders_below: int) -> tuple[Any, Any, Any]:
    """Draw orders, amplitudes and phases of a wave with even harmonics."""
    even = 2 * np.arange(1, int(rng.integers(2, orders_below)))
    return even, even ** -log_uniform(0.3, 3.0, rng), rng.random(even.size)


def curve(shape: Callable[[Array], Array]) -> Array:
    """Tabulate a shape over 0 to 1 in the format of the solver's hooks, shape (n,)."""
    return np.concatenate([[_N_CURVE], shape(np.linspace(0.0, 1.0, _N_CURVE))])


def far_curve(shape: Callable[[Array], Array]) -> Array:
    """Tabulate a function of x from 0 to infinity, in equal steps of x / (1 + x), shape (n,)."""
    return curve(lambda u: shape(u / np.maximum(1.0 - u, 1e-6)))


def drawn_curve(rng: Rng) -> Array:
    """Draw a tabulated monotone curve from 0 to 1, with steep steps or even ones, shape (n,)."""
    n, evenness = int(rng.integers(4, 9)), log_uniform(0.6, 4.0, rng)
    steps = np.cumsum(rng.dirichlet(np.full(n, evenness)))
    knots = np.linspace(0.0, 1.0, n + 1)
    return curve(PchipInterpolator(knots, np.concatenate([[0.0], steps])))


def exponential(x: Array) -> Array:
    """Return 1 - exp(-x), with the shape of `x`."""
    return np.asarray(-np.expm1(-np.minimum(x, 99.0)))


def _softplus(x: Array, at: float, wide: float) -> Array:
    """Return a ramp from `at` on, rounded over the width `wide` and 0 at 0."""
    risen = wide * np.logaddexp(0.0, (np.minimum(x, 8.0) - at) / wide)
    return np.asarray(risen - wide * np.log1p(np.exp(-at / wide)))


def _flash(x: Array, soft: float) -> Array:
    """Return a curve that rises from 1 on and saturates at 1, as flash temperature does."""
    over = soft * np.logaddexp(0.0, (np.minimum(x, 99.0) - 1.0) / soft)
    return np.asarray(over / (1.0 + over))


def _cubic(x: Array, left: float) -> Array:
    """Return a cubic that rises to 1 at 1 and then falls to `left`."""
    y = np.minimum(x, 2.0)
    falls = 1.5 * y - 0.5 * y**3
    return np.where(y < 1.0, falls, np.maximum(falls, left))


def _patches(u: Array, n: int, edges: Array, soft: float) -> Array:
    """Return the sum of `n` intervals with soft edges, limited to 1 and 0 at the ends."""
    covered = np.zeros_like(u)
    for start, stop in np.sort(edges, axis=1)[:n]:
        covered += 0.5 * (np.tanh((u - start) / soft) - np.tanh((u - stop) / soft))
    ends = np.clip(np.minimum(u, 1.0 - u) / 0.03, 0.0, 1.0)
    return np.asarray(ends * np.clip(covered, 0.0, 1.0))


def _zones(r: Array, n: int, soft: float, at: Array, steps: Array) -> Array:
    """Return a sum of `n` soft steps."""
    pairs = zip(at[:n], steps, strict=True)
    return np.asarray(sum(s / (1.0 + np.exp((p - r) / soft)) for p, s in pairs))


def _precursors(r: Array, n: int, wide: float, at: Array, size: Array) -> Array:
    """Return a sum of `n` Gaussian bumps, limited to 1."""
    pairs = zip(at[:n], size, strict=True)
    bumps = sum(s * np.exp(-0.5 * ((r - p) / wide) ** 2) for p, s in pairs)
    return np.asarray(np.minimum(bumps, 1))


def _logarithm(x: Array, k: float, most: float, at: float, height: float = 1.0) -> Array:
    """Return a logarithm that is 0 at 0, `height` at `at`, and constant above `most`."""
    return np.asarray(np.log1p(k * np.minimum(x, most)) / math.log1p(k * at) * height)


_CURVES: dict[str, Callable[..., Any]] = {
    "ones": np.ones_like,
    "power": lambda r, n: r**n,
    "root": lambda r, n: (r + 1e-9) ** n,
    "threshold": lambda r, at, n: np.maximum((r - at) / (1.0 - at), 0.0) ** n,
    "late": lambda r, left: np.log1p(-(1.0 - left) * r) / np.log1p(-(1.0 - left)),
    "bristles": lambda r, k: r / (1.0 + k * (1.0 - r)),
    "annulus": lambda r, n: 1.0 - (1.0 - 0.999 * r) ** n,
    "activated": lambda r, wide: np.exp((r - 1.0) / wide) - np.exp(-1.0 / wide),
    "zones": _zones,
    "precursors": _precursors,
    "patches": _patches,
}
"""Functions over 0 to 1, by their names in the tables."""

_FAR_CURVES: dict[str, Callable[..., Any]] = {
    "exponential": exponential,
    "hill": lambda x, power: 1.0 / (1.0 + (1.0 / (x + 1e-9)) ** power),
    "overshoot": lambda x, left: (
        (1 - left) * x * np.exp(1 - np.minimum(x, 99)) - left * np.expm1(-x)
    ),
    "hyperbola": lambda x, p: 1.0 - (1.0 + x) ** -p,
    "delayed": lambda x, at, steep: -np.expm1(-steep * np.maximum(x - at, 0.0) ** 1.5),
    "stretched": lambda x, p, farthest=99.0: -np.expm1(-(np.minimum(x, farthest) ** p)),
    "logarithm": _logarithm,
    "far_root": lambda x, p: (np.minimum(x, 100.0) / 100.0) ** p,
    "far_power": lambda x, p: (np.minimum(x, 50.0) / 10.0) ** p,
    "raised_power": lambda x, p: (np.minimum(x, 20.0) + 0.01) ** p - 0.01**p,
    "far_threshold": lambda x, at: np.maximum(x - at, 0) ** 1.5 / (1.0 + x**1.5),
    "kraus": lambda x, m: x ** (2.0 * m) / (1.0 + x ** (2.0 * m)),
    "arctangent": lambda x: np.arctan(x) * 2.0 / np.pi,
    "linear": lambda x, most, over: np.minimum(x, most) / over,
    "lowest": lambda x, viscous: exponential(x) - viscous * np.minimum(x, 50.0),
    "softplus": _softplus,
    "flash": _flash,
    "cubic": _cubic,
}
"""Functions over 0 to infinity, by their names in the tables."""


def _tabulated(name: str, numbers: dict[str, Any], rng: Rng) -> Array:
    """Return the tabulated curve of a name with its parameters, shape (n,)."""
    if name == "drawn":
        return drawn_curve(rng)
    if name in _CURVES:
        return curve(lambda r: _CURVES[name](r, **numbers))
    return far_curve(lambda x: _FAR_CURVES[name](x, **numbers))


def noise(rng: Rng, n: int, rate: float, low: float, high: float) -> Array:
    """Draw periodic noise of unit variance between `low` and `high` [Hz], shape (n,) [-]."""
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    inside[1] |= not inside[1:].any()
    spectrum = inside * np.exp(2j * np.pi * rng.random(frequency.size))
    time_series = np.fft.irfft(spectrum, n)
    return np.asarray(time_series / time_series.std())


def wander(rng: Rng, n: int, rate: float, corner: float) -> Array:
    """Draw low-pass noise of about unit variance below `corner` [Hz], shape (n,) [-]."""
    b, a = butter(2, min(2.0 * corner / rate, 0.9))
    settling = round(min(2.0 * rate / corner, 4.0 * n))
    time_series = lfilter(b, a, rng.standard_normal(n + settling))[settling:]
    return np.asarray(time_series * math.sqrt(0.5 * rate / (1.11 * corner)))


def slowly(rng: Rng, n: int, rate: float, corner: float) -> Array:
    """Draw low-pass noise as `wander` does, but faster for a low corner frequency, shape (n,)."""
    coarse = max(1, int(rate / (20.0 * corner)))
    slow = wander(rng, n // coarse + 2, rate / coarse, corner)
    return np.interp(np.arange(n), coarse * np.arange(slow.size), slow)


def telegraph(rng: Rng, n: int, rate: float, often: float) -> Array:
    """Draw a signal that switches between -1 and 1 at a mean rate `often` [Hz], shape (n,)."""
    return np.where(np.cumsum(rng.random(n) < often / rate) % 2 == int(rng.integers(2)), 1.0, -1.0)


_OWN_FORMS = packaged_toml("noise.diagnosis.cases", "own_forms.toml")

_ON_CHANNELS = ("channel_delay", "clipping", "gain_error", "mount_resonance")
"""Effects with one share parameter per channel."""


def drawn_effect(name: str, strength: float, rng: np.random.Generator) -> LawSpec:
    """Draw the parameters of an effect of given strength.

    Parameters
    ----------
    name : str
        Name of the effect in `sim.effects.EFFECTS`.
    strength : float
        Strength from 0 to 1 [-].
    rng : numpy.random.Generator

    Returns
    -------
    LawSpec

    Examples
    --------
    >>> import numpy as np
    >>> drawn_effect("critical_torque_scatter", 0.5, np.random.default_rng(0)).parameters["scatter"]
    0.4
    """
    values: dict[str, float | str] = {"form": str(rng.choice(EFFECTS[name].forms))}
    # A mount is mostly the accelerometer's. The order of the draws determines the result.
    alone = name == "mount_resonance" and rng.random() < 0.7
    values |= draw_numbers(_OWN_FORMS[name], rng, strength)
    if name in _ON_CHANNELS:
        names = ("acceleration",) if alone else SENSED
        values |= _own_shares(rng, names, signed=name == "channel_delay")
    return LawSpec(name, values)


def _own_shares(
    rng: np.random.Generator, names: tuple[str, ...] = SENSED, *, signed: bool = False
) -> dict[str, float]:
    """Draw the share of a fault in every channel; mostly a single channel has it."""
    if rng.random() < 0.65:
        chosen = [str(rng.choice(names))]
    else:
        chosen = [name for name in names if rng.random() < 0.7] or [str(rng.choice(names))]
    shares = dict.fromkeys(SENSED, 0.0)
    for name in chosen:
        size = float(rng.uniform(0.5, 1.0)) if len(chosen) > 1 else 1.0
        shares[name] = size * (float(rng.choice([-1.0, 1.0])) if signed else 1.0)
    return shares
