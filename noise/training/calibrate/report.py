"""Report of a calibration as a page of text, and the material file that it makes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from models.condition import FIXED
from models.rig import Rig
from noise.identification.table_fit import TableNumber, TableScore
from noise.noise_definition import label_by_physics
from noise.training.calibrate.thesis_table import CELLS, NOISES, THIN_CELLS
from noise.training.calibrate.unknowns import UNKNOWNS
from sim.analysis.critical_speeds import critical_speeds
from sim.run import simulate

_SPEEDS = tuple(0.25 * i for i in range(1, 65))
"""To 16 rad/s, so that an end beyond the measured 12.5 is found."""


def measured_speeds(
    rig: Rig, cells: Sequence[TableNumber] = CELLS + THIN_CELLS
) -> dict[TableNumber, float]:
    """Critical speeds of a rig as `sim.analysis.critical_speeds` defines them [rad/s]."""
    speeds: dict[TableNumber, float] = {}
    for place in dict.fromkeys((cell.interference, cell.support_stiffness) for cell in cells):
        found = critical_speeds(rig, *place, _SPEEDS)
        speeds |= {
            cell: getattr(found, cell.item)
            for cell in cells
            if (cell.interference, cell.support_stiffness) == place
        }
    return speeds


def speeds_page(title: str, speeds: Mapping[TableNumber, float]) -> str:
    """Table of measured and simulated critical speeds, with their error.

    Examples
    --------
    >>> print(speeds_page("Fitted", {CELLS[0]: 4.0}))
    Fitted: log-rms error 0.118
      v_crit1 at 0.279 mm, 2214 Nm/rad      measured   4.50  simulated   4.00  log -0.118
    """
    lines = [f"{title}: log-rms error {TableScore(0.0, speeds).rms(speeds):.3f}"]
    lines += [
        f"  {cell!s:<37} measured {cell.value:6.2f}  simulated {speed:6.2f}  "
        f"log {cell.misfit(speed):+.3f}"
        for cell, speed in speeds.items()
    ]
    return "\n".join(lines)


def noises_page(rig: Rig) -> str:
    """Table of the noises that the thesis names, and those that the rig makes."""
    lines = ["Noises, not fitted as such (5.2.3)"]
    for cell in NOISES:
        run = simulate(
            rig, *cell.speeds,
            interference=cell.interference, support_stiffness=cell.support_stiffness,
        )  # fmt: skip
        lines.append(
            f"  {1e3 * cell.interference:.3f} mm, {cell.support_stiffness:.0f} Nm/rad, "
            f"{cell.speeds[0]:g} rad/s  named {cell.item:<7} simulated {label_by_physics(run)}"
        )
    return "\n".join(lines)


def values_page(values: Mapping[str, float]) -> str:
    """List what was found of the unknowns, each with its unit."""
    lines = ["Unknowns"]
    lines += [
        f"  {name:<25}{value:12.4g} {UNKNOWNS[name].unit:<9} {UNKNOWNS[name].description}"
        for name, value in values.items()
    ]
    return "\n".join(lines)


def material_toml(rig: Rig) -> str:
    """Write the tables of a material file that hold what was searched."""
    lines = [f"elastomer_damping_share = {rig.elastomer_damping_share:.4g}", "", "[friction]"]
    lines.append(f'law = "{rig.friction.name}"')
    lines += [f"{key} = {value:.4g}" for key, value in rig.friction.parameters.items()]
    for fit in rig.fits:
        lines += [
            "",
            "[[fit]]",
            f"interference_mm = {1e3 * fit.interference:.3f}",
            f"elastomer_stiffness_Nm_rad = {fit.elastomer_stiffness:g}",
            f"critical_torque_Nm = {fit.critical_torque:.4g}",
            f"kinetic_torque_Nm = {fit.kinetic_torque:.4g}",
            "damping_Nms_rad = { "
            + ", ".join(
                f'"{support:.0f}" = {value:.4g}' if support != FIXED else f"fixed = {value:.4g}"
                for support, value in fit.damping.items()
            )
            + " }",
        ]
    return "\n".join(lines) + "\n"
