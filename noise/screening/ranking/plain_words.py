"""What a design does and what would help it, in a sentence for terminal, tables and pages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from noise.screening.design.axis_values import axis_words
from noise.screening.map.batches import LABELS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.screening.map.mapping import DesignMap

__all__ = ["first_hint", "plain_words"]

_QUIET = "none"

_DENSE = 0.7
"""Share of the points between the slowest and the fastest that a noise fills where it is told to
reach from the one to the other."""

_BETTER = 0.7
"""Share of all noisy use that a support or a fit must stay below to be worth a hint."""


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
    'quiet at every point of use, 2 to 12 rad/s; nothing vibrates'
    >>> screen(["fluorocarbon-thesis"], use).standings[0].words
    'squawks from 2 to 5 rad/s; quiet above; the use reaches 3 rad/s into what vibrates'
    """
    if never_slips:
        return f"{never_slips}; quiet" if found.grid.frequency else never_slips
    used = found.grid.used
    speed, label = np.array(found.grid.speed)[used], found.label[..., used]
    shares = {name: float(np.mean(label == name)) for name in LABELS if name != _QUIET}
    heard = sorted((name for name in shares if shares[name]), key=lambda name: -shares[name])
    if not heard:
        told = [f"quiet at every point of use, {_range(speed)}"]
    else:
        told = [", ".join(_noise(name, label == name, speed, found) for name in heard)]
        told += _silences(np.any(label != _QUIET, axis=(0, 1, 2)))
    return "; ".join([*told, *_margin(margin)])


def first_hint(found: DesignMap) -> str:
    """Say with which support or fit the use is quietest by far; empty where none is.

    Parameters
    ----------
    found : DesignMap

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(1.0, 5.0, 9.0), support_stiffness=(2214.0,))
    >>> screen(["PDMS"], use).standings[0].hint
    ''
    """
    noisy = found.label[..., found.grid.used] != _QUIET
    overall = float(noisy.mean())
    supports = [_support_words(value) for value in found.grid.support_stiffness]
    fits = [_fit_words([1e3 * value]) for value in found.grid.interference]
    tried = [
        *zip(noisy.mean(axis=(0, 2, 3)), supports, strict=True),
        *zip(noisy.mean(axis=(0, 1, 3)), fits, strict=True),
    ]
    share, where = min(tried, key=lambda one: float(one[0]))
    if not share < _BETTER * overall:
        return ""
    return f"quietest {where}: {share:.0%} of the use is noisy there, {overall:.0%} of all"


def _noise(
    name: str, happens: NDArray[np.bool_], speed: NDArray[np.float64], found: DesignMap
) -> str:
    """Say from which speed to which a noise is, and with which fits, supports and temperatures."""
    grid = found.grid
    columns = np.flatnonzero(happens.any(axis=(0, 1, 2)))
    span = speed[columns[0] : columns[-1] + 1]
    inside = happens[..., columns[0] : columns[-1] + 1]
    lines = inside.any(axis=3)
    dense = float(inside[lines].mean()) >= _DENSE
    temperatures, supports, fits = (np.unique(axis) for axis in np.nonzero(lines))
    where = [
        say([values[i] for i in there])
        for values, there, say in (
            ([1e3 * fit for fit in grid.interference], fits, _fit_words),
            (grid.support_stiffness, supports, _supports_words),
            (grid.temperature, temperatures, _temperature_words),
        )
        if there.size < len(values)
    ]
    between = f"at {span[0]:.3g} rad/s" if span.size == 1 else f"from {_range(span)}"
    often = "" if dense else " here and there"
    return " ".join([f"{name}s{often}", between, *where])


def _silences(noisy: NDArray[np.bool_]) -> list[str]:
    if not noisy[0] and not noisy[-1]:
        return ["quiet below and above"]
    if noisy[0] and noisy[-1]:
        return []
    return ["quiet above" if noisy[0] else "quiet below"]


def _margin(margin: float) -> list[str]:
    if math.isnan(margin):
        return []
    if math.isinf(margin):
        return ["nothing vibrates" if margin > 0.0 else "no speed of use is clear of vibration"]
    if margin > 0.0:
        return [f"margin {margin:.3g} rad/s to what vibrates"]
    if margin == 0.0:
        return ["no margin to what vibrates"]
    return [f"the use reaches {-margin:.3g} rad/s into what vibrates"]


def _range(speed: NDArray[np.float64]) -> str:
    if speed.size == 1:
        return f"{speed[0]:.3g} rad/s"
    return f"{speed[0]:.3g} to {speed[-1]:.3g} rad/s"


def _fit_words(values: Sequence[float]) -> str:
    return f"at {axis_words(values)} mm"


def _temperature_words(values: Sequence[float]) -> str:
    return f"at {axis_words(values)} °C"


def _support_words(value: float) -> str:
    return _supports_words([value])


def _supports_words(values: Sequence[float]) -> str:
    finite = [value for value in values if math.isfinite(value)]
    said = [f"on supports of {axis_words(finite)} Nm/rad"] if finite else []
    if len(finite) == 1:
        said = [f"on a support of {finite[0]:.4g} Nm/rad"]
    return " and ".join([*said, *(["with the clamp fixed"] if len(finite) < len(values) else [])])
