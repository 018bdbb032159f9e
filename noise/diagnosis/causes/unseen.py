"""Causes that the recorded channels cannot show, whatever stands in those that were recorded."""

from __future__ import annotations

from collections.abc import Collection

from sim.effects import EFFECTS
from sim.effects.effect import Stage

_SHOWN_BY = {
    Stage.STRUCTURE: {"acceleration", "pressure"},
    Stage.RADIATION: {"pressure"},
}
"""Channels of which one is needed; all others show the other stages."""


def unseen_causes(kinds: Collection[str]) -> frozenset[str]:
    """Name the effects that none of the recorded channels can show.

    Parameters
    ----------
    kinds : collection of str
        Of the channels that were recorded.

    Returns
    -------
    frozenset of str

    Examples
    --------
    >>> sorted(unseen_causes({"torque", "acceleration"}))
    ['plate_modes', 'room_reflections']
    >>> unseen_causes({"torque", "acceleration", "pressure"})
    frozenset()
    """
    return frozenset(
        name
        for name, effect in EFFECTS.items()
        if (needed := _SHOWN_BY.get(effect.stage)) is not None and not needed & set(kinds)
    )


def channel_costs(kinds: Collection[str]) -> list[str]:
    """Say what the channels that were not recorded cost, one line each.

    Parameters
    ----------
    kinds : collection of str
        Of the channels that were recorded.

    Examples
    --------
    >>> channel_costs({"torque", "pressure", "angle"})
    ['no acceleration: structure and radiation cannot be told apart']
    """
    missing = {"torque", "acceleration", "pressure", "angle"} - set(kinds)
    found = []
    if "torque" in missing:
        heard = " and ".join(
            word for kind, word in (("acceleration", "acceleration"), ("pressure", "sound"))
            if kind not in missing
        )  # fmt: skip
        found.append(
            f"no torque: drive, contact and structure cannot be told apart by {heard} alone"
        )
    unseen = ", ".join(sorted(name.replace("_", " ") for name in unseen_causes(kinds)))
    if {"acceleration", "pressure"} <= missing:
        found.append(f"no acceleration and no sound: nothing is said of {unseen}")
    elif "acceleration" in missing:
        found.append("no acceleration: structure and radiation cannot be told apart")
    elif "pressure" in missing:
        found.append(f"no sound: nothing is said of {unseen}")
    if "angle" in missing:
        found.append(
            "no shaft angle: the shaft is taken to turn evenly at the speed that was set, and an "
            "uneven drive is told by what else it changes"
        )
    return found
