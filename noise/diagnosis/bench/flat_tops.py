"""Channels whose peaks are flat, as an overload leaves them and as no vibration has them.

A range that is reached in all recordings is told by `noise.diagnosis.bench.faults`; an amplifier
that overloads before the anti-alias filter leaves no single largest value, but samples that pile up
at the ends of the signal. Whatever swings smoothly passes its peak as a parabola does: within a
small distance w of the end it is 1 / (sqrt(2) - 1) = 2.4 times as long as between w and 2 w, and
less where peaks have unequal heights. More is an overload, unless the simulation has it as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from models.recording import Recording


_KINDS = ("torque", "acceleration", "pressure")

_WIDTHS = (0.02, 0.05, 0.1, 0.15)
"""Distances from an end, over the span [-]: the lower an amplifier cuts, the wider its filter's
ringing spreads what it left; assumed."""

_ENDS = (0.001, 0.999)
"""Quantiles that a signal's ends are [-]; single impacts lie beyond; assumed."""

_LEAST = 0.02
"""Share of the samples that a pile has at least [-]; fewer may be the foot of an impact;
assumed."""

_BOTH, _ONE = 3.0, 4.5
"""Ratios from which a channel is piled up at both ends, and at one [-]: beyond the 2.4 of a
parabola, and measured on 139 development cases without clipping, where the largest were 2.3 and
2.8."""

_FEWEST = 3
"""Recordings: in a single short one, of a few peaks, chance makes ratios up to 5 (measured on the
same)."""

_OF_SIMULATION = 0.5
"""Share of a ratio that the simulation's must stay below [-]; assumed."""

_FEWEST_VALUES = 40
"""That a signal takes; with fewer the steps of a converter are what piles up; assumed."""


def flat_channels(
    recordings: Sequence[Recording], simulated: Callable[[Recording], Recording]
) -> tuple[str, ...]:
    """Name the kinds of channel whose peaks are flat in most recordings, unlike the simulation's.

    Parameters
    ----------
    recordings : sequence of Recording
        Of one rig; fewer than three tell nothing.
    simulated : callable
        Returns what the rig file makes of the condition of a recording; asked where peaks are flat.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> tone = np.sin(np.arange(9000.0))[None]
    >>> plain, cut = (Recording(x, 30e3, (Channel("pressure"),))
    ...               for x in (tone, np.clip(tone, -0.6, 0.6)))
    >>> flat_channels([cut] * 3, lambda _: plain), flat_channels([plain] * 3, lambda _: plain)
    (('pressure',), ())
    """
    found = []
    repeats: list[Recording] = []
    for kind in _KINDS:
        having = [r for r in recordings if r.first(kind) is not None]
        if len(having) < _FEWEST or (flat := _flatness(having, kind)) < 1.0:
            continue
        repeats = repeats or [simulated(r) for r in recordings]
        made = [r for r in repeats if r.first(kind) is not None]
        if len(made) < _FEWEST or _flatness(made, kind) < _OF_SIMULATION * flat:
            found.append(kind)
    return tuple(found)


def _flatness(recordings: Sequence[Recording], kind: str) -> float:
    """How far a channel is beyond the ratios that are an overload's [-]."""
    each = [pile_ups(r.samples[row]) for r in recordings if (row := r.first(kind)) is not None]
    middle = np.median(each, axis=0)
    return float(max(middle.min(axis=0).max() / _BOTH, middle.max() / _ONE))


def pile_ups(signal: NDArray[np.float64]) -> NDArray[np.float64]:
    """How many times as many samples lie at either end of a signal as just below it.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [any unit]

    Returns
    -------
    ndarray, shape (2, n_widths)
        At the upper end and at the lower, within several widths [-]; 0 where few samples are.

    Examples
    --------
    >>> pile_ups(np.sin(np.arange(9000.0))).max().round(1)
    np.float64(2.4)
    """
    low, high = np.quantile(signal, _ENDS)
    span = float(high - low)
    ratios = np.zeros((2, len(_WIDTHS)))
    if not span or np.unique(signal).size < _FEWEST_VALUES:
        return ratios
    for i, from_end in enumerate(((high - signal) / span, (signal - low) / span)):
        within = np.sort(from_end[from_end < 2.0 * _WIDTHS[-1]])
        for j, width in enumerate(_WIDTHS):
            at, below = np.searchsorted(within, (width, 2.0 * width)).tolist()
            if at >= _LEAST * signal.size:
                ratios[i, j] = at / (below - at + 1.0)
    return ratios
