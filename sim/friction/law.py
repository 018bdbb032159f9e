"""The small interface behind which every friction law stands.

A law is one file with one `FrictionLaw` named ``LAW``. Sliding speed is that of the shaft over
the bushing's surface, v = shaft speed - interface speed; the torque acts on the bushing along v.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sim.parameters import Parameter as Parameter

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class FrictionLaw:
    """A friction law: its parameters and what the solver needs of it.

    Parameters
    ----------
    name : str
    parameters : mapping of str to Parameter
        What a material file may set.
    torque : compiled function, optional
        ``torque(sliding_speed, coefficients, contact, state, state_rates)`` by
        `sim.contact.LAW_SIGNATURE`: the torque [Nm], and the rates of the inner state. ``None``
        for the law with true stick, where the solver itself finds what holds.
    pack : callable, optional
        ``pack(values)``: the coefficients that `torque` reads; by default the parameters' values
        in their order. The torques of the fit are in the contact, as effects leave them.
    rest : tuple of float
        The contact's inner state after a long rest, as `torque` has it [rad or s, by the law]; by
        default there is none.
    reads_critical : bool
        Whether `torque` reads the critical torque.
    tolerance : float
        Error of a step of the solver, over twist, speed and inner state [-]. The default serves the
        most chaotic; where neighbouring motions part slowly, a larger one is as good and faster.
    master_speeds : tuple of str
        Parameters that are speeds of a master curve, which a temperature shifts; by default none,
        and it acts on the torques.
    """

    name: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    torque: Any = None
    pack: Callable[[Mapping[str, float]], NDArray[np.float64]] | None = None
    rest: tuple[float, ...] = ()
    reads_critical: bool = True
    tolerance: float = 1e-8
    master_speeds: tuple[str, ...] = ()

    def coefficients(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Numbers that `torque` reads, from resolved parameters, shape (n,), units by the law."""
        import numpy as np

        return np.array(list(values.values()) or [0.0]) if self.pack is None else self.pack(values)

    def state(self) -> NDArray[np.float64]:
        """Inner state after a long rest, shape (n_states,), units by the law."""
        import numpy as np

        return np.array(self.rest, dtype=np.float64)
