"""Ticks at round numbers, for the axes that a page draws itself."""

from __future__ import annotations

import math

__all__ = ["round_ticks"]


def round_ticks(low: float, high: float, most: int) -> list[float]:
    """Return multiples of 1, 2 or 5 times a power of ten, about `most` of them from low to high.

    Parameters
    ----------
    low, high : float
        Ends of the axis, in its unit, such as [Hz].
    most : int
        How many steps the axis is divided into at most.

    Examples
    --------
    >>> round_ticks(0.0, 7.9, 6), round_ticks(0.31, 0.36, 5)
    ([0.0, 2.0, 4.0, 6.0], [0.31, 0.32, 0.33, 0.34, 0.35, 0.36])
    """
    least = (high - low) / most
    decade = 10.0 ** math.floor(math.log10(least))
    step = next(step * decade for step in (1, 2, 5, 10) if least <= step * decade * (1 + 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    # Rounded, because 3 times 0.1 is not 0.3.
    return [float(f"{step * n:.12g}") for n in range(first, last + 1)]
