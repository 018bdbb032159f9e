"""``bushing-noise materials``: list the shipped materials with their parameters."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from noise.commands.options import Option

if TYPE_CHECKING:
    from models.rig import Fit


OPTIONS = (Option("names NAME", str, count="*"),)


def run(options: Namespace) -> int:
    """Print the materials."""
    from models.rig_file import material_names

    print("\n\n".join(material_text(name) for name in options.names or material_names()))
    return 0


def material_text(name: str) -> str:
    """Return a description of a material, in several lines.

    Raises
    ------
    ParameterError
        There is no such material.

    Examples
    --------
    >>> print(material_text("fluorocarbon-thesis"))
    fluorocarbon-thesis
      friction law: coulomb
      ...
    """
    from models.rig_file import load_material_rig

    rig = load_material_rig(name)
    lines = [rig.material or name, f"  friction law: {rig.friction.name}"]
    lines += [f"  effect: {one.name}" for one in rig.effects]
    lines += [f"  fit {fit_text(fit)}" for fit in rig.fits]
    return "\n".join([*lines, *(f"  not measured: {one}" for one in rig.assumed)])


def fit_text(fit: Fit) -> str:
    """Return a description of an interference fit, in one line.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> fit_text(load_material_rig("fluorocarbon-thesis").fits[1])
    '0.279 mm: stiffness 665 Nm/rad, critical torque 10.7 Nm, kinetic torque 8 Nm'
    """
    return (
        f"{1e3 * fit.interference:g} mm: stiffness {fit.elastomer_stiffness:g} Nm/rad, "
        f"critical torque {fit.critical_torque:g} Nm, kinetic torque {fit.kinetic_torque:g} Nm"
    )
