"""What the contact solver works on, and what it carries on from step to step and block to block."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "ANGLE", "DONE", "ERROR", "FAR", "FIRST", "FRESH", "MODE", "NEXT_MODE",
    "N_CARRIED", "N_LAG", "N_MOTION", "N_STAGES", "SHORTEST_STEP", "SLIDE", "STEP_END",
    "STEP_OF_SLIP", "STEP_OF_STICK", "STEP_START", "STICK_LENGTH", "STICK_START", "Bushing",
    "Drive", "Hooks", "Limits", "Rows", "empty_rows",
]  # fmt: skip

SHORTEST_STEP = 1e-7
"""Average over a run, below which it is given up [s]."""

MODE = 0
"""+1 or -1 while it slides, 0 in stick and with a law."""
SLIDE = 1
"""Sign of the sliding speed with a law, 0 while that is not known."""
STICK_START = 2
"""When the last stick began [s]."""
STICK_LENGTH = 3
"""Of the last stick [s]."""
ANGLE = 4
"""Of the drive at the next sample [rad]."""
FIRST = 5
"""The next sample."""
STEP_START = 6
"""Of the last step, since the next sample [s]."""
STEP_END = 7
"""[s]"""
STEP_OF_STICK = 8
"""The next step as the error allows it, in stick [s]."""
STEP_OF_SLIP = 9
"""[s]"""
FRESH = 10
"""Whether the rates at the end of the last step are to be computed anew."""
DONE = 11
"""Steps since the start; negative where they became too many."""
FAR = 12
"""From the end of stick or slip, at the end of the last step."""
NEXT_MODE = 13
"""After the last step."""
ERROR = 14
"""Of the last step, over the tolerance."""
N_CARRIED = 15

N_STAGES = 7
"""Of a step of `sim.solvers.tsitouras`."""

N_MOTION = 4
"""First of the variables, theta1, theta1', theta2, theta2'."""

N_LAG = 2
"""Last of the variables where effects act: angle and speed by which the shaft's end lags."""


class Bushing(NamedTuple):
    """The lumped model and its friction, as compiled code reads them."""

    system: NDArray[np.float64]
    """J_E, J_C, k_E, k_B, c_E, c_B, the inertias' reciprocals, T_crit, T_kin."""
    law: int
    """Address of the friction law's compiled function; 0 where the contact truly sticks."""
    coefficients: NDArray[np.float64]
    """Of the law."""
    context: NDArray[np.float64]
    """What effects read, by `sim.contact`."""
    contact: NDArray[np.float64]
    """What effects change and laws read, by `sim.contact`."""


class Hooks(NamedTuple):
    """What the effects' compiled functions are called with."""

    n: int
    """Of effects that act."""
    addresses: NDArray[np.int64]
    """Of function, values, states and their rates of each effect, shape (n, 4).
    Numbers instead of arrays, since each array would be seven arguments to compile and to pass."""


class Drive(NamedTuple):
    """The shaft's drive at the samples, linear between them, as far as it is known."""

    step: float
    """From sample to sample [s]."""
    speed: NDArray[np.float64]
    """[rad/s]"""
    slope: NDArray[np.float64]
    """After each sample [rad/s2]; the last goes on beyond them."""
    angle: NDArray[np.float64]
    """[rad]"""


class Rows(NamedTuple):
    """States of all variables, or their rates, and room for them."""

    stages: NDArray[np.float64]
    """Rates of each variable at the stages of the last step, then those at an output."""
    weights: NDArray[np.float64]
    """Of the stages."""
    start: NDArray[np.float64]
    """State where the last step began."""
    end: NDArray[np.float64]
    """State where it ended."""
    state: NDArray[np.float64]
    """At one instant."""
    rates: NDArray[np.float64]
    """At that instant, of what laws and effects fill."""
    inner: NDArray[np.float64]
    """Those of the state after the motion: the law's, then the effects', then the lag."""
    inner_rates: NDArray[np.float64]


class Limits(NamedTuple):
    """Of steps."""

    longest: float
    """[s]"""
    tolerance: float
    """Error of a step over its scale."""


def empty_rows(n: int) -> Rows:
    """Return rows of `n` variables, all zero.

    Examples
    --------
    >>> empty_rows(7).inner.shape
    (3,)
    """
    start, end, state, rates = np.zeros((4, n))
    return Rows(
        np.zeros((n, N_STAGES + 1)), np.zeros(N_STAGES), start, end, state, rates,
        state[N_MOTION:], rates[N_MOTION:],
    )  # fmt: skip
