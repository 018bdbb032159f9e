"""Contact pressure by Lame (Recommendation 2) against torques and stiffness (5.2.1, Table 5.3).

With one coefficient of friction the torque goes with the pressure, which is linear in the
interference, whatever size and modulus of the sleeve are assumed; its torsional stiffness does not
depend on the interference at all. The sleeve's wall and hardness are chosen for the stiffness at
0.279 mm.
"""

from __future__ import annotations

from collections.abc import Iterator

from models.bushing import Sleeve
from noise.thesis.row import Row, number
from noise.thesis.runs import THESIS, rig_of

_MIDDLE = 0.279
"""Interference to which others are compared [mm]."""


def torques() -> Iterator[Row]:
    """Mean torque over that at 0.279 mm, by the ratio of the pressures."""
    sleeve = _sleeve()
    middle = sleeve.pressure(1e-3 * _MIDDLE)
    for interference, ratio, text in (
        (0.178, 0.5, "0.5 (doubles from there)"), (0.381, 3.0, "3 (several times)"),
    ):  # fmt: skip
        yield Row(
            "pressure_ratio", f"{interference:g} over {_MIDDLE:g} mm, Lame, as mean torque", "1",
            number(ratio, text), exact=sleeve.pressure(1e-3 * interference) / middle,
            measured=True, tolerance=0.1, digits=3, counted=False,
        )  # fmt: skip


def stiffness() -> Iterator[Row]:
    """Torsional stiffness of the sleeve that the pressure is of."""
    for interference, measured in ((_MIDDLE, 665.0), (0.381, 1011.0)):
        yield Row(
            "elastomer_stiffness", f"{interference:g} mm, sleeve of 4.5 mm, 75 Shore A", "Nm/rad",
            number(measured), exact=_sleeve().torsional_stiffness, measured=True, tolerance=0.1,
            digits=3, in_sample=interference == _MIDDLE, counted=False,
        )  # fmt: skip


def _sleeve() -> Sleeve:
    sleeve = rig_of(THESIS).sleeve
    assert sleeve is not None  # the shipped bench states it
    return sleeve
