"""Coulomb friction with true stick: the law of the thesis (Section 4.2).

While the surfaces stick, the torque is whatever holds them together, up to T_crit; while they
slide it is T_kin, whatever the speed. Only T_crit - T_kin matters for the vibration. A constant
kinetic torque sustains neither squawk nor squeal: it has no quasi-harmonic regime (6.3.1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.friction.law import FrictionLaw

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from models.rig import Fit

__all__ = ["LAW"]


def _coefficients(fit: Fit, values: Mapping[str, float]) -> NDArray[np.float64]:  # noqa: ARG001
    return np.array([fit.critical_torque, fit.kinetic_torque])


LAW = FrictionLaw(name="coulomb", parameters={}, coefficients=_coefficients)
