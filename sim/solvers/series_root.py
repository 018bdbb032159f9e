# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001, ANN202
"""Where a power series first comes down to zero: how the ends of stick and slip are found.

Newton's method kept within a bracket, to machine precision. A series that dips below zero and
comes back within the interval (a graze) is found by its minimum.
"""

from __future__ import annotations

from numba import njit

from models.compilation import PART

__all__ = ["first_crossing", "turns_within"]

_ROUNDING = 4.0e-16
"""Of the interval: below it, bisection no longer moves."""


@njit(**PART)
def turns_within(start, end, slope, end_slope, length) -> bool:
    """Whether the cubic through these values and slopes turns, by its slope at ends and middle."""
    middle = 1.5 * (end - start) / length - 0.25 * (slope + end_slope)
    return (slope < 0.0) != (end_slope < 0.0) or (slope < 0.0) != (middle < 0.0)


@njit(**PART)
def first_crossing(p, order, end) -> float:
    """First t in (0, end] where sum(p[k] t^k) comes from above zero to zero or below; else -1."""
    value, slope = _value_and_slope(p, order, end)
    if turns_within(p[0], value, p[1], slope, end):
        middle_value, middle_slope = _value_and_slope(p, order, 0.5 * end)
        t = _crossing(p, order, 0.0, 0.5 * end, p[0], middle_value, p[1], middle_slope)
        if t >= 0.0:
            return t
        return _crossing(p, order, 0.5 * end, end, middle_value, value, middle_slope, slope)
    return _crossing(p, order, 0.0, end, p[0], value, p[1], slope)


@njit(**PART)
def _crossing(p, order, start, end, start_value, end_value, start_slope, end_slope):
    if end_value <= 0.0:
        return _root(p, order, start, end, start_value, end_value)
    if start_slope >= 0.0 or end_slope <= 0.0:
        return -1.0
    low, high = start, end  # on both sides of a minimum
    while high - low > _ROUNDING * end:
        middle = 0.5 * (low + high)
        value, slope = _value_and_slope(p, order, middle)
        if value <= 0.0:
            return _root(p, order, start, middle, start_value, value)
        if slope < 0.0:
            low = middle
        else:
            high = middle
    return -1.0


@njit(**PART)
def _value_and_slope(p, order, t):
    value, slope = p[order], 0.0
    for k in range(order - 1, -1, -1):
        slope = slope * t + value
        value = value * t + p[k]
    return value, slope


@njit(**PART)
def _root(p, order, start, end, start_value, end_value):
    low, high = start, end
    t = start
    if start_value > 0.0:
        t += (end - start) * start_value / (start_value - end_value)
    for _ in range(100):
        value, slope = _value_and_slope(p, order, t)
        if value > 0.0:
            low = t
        else:
            high = t
        new = t - value / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - t) <= _ROUNDING * end:
            return new
        t = new
    return t
