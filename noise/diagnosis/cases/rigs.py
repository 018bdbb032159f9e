"""Rigs as users have them, and the conditions that they record; drawn without knowing the cause."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import FIXED, KnownCondition
from models.rig import Fit, LawSpec, Rig
from models.rig_files.rig_file import load_material_rig

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["OFFSETS", "Setting", "draw_setting", "with_offsets"]

OFFSETS = (
    "elastomer_stiffness", "critical_torque", "kinetic_torque", "damping", "elastomer_inertia",
)  # fmt: skip
"""Parameters of the rig file that may be off in all recordings of a case."""

_FITS = {0.178e-3: (430.0, 5.35, 4.0), 0.279e-3: (665.0, 10.7, 8.0), 0.381e-3: (1011.0, 27.0, 20.0)}
"""Stiffness [Nm/rad], critical and kinetic torque [Nm] at each interference [m]: Table 4.1."""

_CREEPING = {0.178e-3: 3.0, 0.279e-3: 4.5, 0.381e-3: 8.0}
"""Speed up to which each fit sticks and slips [rad/s]; most recordings lie below it."""

_DAMPING = {2214.0: 0.105, 3745.0: 0.085, FIXED: 0.085}
"""Of each support [Nm s/rad]."""

_RATES = (25_600, 30_000, 32_000, 44_100, 48_000, 51_200)
_LENGTHS = (0.4, 0.5, 0.6, 0.8, 1.0)
_DESIGN_SPREAD = 0.08
"""Relative standard deviation of a rig's numbers from those of the thesis."""

_FASTEST = 10.0
_SLOWEST = 0.6


@dataclass(frozen=True)
class Setting:
    """A rig, and how it is recorded.

    Parameters
    ----------
    rig : Rig
        As its file has it.
    conditions : tuple of KnownCondition
        One a recording; two are there twice.
    rate, seconds : float
        [Hz], [s]
    """

    rig: Rig
    conditions: tuple[KnownCondition, ...]
    rate: float
    seconds: float


def draw_setting(rng: np.random.Generator) -> Setting:
    """Draw a rig about the thesis's, and four to nine recordings.

    Examples
    --------
    >>> setting = draw_setting(np.random.default_rng(0))
    >>> 4 <= len(setting.conditions) <= 9
    True
    """
    wide = np.exp(_DESIGN_SPREAD * rng.standard_normal(3 * len(_FITS) + len(_DAMPING)))
    damping = {support: c * float(wide[9 + i]) for i, (support, c) in enumerate(_DAMPING.items())}
    fits = []
    for i, (interference, (stiffness, critical, kinetic)) in enumerate(_FITS.items()):
        torque = float(wide[3 + i])
        fits.append(
            Fit(
                interference,
                stiffness * float(wide[i]),
                critical * torque,
                kinetic * torque,
                damping,
            )
        )
    shipped = load_material_rig("fluorocarbon-thesis")
    rig = replace(
        shipped,
        elastomer_inertia=float(wide[6]) / 65000.0,
        clamp_inertia=float(wide[7]) / 1200.0,
        fits=tuple(fits),
        friction=LawSpec("coulomb", {}),
        elastomer_damping_share=0.5,
        effects=(),
    )
    return Setting(rig, _conditions(rng), float(rng.choice(_RATES)), float(rng.choice(_LENGTHS)))


def with_offsets(rig: Rig, offsets: Mapping[str, float]) -> Rig:
    """Return a rig whose parameters differ by factors, in all its fits.

    Parameters
    ----------
    rig : Rig
    offsets : mapping of str to float
        Factors [-] by names of `OFFSETS`.
    """

    def factor(name: str) -> float:
        return offsets.get(name, 1.0)

    def changed(fit: Fit) -> Fit:
        kinetic = fit.kinetic_torque * factor("kinetic_torque")
        return replace(
            fit,
            elastomer_stiffness=fit.elastomer_stiffness * factor("elastomer_stiffness"),
            critical_torque=max(fit.critical_torque * factor("critical_torque"), kinetic),
            kinetic_torque=kinetic,
            damping={support: c * factor("damping") for support, c in fit.damping.items()},
        )

    return replace(
        rig,
        fits=tuple(changed(fit) for fit in rig.fits),
        elastomer_inertia=rig.elastomer_inertia * factor("elastomer_inertia"),
    )


def _conditions(rng: np.random.Generator) -> tuple[KnownCondition, ...]:
    different = int(rng.integers(2, 8))
    supports = rng.choice(list(_DAMPING), rng.integers(1, 3), replace=False).tolist()
    fits = rng.choice(list(_FITS), rng.integers(1, 4), replace=False).tolist()
    found: list[KnownCondition] = []
    while len(found) < different:
        fit = fits[int(rng.integers(len(fits)))]
        fastest = _CREEPING[fit] if rng.random() < 0.9 else _FASTEST
        speed = math.exp(rng.uniform(math.log(_SLOWEST), math.log(fastest)))
        condition = KnownCondition(
            speed=round(speed, 1),
            interference=fit,
            support_stiffness=supports[int(rng.integers(len(supports)))],
            material="fluorocarbon",
            temperature=23.0,
        )
        if condition not in found:
            found.append(condition)
    again = [found[i] for i in rng.choice(different, 2, replace=False)]
    return tuple(found + again)
