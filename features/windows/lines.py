"""Maxima of a spectrum that are lines, and the fundamental that most of them are harmonics of.

Compiled for `features.windows.tones`, which says what is done with them.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["BLOCK", "FIRST", "LOBE", "MOST", "RANGE_DB", "SPACING", "find_harmonics", "find_lines"]

SPACING = 16_000 / 4096
"""Of the bins [Hz]."""

FIRST = 38
"""Bin from which lines are sought: 148 Hz."""

LOBE = 3
"""Bins on either side of a line that are its own."""

BLOCK = 32
"""Bins whose median is the floor of all of them."""

MOST = 40
"""Lines that are kept."""

RANGE_DB = 30.0
"""Weaker ones than this below the strongest are none [dB]."""

_STANDS_DB = 10.0
_COUNTED_DB = 18.0

_OCTAVES = 1.0 / np.log(2.0)
"""What makes a natural logarithm one of base two."""


@njit(cache=True, error_model="numpy")
def find_lines(level, floor, end, top, at, height):
    """Lines in rising frequency; count of all, and of those close to the strongest."""
    least = level[top] - RANGE_DB
    count = 0
    candidate = -1
    lowest = level[FIRST]
    for k in range(FIRST, end):
        v = level[k]
        if candidate < 0:
            lowest = min(lowest, v)
            if v >= lowest + _STANDS_DB and v > level[k + 1] and v >= level[k - 1]:
                candidate = k
        elif v > level[candidate]:
            candidate = k
        elif v < level[candidate] - _STANDS_DB:
            stands = level[candidate] - floor[min((candidate - FIRST) // BLOCK, len(floor) - 1)]
            if level[candidate] >= least and stands >= _STANDS_DB and count < MOST:
                at[count] = candidate
                height[count] = level[candidate]
                count += 1
            candidate = -1
            lowest = v
    strong = 0
    for i in range(count):
        if height[i] >= level[top] - _COUNTED_DB:
            strong += 1
    return count, strong


@njit(cache=True, error_model="numpy")
def find_harmonics(p, level, at, height, count, top, place, end, total, out):
    """Find the fundamental whose multiples hold most of the power in lines."""
    best, best_share, best_count, best_off = 0.0, 0.0, 0, 0.0
    strongest = level[top]
    for divisor in range(1, 9):
        base = place / divisor
        if base * SPACING < 40.0:
            break
        share, number, off = 0.0, 0, 0.0
        for i in range(count):
            ratio = at[i] / base
            order = round(ratio)
            if order < 1:
                continue
            error = abs(ratio - order) * base
            if error <= 1.5 + 0.006 * at[i]:
                share += 10.0 ** (0.1 * (height[i] - strongest))
                number += 1
                off += abs(ratio - order) / order
        # A lower fundamental has more multiples, so it must explain notably more.
        value = share * 0.93**divisor
        if value > best_share:
            best, best_share, best_count, best_off = base, value, number, off
    if best == 0.0:
        return
    power, bins = 0.0, 0
    order = 1
    while order * best < end - LOBE:
        centre = round(order * best)
        if centre - LOBE >= FIRST:
            reach = min(LOBE, int(0.4 * best))
            for k in range(centre - reach, centre + reach + 1):
                power += p[k]
                bins += 1
        order += 1
    out[9] = _OCTAVES * np.log(best * (SPACING / 100.0))
    out[10] = min(1.0, power / total)
    out[11] = best_count
    out[12] = best_off / max(best_count, 1)
    out[13] = out[10] - bins / (end - FIRST)
