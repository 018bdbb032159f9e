"""What a design does over its use, in a sentence or two for terminal, tables and pages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.screening.design.axis_values import axis_words
from noise.screening.map.batches import LABELS

if TYPE_CHECKING:
    from noise.screening.map.mapping import DesignMap


_QUIET = "none"

_DENSE = 0.7
"""Share of the points between the slowest and the fastest that a noise fills where it is told to
reach from the one to the other."""

_RARE = 0.05
"""Share of the use below which a noise beside others is only named."""


def plain_words(found: DesignMap, margin: float, never_slips: str = "") -> str:
    """Say what a design does over its use.

    Parameters
    ----------
    found : DesignMap
    margin : float
        Of the use to what vibrates [rad/s]; NaN where the shaft swings.
    never_slips : str
        Why the contact never slips; empty where it does.

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(2.0, 5.0, 12.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    >>> screen(["PDMS"], use).standings[0].words
    'quiet at all 3 points of use; nothing vibrates'
    >>> screen(["fluorocarbon-thesis"], use).standings[0].words
    'squawks from 2 to 5 rad/s; quiet above; worst case: up to 3 rad/s of the operating range
      vibrates'
    """
    if never_slips:
        return f"{never_slips}; quiet" if found.grid.frequency else never_slips
    used = found.grid.used
    speed, label = np.array(found.grid.speed)[used], found.label[..., used]
    shares = {name: float(np.mean(label == name)) for name in LABELS if name != _QUIET}
    heard = sorted((name for name in shares if shares[name]), key=lambda name: -shares[name])
    if not heard:
        told = [f"quiet at all {label.size} points of use"]
    else:
        rare = [name for name in heard[1:] if shares[name] < _RARE]
        told = [_noise(name, label == name, speed, found) for name in heard if name not in rare]
        told += [f"rarely {' or '.join(f'{name}s' for name in rare)}"] if rare else []
        told += _silences(np.any(label != _QUIET, axis=(0, 1, 2)))
    return "; ".join([*told, *_margin(margin, found.grid.use)])


def _noise(
    name: str, happens: NDArray[np.bool_], speed: NDArray[np.float64], found: DesignMap
) -> str:
    """Say from which speed to which a noise is and where, or how often and where most."""
    span, inside = _span(happens, speed)
    lines = np.asarray(inside.any(axis=3))
    if float(inside[lines].mean()) >= _DENSE:
        return " ".join([f"{name}s", _between(span), *_where(lines, found)])
    told = f"{name}s at {happens.mean():.0%} of the use"
    most = [
        (float(happens[at].mean()), at, words)
        for at, words in (
            *((np.s_[:, i], supports_words([k])) for i, k in _alone(found.grid.support_stiffness)),
            *((np.s_[:, :, i], fit_words([k])) for i, k in _alone(found.grid.interference)),
        )
    ]
    if not most:
        return f"{told}, {_between(span)}"
    _, at, words = max(most, key=lambda one: one[0])
    return f"{told}, most {words} ({_between(_span(happens[at], speed)[0])})"


def _alone(values: Sequence[float]) -> list[tuple[int, float]]:
    """Values of an axis, unless there is one alone."""
    return list(enumerate(values)) if len(values) > 1 else []


def _span(
    happens: NDArray[np.bool_], speed: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Speeds from the first to the last at which something happens, and whether it does there."""
    columns = np.flatnonzero(happens.any(axis=tuple(range(happens.ndim - 1))))
    inside = slice(columns[0], columns[-1] + 1)
    return speed[inside], happens[..., inside]


def _where(lines: NDArray[np.bool_], found: DesignMap) -> list[str]:
    """Name fits, supports and temperatures, where they are not all."""
    grid = found.grid
    temperatures, supports, fits = (np.unique(axis) for axis in np.nonzero(lines))
    return [
        say([values[i] for i in there])
        for values, there, say in (
            (grid.interference, fits, fit_words),
            (grid.support_stiffness, supports, supports_words),
            (grid.temperature, temperatures, _temperature_words),
        )
        if there.size < len(values)
    ]


def _between(span: NDArray[np.float64]) -> str:
    return f"at {span[0]:.3g} rad/s" if span.size == 1 else f"from {_range(span)}"


def _silences(noisy: NDArray[np.bool_]) -> list[str]:
    if not noisy[0] and not noisy[-1]:
        return ["quiet below and above"]
    if noisy[0] and noisy[-1]:
        return []
    return ["quiet above" if noisy[0] else "quiet below"]


def _margin(margin: float, use: tuple[float, float]) -> list[str]:
    if math.isnan(margin):
        return []
    if margin == math.inf:
        return ["nothing vibrates"]
    if margin > 0.0:
        return [f"margin {margin:.3g} rad/s to the vibrating range"]
    if margin == 0.0:
        return ["no margin to the vibrating range"]
    if -margin >= use[1] - use[0]:
        return ["worst case: the whole operating range vibrates"]
    return [f"worst case: up to {-margin:.3g} rad/s of the operating range vibrates"]


def _range(speed: NDArray[np.float64]) -> str:
    if speed.size == 1:
        return f"{speed[0]:.3g} rad/s"
    return f"{speed[0]:.3g} to {speed[-1]:.3g} rad/s"


def fit_words(values: Sequence[float]) -> str:
    """Name interferences [m] behind what happens at them.

    Examples
    --------
    >>> fit_words([0.279e-3, 0.381e-3])
    'at 0.279 and 0.381 mm'
    """
    return f"at {axis_words([1e3 * value for value in values])} mm"


def supports_words(values: Sequence[float]) -> str:
    """Name supports [Nm/rad] behind what happens with them.

    Examples
    --------
    >>> supports_words([2214.0, math.inf])
    'on a support of 2214 Nm/rad and with the clamp fixed'
    """
    finite = [value for value in values if math.isfinite(value)]
    several = "supports" if len(finite) > 1 else "a support"
    said = [f"on {several} of {axis_words(finite)} Nm/rad"] if finite else []
    return " and ".join([*said, *(["with the clamp fixed"] if len(finite) < len(values) else [])])


def _temperature_words(values: Sequence[float]) -> str:
    return f"at {axis_words(values)} °C"
