"""The terms that a linear oscillator may lack, one entry each.

Displacement and drive are counted in their own rms values, velocity in natural frequency times rms
displacement, time from -1/2 to 1/2 over the record: so every coefficient is a share, and the
same size of it means the same strength in any unit of measurement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import fft

from tests.studies.oscillator_terms.motion import FORCE_SIGNATURE, no_force

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LIBRARY", "Force", "Term"]

Force = Callable[[float, float, float, "NDArray[np.float64]"], float]
"""Compiled with `FORCE_SIGNATURE`."""
Static = Callable[["NDArray[np.float64]", "NDArray[np.float64]"], "NDArray[np.float64]"]
"""Changes a signal, given the coefficients."""
Sensed = Callable[["NDArray[np.float64]", "NDArray[np.float64]", float], "NDArray[np.float64]"]
"""Changes a displacement, given the coefficients and the natural angle a sample [rad]."""


@dataclass(frozen=True)
class Term:
    """One thing that the linear model may lack.

    Parameters
    ----------
    name : str
        As it stands in results.
    meaning : str
        What it is, in the words of a report.
    lowest : tuple of float
        Lower bound of each coefficient.
    highest : tuple of float
        Upper bound of each coefficient.
    force : compiled function
        Restoring force of displacement, velocity, time and coefficients, `FORCE_SIGNATURE`.
    driven : callable, optional
        What becomes of the drive before it acts.
    sensed : callable, optional
        What becomes of the displacement before it is recorded.
    spoils_quiet : bool
        Whether it weighs more, not less, at small amplitudes, where the linear model should hold.

    Examples
    --------
    >>> LIBRARY[1].name, LIBRARY[1].force(2.0, 0.0, 0.0, np.array([0.1]))
    ('cubic_stiffness', 0.8)
    """

    name: str
    meaning: str
    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    force: Force = no_force
    driven: Static | None = None
    sensed: Sensed | None = None
    spoils_quiet: bool = False


@njit(FORCE_SIGNATURE, cache=True)
def _quadratic_stiffness(x, v, t, p):
    return p[0] * x * x


@njit(FORCE_SIGNATURE, cache=True)
def _cubic_stiffness(x, v, t, p):
    return p[0] * x * x * x


@njit(FORCE_SIGNATURE, cache=True)
def _coulomb_friction(x, v, t, p):
    # Rounded below a twentieth of the rms speed, where the fixed step would chatter.
    return p[0] * v / np.sqrt(v * v + 0.0025)


@njit(FORCE_SIGNATURE, cache=True)
def _quadratic_damping(x, v, t, p):
    return p[0] * v * abs(v)


@njit(FORCE_SIGNATURE, cache=True)
def _cubic_damping(x, v, t, p):
    return p[0] * v * v * v


@njit(FORCE_SIGNATURE, cache=True)
def _drift(x, v, t, p):
    return t * (p[0] * x + p[1])


def _input_nonlinearity(drive: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    acting: NDArray[np.float64] = drive * (1.0 + p[0] * drive + p[1] * drive * drive)
    return acting


def _output_compression(
    x: NDArray[np.float64],
    p: NDArray[np.float64],
    angle: float,
) -> NDArray[np.float64]:
    sensed: NDArray[np.float64] = x / np.sqrt(1.0 + p[0] * x * x)
    return sensed


_TAPER = 32


def _filtered(
    x: NDArray[np.float64], transfer: Callable[[NDArray[np.float64]], NDArray[np.complex128]]
) -> NDArray[np.float64]:
    """Apply a transfer function of the angle a sample; both ends fade, so that none wraps round."""
    padded = np.concatenate((x, np.full(_TAPER, x[-1])))
    fade = 0.5 + 0.5 * np.cos(np.pi * np.arange(_TAPER) / _TAPER)
    level = float(np.mean(x))
    padded -= level
    padded[-_TAPER:] *= fade
    padded[:_TAPER] *= fade[::-1]
    size = fft.next_fast_len(len(padded), real=True)
    angle = 2.0 * np.pi * fft.rfftfreq(size)
    result: NDArray[np.float64] = fft.irfft(fft.rfft(padded, size) * transfer(angle), size)
    return result[: len(x)] + level


def _delay(x: NDArray[np.float64], p: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    return _filtered(x, lambda w: np.exp(-1j * w * p[0] / angle))


def _sensor_pole(
    x: NDArray[np.float64], p: NDArray[np.float64], angle: float
) -> NDArray[np.float64]:
    return _filtered(x, lambda w: 1.0 / (1.0 + 1j * w * p[0] / angle))


LIBRARY: tuple[Term, ...] = (
    Term(
        "quadratic_stiffness",
        "a spring stiffer to one side than to the other",
        (-0.5,),
        (0.5,),
        _quadratic_stiffness,
    ),
    Term(
        "cubic_stiffness",
        "a spring that hardens or softens with deflection",
        (-0.1,),
        (1.0,),
        _cubic_stiffness,
    ),
    Term(
        "coulomb_friction",
        "dry friction",
        (0.0,),
        (0.5,),
        _coulomb_friction,
        spoils_quiet=True,
    ),
    Term(
        "quadratic_damping",
        "a resistance that grows with the square of speed",
        (-0.1,),
        (1.0,),
        _quadratic_damping,
    ),
    Term(
        "cubic_damping",
        "a resistance that grows with the cube of speed",
        (-0.02,),
        (1.0,),
        _cubic_damping,
    ),
    Term("drift", "stiffness and zero change with time", (-0.8, -2.0), (0.8, 2.0), _drift),
    Term("delay", "the response is recorded late", (0.0,), (2.0,), sensed=_delay),
    Term(
        "output_compression",
        "the sensor saturates",
        (0.0,),
        (1.0,),
        sensed=_output_compression,
    ),
    Term(
        "input_nonlinearity",
        "the drive acts out of proportion",
        (-0.3, -0.1),
        (0.3, 0.3),
        driven=_input_nonlinearity,
    ),
    Term(
        "sensor_pole",
        "the sensor lags as a first-order filter",
        (0.0,),
        (2.0,),
        sensed=_sensor_pole,
    ),
)
"""All terms, rivals of each other."""
