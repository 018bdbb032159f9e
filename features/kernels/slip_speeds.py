"""Slips in a sliding speed: intervals in which a surface slides, from a threshold with hysteresis.

The torque shows a slip as a sudden drop (`features.kernels.slip_drops`), the sound as a pulse
(`features.kernels.slip_pulses`); where the sliding speed itself is known, as in a reconstruction of
the contact, it shows beginning and end.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["in_intervals", "slip_intervals"]


def slip_intervals(
    speed: NDArray[np.float64], *, above: float, below: float, apart: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find the slips in a sliding speed.

    Parameters
    ----------
    speed : ndarray, shape (n_samples,)
        Sliding speed [rad/s].
    above, below : float
        Speeds above which a slip begins, and below which it ends; the latter is lower [rad/s].
    apart : int
        Slips with fewer samples between them are one [-].

    Returns
    -------
    starts, ends : ndarray of int, shape (n_slips,)
        First sample of each slip, and first after it. What has not ended is no slip.

    Examples
    --------
    >>> speed = np.array([0.0, 5.0, 2.0, 5.0, 0.0, 0.0, 0.0, 4.0, 0.0, 6.0])
    >>> starts, ends = slip_intervals(speed, above=3.0, below=1.0, apart=2)
    >>> starts.tolist(), ends.tolist()
    ([1, 7], [4, 8])
    """
    decided = np.flatnonzero((speed > above) | (speed < below))
    slipping = speed[decided] > above
    turns = decided[slipping != np.append(False, slipping[:-1])]
    first, last = turns[: turns.size // 2 * 2].reshape(-1, 2).T
    edge = np.ones(first.size + 1, np.bool_)
    edge[1:-1] = first[1:] - last[:-1] >= apart
    return first[edge[:-1]], last[edge[1:]]


def in_intervals(
    starts: NDArray[np.int64], ends: NDArray[np.int64], n_samples: int, *, margin: int = 0
) -> NDArray[np.bool_]:
    """Whether each sample lies in one of several intervals, or this close to one.

    Parameters
    ----------
    starts, ends : ndarray of int, shape (n_intervals,)
        First sample of each, and first after it.
    n_samples : int
    margin : int
        Samples that count as well on either side [-].

    Returns
    -------
    ndarray of bool, shape (n_samples,)

    Examples
    --------
    >>> in_intervals(np.array([1]), np.array([3]), 5).tolist()
    [False, True, True, False, False]
    """
    step = np.zeros(n_samples + 1, np.int64)
    np.add.at(step, np.maximum(starts - margin, 0), 1)
    np.add.at(step, np.minimum(ends + margin, n_samples), -1)
    return np.asarray(np.cumsum(step)[:n_samples] > 0)
