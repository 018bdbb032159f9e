"""Six friction laws of the second rig, in formulas of its own.

Three stick truly and run on the tables of `tests.blind.kernel`; three creep. The logarithm of rate
and state spans three decades, of which a cycle spans one: its drop is the larger.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import contact, kernel
from ..laws import Law, contact_of
from ..rig import turn

if TYPE_CHECKING:
    from ..rig import Setup, Turned

__all__ = ["LAWS", "Law", "draw_law", "turn_with"]

LAWS = ("constant", "stribeck", "rate_and_state", "memory", "bristle", "ageing")

_CREEPING = {
    "bristle": contact.BRISTLE, "rate_and_state": contact.RATE_AND_STATE, "memory": contact.MEMORY,
}  # fmt: skip
_SLIDING = np.linspace(0.0, kernel.LARGEST_SLIDING, kernel.POINTS)
_AGE = kernel.LOWEST_AGE * 10.0 ** (kernel.AGE_DECADES * np.linspace(0.0, 1.0, kernel.POINTS))


def draw_law(name: str, rng: np.random.Generator) -> Law:
    """Draw a law of a kind, about what makes rubber on steel squeal and stick."""

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    drawn = {
        "constant": dict,
        "stribeck": lambda: {"speed": between(1.0, 10.0)},
        "ageing": lambda: {"time": between(5e-4, 4e-3)},
        "bristle": lambda: {
            "stiffness": between(1200.0, 3000.0), "viscous": between(2e-5, 1e-4),
            "speed": between(1.0, 6.0),
        },
        "rate_and_state": lambda: {
            "stiffness": between(2500.0, 6000.0), "viscous": between(2e-5, 1e-4),
            "renewal": between(1e-4, 4e-4), "time": between(1e-5, 4e-5),
            "direct": between(0.001, 0.004),
        },
        "memory": lambda: {
            "stiffness": between(1000.0, 2500.0), "viscous": between(3e-5, 1e-4),
            "renewal": between(1.5e-4, 6e-4), "time": between(3e-4, 2e-3),
            "weakening": between(0.05, 0.2), "speed": between(3.0, 20.0),
        },
    }  # fmt: skip
    return Law(name, drawn[name]())


def turn_with(setup: Setup, law: Law) -> Turned:
    """Run a setup that no effect has changed with a law."""
    p, v = setup.p, law.values
    drop = p[kernel.T_CRIT] - p[kernel.T_KIN]
    if law.name == "constant":
        return turn(setup)
    if law.name == "stribeck":
        setup.weakening = 1.0 + drop / p[kernel.T_KIN] * np.exp(-_SLIDING / v["speed"])
        return turn(setup)
    if law.name == "ageing":
        setup.ageing = 1.0 - np.exp(-((_AGE / v["time"]) ** 0.7))
        return turn(setup)
    setup.law = _CREEPING[law.name]
    setup.contact = contact_of(v, drop=2.5 if law.name == "rate_and_state" else 1.0)
    return turn(setup)
