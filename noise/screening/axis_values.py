"""Parser of the values along an axis of a map, from design files and options.

A number, a list, or a range ``LOW..HIGH`` with as many points as asked for, ``LOW..HIGH/N``. A
range without them has those of a map that shows a boundary where it is: a speed every eighth of a
radian a second, seventeen fits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from models.condition import FIXED
from models.errors import ParameterError
from models.units import ABSOLUTE_ZERO

MOST_POINTS = 2000
"""Along one axis."""

SPEED_STEP = 0.125
"""Of a range of speeds without points of its own [rad/s]."""


@dataclass(frozen=True)
class AxisRule:
    """Allowed values of an axis.

    Parameters
    ----------
    step : float, optional
        Step of a range without a number of points, in the unit of the axis, such as [rad/s].
    points : int
        Number of points of a range without one, where there is no step.
    low : float
        Lower limit, in the unit of the axis, such as [rad/s].
    open_low : bool
        Whether `low` itself is not allowed.
    fixed : bool
        Whether ``fixed`` is a value.
    """

    step: float | None = None
    points: int = 17
    low: float = 0.0
    open_low: bool = True
    fixed: bool = False


POSITIVE = AxisRule()
SPEED = AxisRule(step=SPEED_STEP)
FREQUENCY = AxisRule(step=0.25)
SUPPORT = AxisRule(fixed=True)
TEMPERATURE = AxisRule(points=3, low=ABSOLUTE_ZERO, open_low=False)


def spread(low: float, high: float, points: int) -> tuple[float, ...]:
    """Return evenly spaced values, rounded to ten digits.

    Parameters
    ----------
    low, high : float
        Ends, in the unit of the axis, such as [rad/s].
    points : int
        2 or more.

    Examples
    --------
    >>> spread(0.25, 1.0, 4)
    (0.25, 0.5, 0.75, 1.0)
    """
    if points == 1:
        return (low,)
    step = (high - low) / (points - 1)
    return tuple(float(f"{low + i * step:.10g}") for i in range(points))


def axis_values(given: object, what: str, rule: AxisRule = POSITIVE) -> tuple[float, ...]:
    """Parse an axis: a number, ``5``, ``0.178,0.279``, ``0.25..13``, ``0.25..13/52``, or a list.

    Parameters
    ----------
    given : object
        Value of an option or a key of a design file; None has no values.
    what : str
        Name of the axis in messages, such as ``--speed``.
    rule : AxisRule

    Returns
    -------
    tuple of float
        Rising, each once, in the unit of the axis, such as [rad/s].

    Raises
    ------
    ParameterError
        It is none of these, or a value is out of range.

    Examples
    --------
    >>> axis_values("1..2/3", "--speed"), axis_values("fixed,2214", "-k", SUPPORT)
    ((1.0, 1.5, 2.0), (2214.0, inf))
    >>> axis_values([0.178, 0.279], "interference_mm"), axis_values("1..2/2", "speed_rad_s")
    ((0.178, 0.279), (1.0, 2.0))
    """
    if given is None:
        return ()
    values: list[float] = []
    for item in given if isinstance(given, list) else [given]:
        if isinstance(item, str):
            for part in item.split(","):
                values += _part_values(part, what, item, rule)
        elif isinstance(item, int | float) and not isinstance(item, bool):
            values.append(float(item))
        else:
            raise ParameterError(f"{what} = {given!r}: give numbers, or a range such as '0.25..13'")
    return _checked(values, what, str(given), rule)


def _part_values(part: str, what: str, whole: str, rule: AxisRule) -> tuple[float, ...]:
    """Parse the text between two commas: a number or a range."""
    first, dots, rest = part.partition("..")
    if not dots:
        return (_value(part, what, whole, fixed=rule.fixed),)
    last, slash, count = rest.partition("/")
    start, end = _value(first, what, whole), _value(last, what, whole)
    if not start < end:
        raise ParameterError(f"{what} is {whole!r}: a range rises, as 0.25..13 does")
    if slash and not (count.strip().isdecimal() and 2 <= int(count) <= MOST_POINTS):
        raise ParameterError(
            f"{what} is {whole!r}: the points of a range are a whole number from 2 to "
            f"{MOST_POINTS}, as in 0.25..13/52"
        )
    n = int(count) if slash else rule.points
    if rule.step is not None and not slash:
        n = min(MOST_POINTS, round((end - start) / rule.step) + 1)
    return spread(start, end, max(2, n))


def axis_words(values: Sequence[float], most: int = 4) -> str:
    """Return the values of an axis as text, or only its ends and number above `most` values.

    Parameters
    ----------
    values : sequence of float
        In the unit of the axis, such as [rad/s].
    most : int

    Examples
    --------
    >>> axis_words([2214.0, FIXED]), axis_words([0.25, 0.5, 0.75], most=2)
    ('2214 and fixed', '0.25 to 0.75 (3 values)')
    """
    texts = ["fixed" if math.isinf(value) else f"{value:.4g}" for value in values]
    if len(texts) > most:
        return f"{texts[0]} to {texts[-1]} ({len(texts)} values)"
    return " and ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def _value(text: str, what: str, whole: str, *, fixed: bool = False) -> float:
    if fixed and text.strip().lower() == "fixed":
        return FIXED
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        word = ", or fixed" if fixed else ""
        raise ParameterError(
            f"{what} is {whole!r}, expected numbers such as 5, 1,2.5,5 or 0.25..13/52{word}"
        )
    return value


def _checked(numbers: list[float], what: str, text: str, rule: AxisRule) -> tuple[float, ...]:
    values = sorted(set(numbers))
    if not values:
        raise ParameterError(f"{what} is empty; give at least one value")
    low = rule.low
    if not (values[0] > low if rule.open_low else values[0] >= low) or math.isnan(values[-1]):
        bound = "above" if rule.open_low else "at least"
        raise ParameterError(f"{what} is {text!r}; values must be {bound} {low:g}")
    if len(values) > MOST_POINTS:
        raise ParameterError(f"{what} has {len(values)} values; at most {MOST_POINTS} are mapped")
    return tuple(values)
