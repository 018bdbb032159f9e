"""The rig that the numbers of an identification make."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from models.rig import Fit, LawSpec

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from models.rig import Rig
    from noise.identification.known import Beforehand
    from noise.identification.outcome import Number

__all__ = ["found_rig"]


def found_rig(
    beforehand: Beforehand, numbers: Sequence[Number], *, material: str,
    friction: LawSpec | None = None,
    torques: Mapping[float, tuple[float, float]] | None = None,
) -> Rig:  # fmt: skip
    """Put numbers into a rig.

    Parameters
    ----------
    beforehand : Beforehand
    numbers : sequence of Number
    material : str
    friction : LawSpec, optional
        By default Coulomb's.
    torques : mapping of float to (float, float), optional
        Critical and kinetic torque [Nm] by interference [m], as the law means them; by default
        the levels.

    Returns
    -------
    Rig
        With a fit for each interference, damping for each support that was recorded there.
    """
    single = {one.name: one.value for one in numbers if one.interference is None}
    fits = []
    for stiffness in (one for one in numbers if one.name == "elastomer_stiffness"):
        at = stiffness.interference
        assert at is not None  # it is by interference

        def level(name: str, at: float = at) -> float | None:
            named = (one for one in numbers if one.name == name and one.interference == at)
            return next((one.value for one in named), None)

        kinetic, critical = level("kinetic_torque"), level("critical_torque")
        if torques is not None and at in torques:
            critical, kinetic = torques[at]
        if kinetic is None or critical is None:
            continue
        damping = {
            one.support_stiffness: one.value
            for one in numbers
            if one.name == "damping"
            and one.interference == at
            and one.support_stiffness is not None
        }
        fits.append(Fit(at, stiffness.value, max(critical, kinetic), kinetic, damping))
    return replace(
        beforehand.rig,
        material=material,
        elastomer_inertia=single["elastomer_inertia"],
        clamp_inertia=single["clamp_inertia"],
        elastomer_damping_share=beforehand.known.damping_share,
        fits=tuple(fits),
        friction=friction or LawSpec("coulomb"),
        effects=(),
        assumed=(),
    )
