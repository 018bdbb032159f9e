"""A logged speed beside the one that a channel tells: written as it was logged where they agree."""

from __future__ import annotations

import math

_AS_LOGGED = 0.005
"""A measured speed that is off by no more is the one that was logged [-]."""

_DIGITS = 4
"""Of a measured speed, of which an angle tells no more."""


def agrees(measured: float, logged: float) -> bool:
    """Whether a measured speed is the one that was logged, whatever the sense of rotation.

    Parameters
    ----------
    measured, logged : float
        [rad/s]

    Examples
    --------
    >>> agrees(-4.999989, 5.0), agrees(10.0, 5.0)
    (True, False)
    """
    return abs(abs(measured) - abs(logged)) <= _AS_LOGGED * abs(logged)


def as_logged(measured: float, logged: float | None) -> float:
    """Return a measured speed as it is written.

    Parameters
    ----------
    measured : float
        [rad/s]
    logged : float or None
        [rad/s]; ``None`` where none was.

    Returns
    -------
    float
        The logged one with the sign of the measured one where they agree, else the measured one
        with as many digits as a channel tells [rad/s].

    Examples
    --------
    >>> as_logged(-4.999989, 5.0), as_logged(10.00002, 5.0), as_logged(4.999989, None)
    (-5.0, 10.0, 5.0)
    """
    if logged is not None and agrees(measured, logged):
        return math.copysign(logged, measured)
    return float(f"{measured:.{_DIGITS}g}")
