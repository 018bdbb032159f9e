r"""Stick-slip of a slider drawn by a spring at an irregular speed.

The spring k is drawn at v(t). The contact bears a friction that grows with the time of stick,

.. math::
    F_s(t_s) = F_k + \Delta F \, (1 - e^{-t_s / \tau}), \qquad
    k \int v \, dt = 2 (F_s - F_k) (1 + \sigma \xi)

so a slip comes where the spring has been drawn by a distance D = D_0 (1 - exp(-t_s / tau)), and
lets go as much, its overshoot being the mirror image of what it was drawn beyond F_k. The second
equation holds for every stick, with a scatter sigma of contacts that differ. The longer the stick,
the larger the slip: slow creaks knock, fast ones buzz. A slip takes far less time than a stick and
counts as instantaneous (Rabinowicz, *Friction and Wear of Materials*, chapter 4.8).

The rate of slips is v / D; v is drawn such that it glides, irregularly, and stops now and then.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from noise.training.draws import log_uniform, wandering


@dataclass(frozen=True, eq=False)
class Slips:
    """Times [s] and sizes of slips, relative to D_0; arrays of shape (n_slips,)."""

    time: NDArray[np.float64]
    size: NDArray[np.float64]


def random_drive(
    n: int,
    rate: float,
    slowest: float,
    fastest: float,
    rng: np.random.Generator,
    *,
    steps: bool = False,
) -> NDArray[np.float64]:
    """Return a random speed of the drive over D_0, which is nearly the slip rate of long sticks.

    Its logarithm varies between `slowest` and `fastest`, like that of a hand or a gust; sometimes
    it rests, or begins fast and dies away.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    slowest, fastest : float
        [1/s]
    rng : numpy.random.Generator
    steps : bool
        Whether half of the drives jump between steady speeds, like slips that lock onto modes of
        the body.

    Returns
    -------
    ndarray, shape (n,)
        [1/s]

    Examples
    --------
    >>> drive = random_drive(48_000, 48e3, 5.0, 250.0, np.random.default_rng(0))
    >>> bool(drive.min() >= 0.0), bool(drive.max() < 400.0)
    (True, True)
    """
    middle, half = 0.5 * math.log(slowest * fastest), 0.5 * math.log(fastest / slowest)
    course = wandering(n, rate, log_uniform(0.3, 4.0, rng), rng)
    x = np.linspace(0.0, 1.0, n)
    if rng.random() < 0.5:  # a trend: decay, start, or both
        trend = rng.choice((-1.0, 1.0)) * (1.0 - 2.0 * x ** rng.uniform(0.5, 2.0))
        if rng.random() < 0.4:
            trend = 1.0 - 2.0 * np.abs(2.0 * x - 1.0)
        share = rng.uniform(0.4, 0.9)
        course = share * trend + (1.0 - share) * course
    course = half * np.clip(course, -1.1, 1.1)
    if steps and rng.random() < 0.5:
        step = rng.uniform(0.15, 0.7)
        course = 0.85 * step * np.round(course / step) + 0.15 * course
    drive = np.exp(middle + course)
    for _ in range(int(rng.poisson(0.5 * n / rate))):
        start = int(rng.integers(n))
        drive[start : start + int(rng.uniform(0.04, 0.3) * rate)] = 0.0
    return np.asarray(drive)


def slide(
    drive: NDArray[np.float64],
    rate: float,
    *,
    ageing_time: float,
    scatter: float,
    rng: np.random.Generator,
) -> Slips:
    """Return the slips of a slider.

    Parameters
    ----------
    drive : ndarray, shape (n,)
        Speed of the drive over D_0 [1/s].
    rate : float
        Sampling rate [Hz].
    ageing_time : float
        tau [s].
    scatter : float
        sigma [-].
    rng : numpy.random.Generator

    Examples
    --------
    >>> slips = slide(np.full(48_000, 50.0), 48e3, ageing_time=1e-4, scatter=0.0,
    ...               rng=np.random.default_rng(0))
    >>> slips.time.size
    50
    """
    scattered = np.maximum(0.15, 1.0 + scatter * rng.standard_normal(4096))
    index, size = _slips(drive, rate, ageing_time, scattered)
    return Slips(index / rate, size)


def _events(
    drive: NDArray[np.float64], rate: float, ageing_time: float, scattered: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    index = np.empty(drive.size)
    size = np.empty(drive.size)
    count = 0
    drawn = 0.0
    stick = 0.0
    for i in range(drive.size):
        step = drive[i] / rate
        drawn += step
        stick += 1.0 / rate
        borne = scattered[count % scattered.size] * (1.0 - math.exp(-stick / ageing_time))
        # A contact needs 0.1 ms to form.
        if drawn >= borne and stick > 1e-4:
            index[count] = i - min(1.0, (drawn - borne) / max(step, 1e-12))
            size[count] = drawn
            count += 1
            drawn = 0.0
            stick = 0.0
    return index[:count].copy(), size[:count].copy()


_slips = njit(cache=True)(_events)
