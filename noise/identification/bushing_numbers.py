"""Numbers of the bushing from all recordings together, each with its 90 % interval."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from noise.identification.outcome import Number
from noise.identification.pooled import pool

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from noise.identification.outcome import Seen

__all__ = ["bushing_numbers"]

Place = tuple[float | None, float | None]
"""Interference [m] and support stiffness [Nm/rad] that a number belongs to, None for all."""

_TORQUE_ERROR = 2e-3
"""Relative standard error of a level within a recording, read off hundreds of cycles [-]."""

_USUAL = {"elastomer_stiffness": 0.02, "damping": 0.04, "torque": 0.02, "inertia": 0.02}
"""Relative scatter from recording to recording that is expected [-]."""

_OF_THE_LAW = {
    True: {"elastomer_stiffness": 0.006, "damping": 0.03, "torque": 0.008, "inertia": 0.02},
    False: {"elastomer_stiffness": 0.04, "damping": 0.25, "torque": 0.02, "inertia": 0.04},
}
"""Relative standard error that all recordings share, from the law that was assumed, by whether it
truly sticks [-]; from six development rigs of `tests.blind.identify`, seed 1."""


def bushing_numbers(seen: Sequence[Seen], *, sticks: bool = True) -> list[Number]:
    """Pool what single recordings said.

    Parameters
    ----------
    seen : sequence of Seen
    sticks : bool
        Whether the law that was found truly sticks.

    Returns
    -------
    list of Number
        Stiffness and torques by interference, damping by interference and support, inertias.
    """
    slipping = [one for one in seen if one.levels.slips]
    kinds = (
        ("elastomer_stiffness", "Nm/rad", "elastomer_stiffness", _fit_of),
        ("critical_torque", "Nm", "torque", _fit_of),
        ("kinetic_torque", "Nm", "torque", _fit_of),
        ("damping", "Nm s/rad", "damping", _cell_of),
        ("elastomer_inertia", "kg m2", "inertia", _anywhere),
        ("clamp_inertia", "kg m2", "inertia", _anywhere),
    )
    return [
        number
        for name, unit, kind, place in kinds
        for number in _numbers(slipping, name, unit, kind, place, sticks)
    ]


def _anywhere(_: Seen) -> Place:
    return None, None


def _fit_of(one: Seen) -> Place:
    return one.measured.condition.interference, None


def _cell_of(one: Seen) -> Place:
    return one.measured.condition.interference, one.measured.condition.support_stiffness


def _numbers(
    seen: Sequence[Seen], name: str, unit: str, kind: str, place: Callable[[Seen], Place],
    sticks: bool,
) -> list[Number]:  # fmt: skip  # fmt: skip
    groups: dict[Place, list[tuple[float, float]]] = defaultdict(list)
    for one in seen:
        groups[place(one)].append((one.values[name], one.fit.errors.get(name, _TORQUE_ERROR)))
    pooled = pool(groups, usual=_USUAL[kind], shared=_OF_THE_LAW[sticks][kind])
    return [
        Number(name, unit, p.value, p.low, p.high, p.n, *at)
        for at, p in sorted(pooled.items(), key=lambda item: (item[0][0] or 0.0, item[0][1] or 0.0))
    ]
