"""Laws of friction that an identification tries, simplest first, and what of each it searches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Candidate:
    """A law to be tried.

    Parameters
    ----------
    name, words : str
        In tables, and on pages.
    law : str
        Of `sim.friction`.
    effect : str, optional
        Of `sim.effects`; then it is what the searched parameters belong to.
    free : mapping of str to tuple of float
        Parameters that are searched: lowest, highest and some starts [the law's units].
    fixed : mapping of str to float
        Others that differ from the law's own [the law's units].
    drops : tuple of float
        What the critical torque exceeds the kinetic one by where a search begins, over what the
        levels differ by [-].
    """

    name: str
    words: str
    law: str
    effect: str | None = None
    free: Mapping[str, tuple[float, float, tuple[float, ...]]] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    drops: tuple[float, ...] = (1.0,)

    @property
    def sticks(self) -> bool:
        """Whether its contact truly sticks."""
        return self.law == "coulomb"

    @property
    def n_parameters(self) -> int:
        """Numbers that it has beyond the two torques of each fit."""
        return len(self.free)


_STIFFNESS = {"contact_stiffness_per_torque": (400.0, 9e3, (1500.0, 3500.0))}
_DAMPING = {"contact_damping_per_torque": 6e-5}
"""Next to the elastomer's damping it hardly counts."""

CANDIDATES = (
    Candidate("constant", "constant torques", "coulomb"),
    Candidate(
        "ageing", "static torque grows while it sticks", "coulomb", "static_ageing",
        {"ageing_time": (5e-5, 0.1, (4e-4, 3e-3))},
        drops=(1.0, 1.5),
    ),
    Candidate(
        "stribeck", "torque falls with sliding speed", "coulomb", "velocity_weakening",
        {"share": (0.005, 0.6, (0.05, 0.25)), "speed": (0.3, 40.0, (1.5, 5.0))},
        drops=(0.05, 0.7),
    ),
    Candidate(
        "bristle", "elastic contact, torque falls with speed", "stribeck_lorentzian", None,
        {**_STIFFNESS, "first_speed": (0.2, 30.0, (1.2, 4.0))},
        _DAMPING, (1.0, 2.0),
    ),
    Candidate(
        "rate_and_state", "elastic contact, strength by age and slip", "rate_and_state", None,
        {
            **_STIFFNESS,
            "ageing_time": (2e-5, 0.02, (1e-4, 1e-3)),
            "renewal_angle": (6e-5, 5e-3, (2e-4,)),
        },
        _DAMPING, (1.0, 2.0),
    ),
    Candidate(
        "memory", "elastic contact with memory, torque falls with speed", "contact_with_memory",
        None,
        {
            "contact_stiffness_per_torque": (400.0, 4.9e3, (1200.0, 2400.0)),
            "ageing_time": (2e-5, 0.02, (3e-4, 1.5e-3)),
            "renewal_angle": (6e-5, 5e-3, (2e-4,)),
            "weakening_share": (0.005, 1.0, (0.08,)),
            "weakening_speed": (1.0, 60.0, (8.0,)),
            "weakening_exponent": (1.0, 2.5, (1.4,)),
        },
        _DAMPING, (1.0, 2.0),
    ),
)  # fmt: skip
"""By rising number of parameters."""
