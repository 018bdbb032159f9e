"""Friction laws that rigs have as their own, with parameters about those of the shipped materials.

What a law's numbers are on a rig of another size follows from their units: twists go with torque
over stiffness, times with the period of the bushing, speeds with the ratio of both. So the rig
still does what it did.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.rig import LawSpec
from noise.diagnosis.cases.variants.common import log_uniform
from sim.friction import friction_law

MATERIALS = {
    "fluorocarbon": 0.09, "natural-rubber": 0.035, "natural-rubber-film-removed": 0.02,
    "natural-rubber-film": 0.015, "PDMS": 0.015,
}  # fmt: skip
"""Shipped ones with laws of their own, and how often each is met."""

OWN_LAWS = {
    "contact_with_memory": 0.18, "rate_and_state": 0.12, "stribeck_exponential": 0.07,
    "stribeck_gaussian": 0.07, "stribeck_lorentzian": 0.07, "lugre": 0.12, "ageing": 0.08,
    "bond_population": 0.06, "master_curve": 0.05, "maxwell_slip": 0.05, "viscous": 0.015,
    **MATERIALS,
}  # fmt: skip
"""Laws, or materials that have one, and how often each is met."""

Range = tuple[float, float]

_CONTACT: dict[str, Range] = {
    "contact_stiffness_per_torque": (900.0, 4500.0),
    "contact_damping_per_torque": (1e-5, 1.2e-4),
}
_FALLING: dict[str, Range] = {"first_speed": (0.3, 4.0), "second_speed": (8.0, 40.0)}

_LOG: dict[str, dict[str, Range]] = {
    "ageing": {**_CONTACT, "renewal_angle": (5e-5, 6e-4), "ageing_time": (3e-4, 4e-3)},
    "bond_population": {
        "bond_stiffness_per_torque": (900.0, 3500.0), "bonding_time": (8e-4, 5e-3),
        "rupture_stretch": (1.3e-4, 5e-4),
    },
    "contact_with_memory": {
        **_CONTACT, "renewal_angle": (5e-5, 6e-4), "ageing_time": (5e-5, 8e-4),
        "weakening_speed": (8.0, 40.0),
    },
    "lugre": {**_CONTACT, "stribeck_speed": (0.3, 4.0)},
    "master_curve": {**_CONTACT, "peak_speed": (3e-3, 0.2)},
    "maxwell_slip": {**_CONTACT, "stribeck_speed": (0.3, 4.0)},
    "rate_and_state": {
        **_CONTACT, "renewal_angle": (1e-4, 1e-3), "ageing_time": (5e-5, 1e-3),
        "direct_speed": (1e-3, 0.1),
    },
    "stribeck_exponential": {**_CONTACT, **_FALLING},
    "stribeck_gaussian": {**_CONTACT, **_FALLING},
    "stribeck_lorentzian": {**_CONTACT, **_FALLING},
    "viscous": {**_CONTACT, "doubling_speed": (6.0, 60.0)},
}  # fmt: skip
"""Ranges whose logarithms are drawn evenly, for a rig of the thesis's size."""

_EVEN: dict[str, dict[str, Range]] = {
    "bond_population": {"rubbing_share": (0.1, 0.6), "viscous_share_per_speed": (0.0, 0.025)},
    "contact_with_memory": {"weakening_share": (0.0, 0.2), "weakening_exponent": (1.0, 3.0)},
    "lugre": {"viscous_share_per_speed": (0.0, 0.008)},
    "master_curve": {"width": (0.7, 2.5), "peak_share": (1.0, 1.3), "floor_share": (0.8, 1.0)},
    "maxwell_slip": {"spread": (0.1, 0.7)},
    "rate_and_state": {"direct_effect": (0.0, 0.02)},
    "stribeck_exponential": {"second_share": (0.0, 0.5)},
    "stribeck_gaussian": {"second_share": (0.0, 0.5)},
    "stribeck_lorentzian": {"second_share": (0.0, 0.5)},
}
"""Ranges that are drawn from evenly."""


def draw_law(name: str, rng: np.random.Generator) -> LawSpec:
    """Draw the parameters of a law for a rig of the thesis's size.

    Examples
    --------
    >>> import numpy as np
    >>> sorted(draw_law("maxwell_slip", np.random.default_rng(0)).parameters)[-2:]
    ['spread', 'stribeck_speed']
    """
    values = {key: log_uniform(rng, *ends) for key, ends in _LOG[name].items()}
    values |= {key: float(rng.uniform(*ends)) for key, ends in _EVEN.get(name, {}).items()}
    return LawSpec(name, values)


def scaled_law(law: LawSpec, *, angle: float, time: float, torque: float) -> LawSpec:
    """Return a law as it is on a rig of another size.

    Parameters
    ----------
    law : LawSpec
    angle, time, torque : float
        Factors on twists, on the period of the bushing, on torques [-].

    Returns
    -------
    LawSpec
        With all its parameters, those that leave their range held at its end.

    Examples
    --------
    >>> stribeck = LawSpec("lugre", {"stribeck_speed": 1.0})
    >>> scaled_law(stribeck, angle=3.0, time=0.5, torque=2.0).parameters["stribeck_speed"]
    6.0
    """
    factors: Mapping[str, float] = {
        "1/rad": 1.0 / angle, "rad": angle, "s": time, "rad/s": angle / time,
        "s/rad": time / angle, "rad/Nm": angle / torque,
    }  # fmt: skip
    declared = friction_law(law.name).parameters
    given = {name: float(law.parameters.get(name, p.default)) for name, p in declared.items()}
    return LawSpec(
        law.name,
        {
            name: min(max(value * factors.get(declared[name].unit, 1.0), declared[name].low),
                      declared[name].high)
            for name, value in given.items()
        },
    )  # fmt: skip
