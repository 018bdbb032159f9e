"""Lumped two-degree-of-freedom model of a bushing at one operating condition (Figure 4.1).

J_E theta1'' = T - T_E, J_C theta2'' = T_E - k_B theta2 - c_B theta2', with the torque of the
elastomer T_E = k_E (theta1 - theta2) + c (theta1' - theta2'). The thesis splits the measured
damping c_E evenly between elastomer and beams (4.1); `Rig.elastomer_damping_share` sets the split.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Rig, damping_at


@dataclass(frozen=True)
class LumpedBushing:
    """Inertia, stiffness and damping of the lumped model.

    Parameters
    ----------
    elastomer_inertia, clamp_inertia : float
        J_E, J_C [kg m2].
    elastomer_stiffness, support_stiffness : float
        k_E, k_B [Nm/rad]; an infinite k_B is the clamp bolted to the baseplate.
    elastomer_damping, support_damping : float
        [Nm s/rad]
    """

    elastomer_inertia: float
    clamp_inertia: float
    elastomer_stiffness: float
    support_stiffness: float
    elastomer_damping: float
    support_damping: float

    @property
    def clamp_is_fixed(self) -> bool:
        """Whether the clamp is bolted to the baseplate."""
        return math.isinf(self.support_stiffness)

    def packed(self) -> NDArray[np.float64]:
        """Return the parameters for compiled code, shape (6,) [SI]; a fixed clamp has k_B = -1."""
        support = -1.0 if self.clamp_is_fixed else self.support_stiffness
        return np.array(
            [
                self.elastomer_inertia,
                self.clamp_inertia,
                self.elastomer_stiffness,
                support,
                self.elastomer_damping,
                self.support_damping,
            ]
        )

    def natural_frequencies(self, *, stuck: bool = False) -> NDArray[np.float64]:
        """Return the undamped natural frequencies in rising order [Hz], shape (0,), (1,) or (2,).

        With `stuck`, the bushing's surface is held by the shaft.

        Examples
        --------
        >>> rig = LumpedBushing(1 / 65000, 1 / 1200, 665.0, 2214.0, 0.0, 0.0)
        >>> rig.natural_frequencies().round(1), rig.natural_frequencies(stuck=True).round(1)
        (array([ 256.9, 1056.6]), array([295.8]))
        """
        k_e, k_b = self.elastomer_stiffness, self.support_stiffness
        j_e, j_c = self.elastomer_inertia, self.clamp_inertia
        if self.clamp_is_fixed:
            squares = [] if stuck else [k_e / j_e]
        elif stuck:
            squares = [(k_e + k_b) / j_c]
        else:
            mean = 0.5 * (k_e / j_e + (k_e + k_b) / j_c)
            root = math.sqrt(mean**2 - k_e * k_b / (j_e * j_c))
            squares = [mean - root, mean + root]
        return np.asarray(np.sqrt(np.array(squares)) / (2.0 * math.pi))


def lumped_bushing(rig: Rig, interference: float, support_stiffness: float) -> LumpedBushing:
    """Return the lumped model of a rig at one condition.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.

    Returns
    -------
    LumpedBushing

    Raises
    ------
    ParameterError
        If the support stiffness is not positive.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> lumped_bushing(load_material_rig("PDMS"), 0.279e-3, math.inf).clamp_is_fixed
    True
    """
    if not support_stiffness > 0.0:
        raise ParameterError(
            f"support stiffness = {support_stiffness:g} Nm/rad must be positive, or 'fixed'"
        )
    fit = rig.fit(interference)
    damping = damping_at(fit, support_stiffness)
    share = rig.elastomer_damping_share
    return LumpedBushing(
        elastomer_inertia=rig.elastomer_inertia,
        clamp_inertia=rig.clamp_inertia,
        elastomer_stiffness=fit.elastomer_stiffness,
        support_stiffness=support_stiffness,
        elastomer_damping=share * damping,
        support_damping=(1.0 - share) * damping,
    )


def packed_systems(
    rig: Rig, interference: NDArray[np.float64], support_stiffness: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the lumped models and friction torques of a rig at many conditions.

    Parameters
    ----------
    rig : Rig
    interference, support_stiffness : ndarray, shape (n,)
        [m] and [Nm/rad]; infinite stiffness is the clamp bolted to the baseplate.

    Returns
    -------
    ndarray, shape (n, 8)
        Rows of `LumpedBushing.packed`, followed by T_crit and T_kin [Nm].

    Raises
    ------
    ParameterError
        If a support stiffness is not positive.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> packed_systems(rig, np.array([0.279e-3]), np.array([np.inf]))[0, 2:].tolist()
    [665.0, -1.0, 0.0425, 0.0425, 10.7, 8.0]
    """

    def row(at: tuple[float, float]) -> list[float]:
        fit = rig.fit(at[0])
        return [*lumped_bushing(rig, *at).packed(), fit.critical_torque, fit.kinetic_torque]

    pairs = [*zip(interference.tolist(), support_stiffness.tolist(), strict=True)]
    rows = {pair: row(pair) for pair in set(pairs)}
    return np.array([rows[pair] for pair in pairs]).reshape(-1, 8)
