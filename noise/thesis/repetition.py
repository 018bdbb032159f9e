"""Repetition rate of a torque: slips per second, or periods of an oscillation without slips."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from features.kernels.harmonics import analyse_harmonics

if TYPE_CHECKING:
    from sim.analysis.slips import Slips


def repetition_rate(slips: Slips, torque: ArrayLike, rate: float) -> float:
    """Return the slips per second, or periods per second where nothing slips.

    Slips that differ, as where the period has doubled, are counted each: this is no subharmonic.

    Parameters
    ----------
    slips : Slips
        Those of the torque.
    torque : array_like, shape (n,)
        [Nm]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    float
        [Hz]; NaN where nothing repeats.

    Raises
    ------
    ParameterError
        A signal that can't be analysed.

    Examples
    --------
    >>> import numpy as np
    >>> from sim.analysis.slips import find_slips
    >>> t = np.arange(6000) / 30e3
    >>> torque = 8.0 + np.sin(2 * np.pi * 300.0 * t)
    >>> slips = find_slips(torque / 665.0, 5.0, 30e3, own_period=1e-3)
    >>> round(repetition_rate(slips, torque, 30e3))
    300
    """
    slip_rate = slips.rate
    return analyse_harmonics(torque, rate).fundamental if math.isnan(slip_rate) else slip_rate
