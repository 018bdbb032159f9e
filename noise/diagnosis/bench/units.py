"""Factors by which a number in a usual wrong unit is off, so that a finding can name the unit."""

from __future__ import annotations

import math

_EXACT = 0.16
"""Difference of logarithms up to which a factor is that of a unit [-]; gains err by as much;
assumed."""

_UNITS = {
    "acceleration": {1.0 / 9.80665: "g", 1e3: "mm/s^2", 1e3 / 9.80665: "mg", 1e-3: "km/s^2"},
    "pressure": {1e3: "mPa", 1e6: "uPa", 1e-3: "kPa", 1e-5: "bar", 1e-2: "hPa"},
    "torque": {
        1e3: "N mm", 1e2: "N cm", 1e-3: "kN m", 8.851: "lbf in", 10.197: "kgf cm",
        0.10197: "kgf m",
    },
    "angle": {180.0 / math.pi: "degrees", 0.5 / math.pi: "turns", 1e3: "mrad"},
    "speed": {30.0 / math.pi: "rpm", 180.0 / math.pi: "degree/s", 0.5 / math.pi: "turns/s"},
}  # fmt: skip
"""By channel: how many times too large a value in the unit reads."""


def unit_of(kind: str, factor: float, within: float = _EXACT) -> str:
    """Return the wrong unit that makes a quantity read so many times too large; empty if none.

    Parameters
    ----------
    kind : str
        Of the channel, or ``speed`` for the one that is stated.
    factor : float
        [-]
    within : float
        Difference of logarithms [-].

    Examples
    --------
    >>> unit_of("pressure", 1020.0), unit_of("acceleration", 0.1), unit_of("torque", 1.1)
    ('mPa', 'g', '')
    """
    if factor <= 0.0:
        return ""
    found = {abs(math.log(factor / f)): unit for f, unit in _UNITS[kind].items()}
    nearest = min(found)
    return found[nearest] if nearest <= within else ""


def length_unit(stated: float, low: float, high: float) -> str:
    """Return the unit in which a length was stated that is far from all that it can be.

    Parameters
    ----------
    stated, low, high : float
        The length, and between which it can be [m].

    Returns
    -------
    str
        Empty where no unit makes it one.

    Examples
    --------
    >>> length_unit(0.279e-6, 0.178e-3, 0.381e-3), length_unit(0.5e-3, 0.178e-3, 0.381e-3)
    ('m', '')
    """
    units = {"m": 1e3, "um": 1e-3, "inches": 25.4, "cm": 10.0}
    return next(
        (unit for unit, x in units.items() if low <= x * stated * 1.001 <= high * 1.002), ""
    )


def factor_words(factor: float) -> str:
    """Say how far a quantity is off.

    Examples
    --------
    >>> factor_words(1000.0), factor_words(0.102)
    ('1000 times too large', '9.8 times too small')
    """
    size = max(factor, 1.0 / factor)
    return (
        f"{size:.2g} times too {'large' if factor > 1.0 else 'small'}"
        if size < 100.0
        else (f"{float(f'{size:.2g}'):.0f} times too {'large' if factor > 1.0 else 'small'}")
    )
