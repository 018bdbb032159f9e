"""Scatter of a rig from run to run.

A bushing is pressed in again, warms by a few kelvin, wears: between two runs of one condition its
stiffness, torques and damping come out a few per cent apart, and nobody's fault.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from models.condition import KnownCondition
from models.rig import Fit, Rig


@dataclass(frozen=True)
class Scatter:
    """Relative standard deviations from run to run.

    Parameters
    ----------
    bushing : float
        Of the elastomer's stiffness, damping and inertia, the kinetic torque, and what the
        critical torque exceeds it by, each on its own; assumed [-].
    structure : float
        Of the clamp's inertia, the support's stiffness and the speed; assumed [-].
    gain : float
        Of the sensors' sensitivities; assumed [-].
    noise : float
        Of the sensors' noise, where it is known; assumed [-].
    """

    bushing: float = 0.02
    structure: float = 0.004
    gain: float = 0.01
    noise: float = 0.1

    def structure_factor(self, rng: np.random.Generator) -> float:
        """Draw by what a value of the structure differs in one run [-]."""
        return float(np.exp(self.structure * rng.normal()))


def perturb_run(
    rig: Rig,
    condition: KnownCondition,
    scatter: Scatter,
    rng: np.random.Generator,
    *,
    support: bool = False,
) -> tuple[Rig, KnownCondition]:
    """Draw a rig and its condition as one of its runs finds them.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    scatter : Scatter
    rng : numpy.random.Generator
    support : bool
        Whether the support's stiffness scatters as well, where the clamp is not bolted down.

    Returns
    -------
    Rig, KnownCondition

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.rig_file import load_material_rig
    >>> rig, at = load_material_rig("PDMS"), KnownCondition(5.0, 0.279e-3, 2214.0)
    >>> once = perturb_run(rig, at, Scatter(), np.random.default_rng(1))[1]
    >>> once.speed != 5.0, once.support_stiffness
    (True, 2214.0)
    """
    stiffness = condition.support_stiffness
    if support and not math.isinf(stiffness):
        stiffness *= scatter.structure_factor(rng)
    once = perturb_rig(rig, scatter, rng)
    speed = condition.speed * scatter.structure_factor(rng)
    return once, replace(condition, speed=speed, support_stiffness=stiffness)


def perturb_rig(rig: Rig, scatter: Scatter, rng: np.random.Generator) -> Rig:
    """Draw a rig as one of its runs finds it.

    Parameters
    ----------
    rig : Rig
    scatter : Scatter
    rng : numpy.random.Generator

    Returns
    -------
    Rig

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> once = perturb_rig(rig, Scatter(), np.random.default_rng(1))
    >>> 0.9 < once.elastomer_inertia / rig.elastomer_inertia < 1.1
    True
    """
    stiffness, kinetic, drop, damping, inertia = np.exp(scatter.bushing * rng.standard_normal(5))
    # the support's stiffness scatters too; what counts is the clamp's frequency, hence the root
    clamp = float(np.exp(math.sqrt(2.0) * scatter.structure * rng.standard_normal()))

    def drawn(fit: Fit) -> Fit:
        sliding = fit.kinetic_torque * float(kinetic)
        excess = (fit.critical_torque - fit.kinetic_torque) * float(drop)
        return replace(
            fit,
            elastomer_stiffness=fit.elastomer_stiffness * float(stiffness),
            kinetic_torque=sliding,
            critical_torque=sliding + excess,
            damping={support: c * float(damping) for support, c in fit.damping.items()},
        )

    return replace(
        rig,
        fits=tuple(drawn(fit) for fit in rig.fits),
        elastomer_inertia=rig.elastomer_inertia * float(inertia),
        clamp_inertia=rig.clamp_inertia * clamp,
    )
