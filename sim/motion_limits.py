"""Motions that are refused: faster than any solver follows, or without bound."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.schema import remarks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from models.rig import Rig
    from sim.bushing import LumpedBushing

__all__ = ["blaming_the_unusual", "refuse_fast", "refuse_overflow"]

_FASTEST_SLIP = 60.0
"""Sliding speeds exceed the shaft's by about so much [rad/s]; the thesis has 45 (Figure 6.7)."""

_FASTEST_RATE = 3e7
"""That the solver of contacts follows in a bearable time [1/s]."""


@contextmanager
def blaming_the_unusual(rig: Rig) -> Iterator[None]:
    """Let a refusal begin with what of the rig lies outside the usual, most likely its cause.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> with blaming_the_unusual(load_material_rig("PDMS").changed(critical_torque="x1000")):
    ...     raise ParameterError("no step is short enough")
    Traceback (most recent call last):
    models.errors.ParameterError: critical_torque_Nm = 3000 is outside the usual ...
    """
    try:
        yield
    except ParameterError as error:
        unusual = "; ".join(remarks(rig))
        if not unusual:
            raise
        raise ParameterError(f"{unusual}; no motion can be computed: {error}") from None


def refuse_fast(
    system: LumpedBushing,
    rig: Rig,
    kinetic_torque: float,
    law: Mapping[str, float],
    top_speed: float,
) -> None:
    """Refuse what no bearable number of steps follows, by an estimate of the fastest rate.

    Parameters
    ----------
    system : LumpedBushing
    rig : Rig
    kinetic_torque : float
        [Nm]
    law : mapping of str to float
        Parameters of the friction law, as `sim.parameters.Parameter` declares their units.
    top_speed : float
        Of the shaft [rad/s].

    Raises
    ------
    ParameterError
        Some part of the motion is faster than the solver follows.
    """
    contact = law.get("contact_stiffness_per_torque", 0.0)
    damping = system.elastomer_damping
    damping += law.get("contact_damping_per_torque", 0.0) * kinetic_torque
    sliding = top_speed + _FASTEST_SLIP
    stiffness = contact * kinetic_torque + system.elastomer_stiffness
    renewal = law.get("renewal_angle", 0.0)
    renewal += law.get("renewal_angle_per_torque", 0.0) * kinetic_torque
    rates = [
        math.sqrt(stiffness / system.elastomer_inertia),
        damping / system.elastomer_inertia,
        contact * sliding,
        sliding / renewal if renewal else 0.0,
    ]
    if not system.clamp_is_fixed:
        stiffness = system.elastomer_stiffness + system.support_stiffness
        rates += [
            math.sqrt(stiffness / system.clamp_inertia),
            (damping + system.support_damping) / system.clamp_inertia,
        ]
    fastest = max(rates)
    if fastest > _FASTEST_RATE:
        raise ParameterError(
            f"{_what(system, rig, top_speed)}: some part moves {fastest:.3g} times a second, which "
            f"no step of this solver follows; make it softer, heavier or less damped"
        )


def refuse_overflow(
    states: NDArray[np.float64], system: LumpedBushing, rig: Rig, top_speed: float
) -> None:
    """Refuse a motion whose end is not finite.

    Parameters
    ----------
    states : ndarray, shape (n, n_states)
        Angles [rad] and speeds [rad/s].
    system : LumpedBushing
    rig : Rig
    top_speed : float
        Of the shaft [rad/s].

    Raises
    ------
    ParameterError
        The last of the states is not finite.
    """
    if not np.isfinite(states[-1]).all():
        raise ParameterError(f"{_what(system, rig, top_speed)}: the motion grows without bound")


def _what(system: LumpedBushing, rig: Rig, top_speed: float) -> str:
    return (
        f"with speeds up to {top_speed:g} rad/s, friction {rig.friction}, inertia "
        f"{system.elastomer_inertia:g} and {system.clamp_inertia:g} kg m2, stiffness "
        f"{system.elastomer_stiffness:g} and {system.support_stiffness:g} Nm/rad, damping "
        f"{system.elastomer_damping:g} and {system.support_damping:g} Nm s/rad"
    )
