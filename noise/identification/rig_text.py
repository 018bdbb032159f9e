"""The rig file that an identification writes."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from models.rig import Rig

__all__ = ["rig_text"]


def rig_text(rig: Rig, notes: Sequence[str] = ()) -> str:
    """Write a rig's bushing and friction as a rig file; the rest is the shipped bench's.

    Parameters
    ----------
    rig : Rig
    notes : sequence of str
        Lines of comment at the top.

    Returns
    -------
    str

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> print(rig_text(load_material_rig("fluorocarbon-thesis")).splitlines()[0])
    name = "bench"
    """
    lines = [f"# {note}" for note in notes]
    lines += [
        f"name = {json.dumps(rig.name)}",
        f"material = {json.dumps(rig.material)}",
        f"elastomer_inertia_kgm2 = {rig.elastomer_inertia:.5g}",
        f"clamp_inertia_kgm2 = {rig.clamp_inertia:.5g}",
        f"elastomer_damping_share = {rig.elastomer_damping_share:.4g}",
        f"effects = {json.dumps([str(effect) for effect in rig.effects])}",
        f"assumed = {json.dumps(list(rig.assumed))}",
        "",
        "[friction]",
        f"law = {json.dumps(rig.friction.name)}",
        *(f"{name} = {value:.5g}" for name, value in rig.friction.parameters.items()),
    ]
    for fit in rig.fits:
        lines += [
            "",
            "[[fit]]",
            f"interference_mm = {1e3 * fit.interference:.6g}",
            f"elastomer_stiffness_Nm_rad = {fit.elastomer_stiffness:.5g}",
            f"critical_torque_Nm = {fit.critical_torque:.5g}",
            f"kinetic_torque_Nm = {fit.kinetic_torque:.5g}",
            f"damping_Nms_rad = {_by_support(fit.damping)}",
        ]
    return "\n".join(lines) + "\n"


def _by_support(damping: Mapping[float, float]) -> str:
    def name(support: float) -> str:
        return "fixed" if math.isinf(support) else f'"{support:.6g}"'

    inside = ", ".join(f"{name(support)} = {value:.5g}" for support, value in damping.items())
    return f"{{ {inside} }}"
