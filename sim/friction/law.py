"""The small interface behind which every friction law stands.

A law is one file with one `FrictionLaw` named ``LAW``. Sliding speed is that of the shaft over
the bushing's surface, v = shaft speed - interface speed; the torque acts on the bushing along v.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numba import float64, types

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from models.rig import Fit
    from sim.parameters import Parameter

__all__ = ["RATES_SIGNATURE", "FrictionLaw"]

RATES_SIGNATURE = float64(float64, float64[::1], float64[::1], float64[::1])
"""``torque = rates(sliding_speed, state, coefficients, state_rates)``; fills `state_rates`.

Laws are compiled for this signature, so that one compiled integrator serves them all.
"""


@dataclass(frozen=True)
class FrictionLaw:
    """A friction law: its parameters and what the solvers need of it.

    Parameters
    ----------
    name : str
    parameters : mapping of str to Parameter
        What a material file may set.
    coefficients : callable
        ``coefficients(fit, values)`` packs the numbers that `rates` reads, from the bushing's
        properties at a fit and the resolved parameters.
    initial_state : callable, optional
        ``initial_state(coefficients)``: the contact's inner state after a long rest.
    rates : compiled function, optional
        Torque [Nm] and rates of the inner state, by `RATES_SIGNATURE`. ``None`` for the law with
        true stick and constant torques, whose motion is solved in closed form.
    """

    name: str
    parameters: Mapping[str, Parameter]
    coefficients: Callable[[Fit, Mapping[str, float]], NDArray[np.float64]]
    initial_state: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
    rates: Any = None


FUNCTION_TYPE = types.FunctionType(RATES_SIGNATURE)
