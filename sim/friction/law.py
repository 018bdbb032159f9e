"""Interface of a friction law.

A law is one file with one `FrictionLaw` named ``LAW``. The sliding speed is that of the shaft over
the bushing's surface, v = shaft speed - interface speed; the torque acts on the bushing along v.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sim.parameters import Parameter as Parameter

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class FrictionLaw:
    """Friction law: its name, parameters, torque function and solver tolerance.

    Parameters
    ----------
    name : str
    parameters : mapping of str to Parameter
        Parameters that a rig file may set.
    torque : compiled function, optional
        ``torque(sliding_speed, coefficients, contact, state, state_rates)`` by
        `sim.contact.LAW_SIGNATURE`: returns the torque [Nm] and fills the rates of the inner state.
        Coefficients are the parameters' values in order; the torques of the fit are in the contact,
        changed by effects. ``None`` for the law with true stick, where the solver computes the
        holding torque.
    rest : tuple of float
        Inner state of the contact after a long rest [rad or s, by the law]; by default none.
    tolerance : float
        Relative error of a solver step in twist, speed and inner state [-]. The default suits the
        most chaotic laws; where neighbouring motions diverge slowly, a larger one is as good.
    """

    name: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    torque: Any = None
    rest: tuple[float, ...] = ()
    tolerance: float = 1e-8

    def coefficients(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Return the coefficients of `torque` for parameter values, shape (n,), units by law."""
        import numpy as np

        return np.array(list(values.values()) or [0.0])

    def state(self) -> NDArray[np.float64]:
        """Return the inner state after a long rest, shape (n_states,), units by law."""
        import numpy as np

        return np.array(self.rest, dtype=np.float64)
