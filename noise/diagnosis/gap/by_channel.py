"""The gap of each channel: which ones a model describes, and where it does not."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.gap.distance import Reference, group_costs
from noise.diagnosis.gap.signature import EDGES, KINDS, group_of

_LIKE_THE_MOST = 0.5
"""Share of the largest deviation from which on others are as large; assumed."""

_GROUP_OF = group_of()


def channel_distances(
    signatures: Sequence[NDArray[np.float64]], references: Sequence[Reference]
) -> NDArray[np.float64]:
    """Distance of each recording from its repeats, channel by channel.

    The torque's cycle counts as torque.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One a recording As of `noise.diagnosis.gap.signature.signature`.
    references : sequence of Reference
        One a recording.

    Returns
    -------
    ndarray, shape (n_recordings, n_kinds)
        In units of what repeats differ by in the channel, `KINDS` [-]; NaN where there is none.

    Examples
    --------
    >>> from noise.diagnosis.gap.distance import reference
    >>> from noise.diagnosis.gap.signature import NAMES
    >>> runs = np.random.default_rng(0).normal(size=(13, len(NAMES)))
    >>> runs[12, : len(NAMES) // 4] += 8.0
    >>> torque, *others = channel_distances([runs[12]], [reference(list(runs[:12]))])[0]
    >>> bool(torque > 2.0), bool(max(others) < 1.5)
    (True, True)
    """
    floors: dict[int, NDArray[np.float64]] = {}
    rows = []
    for signature, reference in zip(signatures, references, strict=True):
        if id(reference) not in floors:
            each = [_costs(reference.deviation(repeat)) for repeat in reference.repeats]
            n = len(each)
            # a repeat that is one of those the mean is of lies nearer to it than another would
            floors[id(reference)] = np.mean(each, axis=0) * (n + 1.0) / (n - 1.0)
        rows.append(np.sqrt(_costs(reference.deviation(signature)) / floors[id(reference)]))
    return np.array(rows)


def worst_places(
    deviations: NDArray[np.float64],
) -> tuple[tuple[str, ...], tuple[float, float]]:
    """Tell in which channels and band deviations are largest.

    Parameters
    ----------
    deviations : ndarray, shape (n_recordings, n_values)
        In standard deviations of repeats [-].

    Returns
    -------
    channels : tuple of str
    band : (float, float)
        Of the bands of the first of them [Hz].

    Examples
    --------
    >>> from noise.diagnosis.gap.signature import NAMES
    >>> off = np.ones((2, len(NAMES)))
    >>> off[:, [NAMES.index(f"pressure_{f}") for f in (400, 449, 504)]] = 30.0
    >>> channels, (low, high) = worst_places(off)
    >>> channels, round(low), round(high)
    (('pressure',), 400, 566)
    """
    costs = np.array([_costs(row) for row in deviations])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # channels that were not recorded
        of_channels = np.sqrt(np.nanmean(costs, axis=0))
        size = np.sqrt(np.nanmean(deviations**2, axis=0))
    known = np.nan_to_num(of_channels)
    order = np.argsort(-known)
    worst = int(order[0])
    channels = tuple(KINDS[i] for i in order if known[i] >= _LIKE_THE_MOST * known[worst])
    inside = np.nan_to_num(size[worst == _GROUP_OF])
    bands = np.flatnonzero(inside >= _LIKE_THE_MOST * inside.max())
    return channels, (float(EDGES[bands[0]]), float(EDGES[bands[-1] + 1]))


def _costs(deviation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean cost of each of `KINDS`, the torque's with that of its cycle."""
    *channels, cycle = group_costs(deviation)
    torque = KINDS.index("torque")
    if np.isfinite(cycle):
        channels[torque] = 0.5 * (channels[torque] + cycle)
    return np.array(channels)
