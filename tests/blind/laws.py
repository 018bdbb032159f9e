"""Laws of friction as a rig file states them, solved by this rig: one law is one entry.

What is stated is public, equation and keys of each law; how it is solved is not. The critical
torque of a contact that ages is what it bears after a long rest, so that of one cycle is less.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import contact

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["CONSTANT", "LAWS", "Law", "contact_of", "draw_law"]

_PLACES = {
    "stiffness": contact.STIFFNESS, "viscous": contact.DAMPER, "speed": contact.SPEED,
    "renewal": contact.RENEWAL, "time": contact.TIME, "direct": contact.DIRECT,
    "weakening": contact.WEAKENING, "exponent": contact.EXPONENT, "rise": contact.VISCOUS,
}  # fmt: skip
_BRISTLES = {"stiffness": (1200.0, 2800.0), "viscous": (3e-5, 1e-4)}


@dataclass(frozen=True)
class Law:
    """A law of a rig: its kind, its own numbers in SI units."""

    name: str
    values: Mapping[str, float]


@dataclass(frozen=True)
class _Stated:
    """How rig files know a law, and what its numbers may be; `drop` enlarges that of the fits."""

    code: int
    named: str
    keys: Mapping[str, str]
    ranges: Mapping[str, tuple[float, float]]
    drop: float = 1.0


_CONTACT_KEYS = {
    "stiffness": "contact_stiffness_per_torque", "viscous": "contact_damping_per_torque",
}  # fmt: skip
LAWS = {
    "constant": _Stated(contact.TRUE_STICK, "coulomb", {}, {}),
    "stribeck": _Stated(
        contact.LORENTZIAN, "stribeck_lorentzian", _CONTACT_KEYS | {"speed": "first_speed"},
        _BRISTLES | {"speed": (1.5, 6.0)},
    ),
    "bristle": _Stated(
        contact.LUGRE, "lugre",
        _CONTACT_KEYS | {"speed": "stribeck_speed", "rise": "viscous_share_per_speed"},
        _BRISTLES | {"speed": (1.5, 6.0), "rise": (5e-4, 4e-3)},
    ),
    "rate_and_state": _Stated(
        contact.STATED_RATE_AND_STATE, "rate_and_state",
        _CONTACT_KEYS | {
            "renewal": "renewal_angle", "time": "ageing_time", "direct": "direct_effect",
            "speed": "direct_speed",
        },
        _BRISTLES | {
            "renewal": (1.5e-4, 5e-4), "time": (2e-4, 1e-3), "direct": (5e-4, 4e-3),
            "speed": (0.02, 0.1),
        },
        2.2,
    ),
    "memory": _Stated(
        contact.STATED_MEMORY, "contact_with_memory",
        _CONTACT_KEYS | {
            "renewal": "renewal_angle", "time": "ageing_time", "weakening": "weakening_share",
            "speed": "weakening_speed", "exponent": "weakening_exponent",
        },
        _BRISTLES | {
            "renewal": (1.5e-4, 5e-4), "time": (3e-4, 1.2e-3), "weakening": (0.01, 0.08),
            "speed": (6.0, 25.0), "exponent": (1.0, 2.0),
        },
        2.2,
    ),
}  # fmt: skip
"""The laws that a bench may have."""

CONSTANT = Law("constant", {})


def draw_law(name: str, rng: np.random.Generator) -> Law:
    """Draw the numbers of a law."""
    drawn = {
        key: float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.4g}")
        for key, (low, high) in LAWS[name].ranges.items()
    }
    return Law(name, drawn)


def contact_of(values: Mapping[str, float], drop: float = 1.0) -> NDArray[np.float64]:
    """Return the numbers of a contact as the kernel reads them, neutral where not given."""
    numbers = np.zeros(contact.N_CONTACT)
    numbers[[contact.SPEED, contact.RENEWAL, contact.TIME, contact.EXPONENT]] = 1.0
    numbers[contact.DROP] = drop
    for key, value in values.items():
        numbers[_PLACES[key]] = value
    return numbers
