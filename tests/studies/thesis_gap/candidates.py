"""Candidates against the gap: one effect, a pair, or the parameters alone.

An effect brings its strength, at most two further parameters and its functional form; all other
parameters stay at their defaults. Ranges are wide and were set before anything was fitted. The
parameters alone are a candidate too, since three free numbers close some of any gap: damping, its
split between elastomer and beams, and the torque drop, on which alone the constant-torque model
depends. Of `transfer_film` the torque ratio is left out, since only differences of torque count.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from models.rig import LawSpec
from models.rig_files.rig_file import load_material_rig
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from models.rig import Fit, Rig

__all__ = ["KNOBS", "PAIRS", "PARAMETERS", "Candidate", "Knob", "nominal_rig", "singles"]

PARAMETERS = "parameters"
"""The candidate without an effect."""


@dataclass(frozen=True)
class Knob:
    """A number that is fitted.

    Parameters
    ----------
    name : str
    low, high : float
        What it may not leave.
    logarithmic : bool
        Whether it is searched on a logarithmic scale.

    Examples
    --------
    >>> Knob("speed", 1.0, 100.0, True).at(0.5)
    10.0
    """

    name: str
    low: float
    high: float
    logarithmic: bool

    def at(self, place: float) -> float:
        """Value at a place between 0 (low) and 1 (high)."""
        if self.logarithmic:
            value = self.low * float((self.high / self.low) ** place)
        else:
            value = self.low + place * (self.high - self.low)
        return min(max(value, self.low), self.high)


KNOBS: Mapping[str, tuple[Knob, ...]] = {
    "partial_slip": (Knob("share", 0.02, 0.95, True), Knob("exponent", 1.0, 20.0, True)),
    "velocity_weakening": (Knob("share", 0.005, 0.5, True), Knob("speed", 0.5, 100.0, True)),
    "velocity_strengthening": (Knob("gain", 0.002, 1.0, True), Knob("speed", 1.0, 100.0, True)),
    "static_ageing": (Knob("share", 0.2, 1.0, False), Knob("ageing_time", 1e-5, 3e-2, True)),
    "critical_torque_scatter": (
        Knob("scatter", 0.02, 1.0, True),
        Knob("correlation", 0.0, 0.99, False),
    ),
    "transfer_film": (
        Knob("coverage", 0.05, 1.0, False),
        Knob("drop_left", 0.0, 1.0, False),
        Knob("roughness", 1e-4, 0.1, True),
    ),
    "frictional_heating": (
        Knob("softening", 2e-4, 0.1, True),
        Knob("area", 1e-5, 1e-2, True),
        Knob("resistance", 1e-3, 10.0, True),
    ),
    "viscoelastic_stiffness": (
        Knob("stiffening", 0.03, 5.0, True),
        Knob("relaxation_time", 2e-5, 0.1, True),
    ),
    "amplitude_softening": (
        Knob("share", 0.05, 0.8, False),
        Knob("twist", 1e-5, 0.1, True),
        Knob("averaging_time", 1e-3, 1.0, True),
    ),
    "speed_fluctuation": (
        Knob("depth", 0.005, 0.3, True),
        Knob("order", 0.1, 200.0, True),
        Knob("bandwidth", 0.1, 500.0, True),
    ),
    "shaft_compliance": (
        Knob("compliance", 1e-5, 0.05, True),
        Knob("inertia", 1e-6, 1e-2, True),
        Knob("damping_ratio", 1e-3, 1.0, True),
    ),
}
"""Of each effect of drive and friction, its strength first."""

_RIG_KNOBS = (
    Knob("damping", 0.3, 3.0, True),
    Knob("elastomer_damping_share", 0.05, 0.95, False),
    Knob("torque_drop", 0.2, 3.0, True),
)
"""The first and the last relative to the rig."""

PAIRS = (
    ("partial_slip", "velocity_weakening"),
    ("static_ageing", "velocity_weakening"),
    ("viscoelastic_stiffness", "velocity_weakening"),
)
"""Chosen beforehand: what may part V_crit1 from V_crit2, with what may sustain an oscillation."""

_BEAT = 0.236
_WITHOUT_BEAT = 0.080


@dataclass(frozen=True)
class Candidate:
    """What may be missing.

    Parameters
    ----------
    effects : tuple of str
        Names; none are the parameters alone.
    """

    effects: tuple[str, ...]

    @property
    def name(self) -> str:
        """Effects joined by a plus.

        Examples
        --------
        >>> Candidate(("partial_slip", "velocity_weakening")).name
        'partial_slip + velocity_weakening'
        """
        return " + ".join(self.effects) or PARAMETERS

    @property
    def stage(self) -> str:
        """Where the effects act."""
        return " + ".join(dict.fromkeys(EFFECTS[name].stage.value for name in self.effects)) or "-"

    @property
    def dimensions(self) -> int:
        """How many places a point has: for each effect its form and its knobs."""
        if not self.effects:
            return len(_RIG_KNOBS)
        return sum(1 + len(KNOBS[name]) for name in self.effects)

    def nested(self, position: int, point: Sequence[float]) -> tuple[float, ...]:
        """Return the point with one effect as it is alone, and the others as weak as can be.

        Parameters
        ----------
        position : int
            Of the effect among `effects`.
        point : sequence of float
            Of the effect alone.

        Examples
        --------
        >>> Candidate(("partial_slip", "velocity_weakening")).nested(0, (0.1, 0.2, 0.3))
        (0.1, 0.2, 0.3, 0.0, 0.0, 0.5)
        """
        places: list[float] = []
        for i, name in enumerate(self.effects):
            places += point if i == position else [0.0, 0.0, *[0.5] * (len(KNOBS[name]) - 1)]
        return tuple(places)

    def specs(self, point: Sequence[float]) -> tuple[LawSpec, ...]:
        """Effects at a point of the unit cube, shape (dimensions,).

        Examples
        --------
        >>> (spec,) = Candidate(("velocity_weakening",)).specs((0.5, 0.0, 1.0))
        >>> spec.name, dict(spec.parameters)
        ('velocity_weakening', {'form': 'rational', 'share': 0.005, 'speed': 100.0})
        """
        specs: list[LawSpec] = []
        rest = list(point)
        for name in self.effects:
            forms, knobs = EFFECTS[name].forms, KNOBS[name]
            form = forms[min(int(rest[0] * len(forms)), len(forms) - 1)]
            values = {
                knob.name: knob.at(place) for knob, place in zip(knobs, rest[1:], strict=False)
            }
            specs.append(LawSpec(name, {"form": form, **values}))
            rest = rest[1 + len(knobs) :]
        return tuple(specs)

    def rig(self, point: Sequence[float]) -> Rig:
        """Return the thesis's rig with the candidate at a point of the unit cube."""
        rig = nominal_rig()
        if self.effects:
            return replace(rig, effects=self.specs(point))
        damping, share, drop = self._rig_values(point)

        def changed(fit: Fit) -> Fit:
            return replace(
                fit,
                critical_torque=fit.kinetic_torque
                + drop * (fit.critical_torque - fit.kinetic_torque),
                damping={support: damping * value for support, value in fit.damping.items()},
            )

        return replace(
            rig, elastomer_damping_share=share, fits=tuple(changed(fit) for fit in rig.fits)
        )

    def described(self, point: Sequence[float]) -> str:
        """Form and values at a point, as text.

        Examples
        --------
        >>> Candidate(()).described((0.5, 0.5, 0.0))
        'damping 0.949, elastomer_damping_share 0.5, torque_drop 0.2'
        """
        if not self.effects:
            named = zip(_RIG_KNOBS, self._rig_values(point), strict=True)
            return ", ".join(f"{knob.name} {value:.3g}" for knob, value in named)
        return " + ".join(
            ", ".join(
                str(value) if key == "form" else f"{key} {value:.3g}"
                for key, value in spec.parameters.items()
            )
            for spec in self.specs(point)
        )

    @staticmethod
    def _rig_values(point: Sequence[float]) -> tuple[float, ...]:
        return tuple(knob.at(place) for knob, place in zip(_RIG_KNOBS, point, strict=True))


def singles() -> tuple[Candidate, ...]:
    """Return the parameters alone, then each effect of drive and friction."""
    return (Candidate(()), *(Candidate((name,)) for name in KNOBS))


def nominal_rig() -> Rig:
    """Return the thesis's rig, without the beat in c_E at 0.381 mm that 5.3 itself disowns."""
    rig = load_material_rig("fluorocarbon-thesis")
    return replace(
        rig,
        fits=tuple(
            replace(
                fit,
                damping={
                    support: _WITHOUT_BEAT if value == _BEAT else value
                    for support, value in fit.damping.items()
                },
            )
            for fit in rig.fits
        ),
    )
