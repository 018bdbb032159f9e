"""Lumped model at many conditions at once: `sim.bushing.lumped_bushing` over arrays.

A sweep of the plain model takes a few microseconds a run, and building its numbers one by one
takes longer. Between the given fits everything is linear in the interference, and at each of them
the damping is linear in the compliance of the support between its entries, so both are one
interpolation over arrays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from models.rig import Rig

__all__ = ["packed_systems"]


def packed_systems(
    rig: Rig, interference: NDArray[np.float64], support_stiffness: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Numbers of the lumped model and its friction torques.

    Parameters
    ----------
    rig : Rig
    interference, support_stiffness : ndarray, shape (n,)
        [m] and [Nm/rad]; infinite stiffness is the clamp bolted to the baseplate.

    Returns
    -------
    ndarray, shape (n, 8)
        Rows as from `LumpedBushing.packed`, with T_crit and T_kin [Nm] after them.

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
    bad = np.flatnonzero(~(support_stiffness > 0.0))
    if bad.size:
        raise ParameterError(
            f"support stiffness = {support_stiffness[bad[0]]:g} Nm/rad must be positive, or 'fixed'"
        )
    compliance = 1.0 / support_stiffness
    at_fits = np.stack(
        [
            np.stack(
                np.broadcast_arrays(
                    fit.elastomer_stiffness,
                    fit.critical_torque,
                    fit.kinetic_torque,
                    _damping(fit.damping, compliance),
                )
            )
            for fit in rig.fits
        ]
    )  # shape (n_fits, 4, n)
    given = np.array([fit.interference for fit in rig.fits])
    held = np.clip(interference, given[0], given[-1])
    right = np.clip(np.searchsorted(given, held), 1, max(1, given.size - 1))
    if given.size == 1:
        k_e, critical, kinetic, damping = at_fits[0]
    else:
        share = (held - given[right - 1]) / (given[right] - given[right - 1])
        low, high = (
            np.take_along_axis(at_fits, index[None, None, :], 0)[0] for index in (right - 1, right)
        )
        k_e, critical, kinetic, damping = low + share * (high - low)
    systems = np.empty((interference.size, 8))
    systems[:, 0], systems[:, 1] = rig.elastomer_inertia, rig.clamp_inertia
    systems[:, 2] = k_e
    systems[:, 3] = np.where(np.isinf(support_stiffness), -1.0, support_stiffness)
    systems[:, 4] = rig.elastomer_damping_share * damping
    systems[:, 5] = (1.0 - rig.elastomer_damping_share) * damping
    systems[:, 6], systems[:, 7] = critical, kinetic
    return systems


def _damping(
    by_support: Mapping[float, float], compliance: NDArray[np.float64]
) -> NDArray[np.float64]:
    given = sorted((1.0 / stiffness, damping) for stiffness, damping in by_support.items())
    x, y = np.array(given).T
    return np.asarray(np.interp(compliance, x, y))
