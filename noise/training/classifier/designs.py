"""Rigs and conditions that differ as designs do, for the classifier to learn from."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from models.rig import Fit, LawSpec, Microphone, Plate, Rig
from models.rig_files.rig_file import load_material_rig
from noise.training.draws import log_uniform
from sim.effects import EFFECTS
from sim.friction import friction_law

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np

    from sim.parameters import Parameter

__all__ = ["Design", "random_design"]

_MATERIALS = {
    "fluorocarbon": 0.6,
    "fluorocarbon-thesis": 0.08,
    "PDMS": 0.08,
    "natural-rubber": 0.08,
    "natural-rubber-film": 0.08,
    "natural-rubber-film-removed": 0.08,
}
"""Share of the designs that start from each."""

_SHAPES = {"weakening_exponent"}
"""Parameters that make the law what it is, and so do not differ from design to design."""

_NEAR = 0.35
"""Share of the designs that are the shipped rigs, but for a scatter of some per cent."""

_INTERFERENCES = (0.178e-3, 0.279e-3, 0.381e-3)
"""Of the thesis [m]."""

_SUPPORTS = (2214.0, 3745.0, math.inf)
"""Of the thesis's rig [Nm/rad]."""


@dataclass(frozen=True)
class Design:
    """A rig with the condition that it runs at; units as in `sim.run.simulate`."""

    rig: Rig
    speed: float
    interference: float
    support_stiffness: float


def random_design(rng: np.random.Generator) -> Design:
    """Draw a design and a condition.

    Stiffness, inertia and torque scatter by a third or so about the shipped bushing's, the
    elastomer's inertia by a factor of ten, which moves its mode, hence the squeal, up to 3 kHz;
    plate, microphone and slip pulse vary as from one car to the next. A third are the shipped rigs
    near the thesis's own interferences, with a sixth of that scatter.

    Examples
    --------
    >>> import numpy as np
    >>> random_design(np.random.default_rng(3)).rig.material
    'fluorocarbon'
    """
    names = list(_MATERIALS)
    rig = _material_rig(names[int(rng.choice(len(names), p=list(_MATERIALS.values())))])
    # Half of them tight, where creak is, the others looser and fast enough to squeal.
    tight = bool(rng.random() < 0.5)
    interference = float(rng.uniform(0.32e-3, 0.42e-3) if tight else rng.uniform(0.15e-3, 0.34e-3))
    near = bool(rng.random() < _NEAR)
    if near:
        middle = _INTERFERENCES[2 if tight else int(rng.integers(2))]
        interference = middle * math.exp(rng.normal(0.0, 0.02))
    scatter = 0.17 if near else 1.0
    stiffness = math.exp(scatter * rng.normal(0.0, 0.3))
    torque = math.exp(scatter * rng.normal(0.0, 0.25))
    inertia = rng.normal(0.0, 0.05) if near else rng.uniform(math.log(0.12), 0.3)
    rig = replace(
        rig,
        elastomer_inertia=rig.elastomer_inertia * math.exp(inertia),
        clamp_inertia=rig.clamp_inertia * math.exp(scatter * rng.normal(0.0, 0.3)),
        elastomer_damping_share=min(
            0.9, rig.elastomer_damping_share * math.exp(scatter * rng.normal(0.0, 0.3))
        ),
        fits=tuple(_scaled(fit, stiffness, torque) for fit in rig.fits),
        friction=_jittered(
            rig.friction, friction_law(rig.friction.name).parameters, 0.2 * scatter, rng
        ),
        effects=tuple(
            _jittered(spec, EFFECTS[spec.name].parameters, 0.4 * scatter, rng)
            for spec in rig.effects
        ),
        plate=rig.plate if near else _random_plate(rig.plate, rng),
        microphone=rig.microphone if near else _random_microphone(rng),
    )
    support = float(rng.choice(_SUPPORTS))
    if near and math.isfinite(support):
        support *= math.exp(rng.normal(0.0, 0.02))
    elif rng.random() < 0.4:
        support = log_uniform(1700.0, 10000.0, rng)
    # Slow creaks have few slips a second.
    speed = log_uniform(0.1, 15.0, rng) if tight else float(rng.uniform(0.5, 13.0))
    return Design(rig, speed, interference, support)


@lru_cache
def _material_rig(material: str) -> Rig:
    return load_material_rig(material)


def _scaled(fit: Fit, stiffness: float, torque: float) -> Fit:
    return replace(
        fit,
        elastomer_stiffness=fit.elastomer_stiffness * stiffness,
        critical_torque=fit.critical_torque * torque,
        kinetic_torque=fit.kinetic_torque * torque,
    )


def _jittered(
    spec: LawSpec,
    declared: Mapping[str, Parameter],
    scatter: float,
    rng: np.random.Generator,
) -> LawSpec:
    """Scatter a law's or an effect's parameters within their admitted ranges."""
    return LawSpec(
        spec.name,
        {
            name: min(
                max(value * math.exp(min(0.5, rng.normal(0.0, scatter))), declared[name].low),
                declared[name].high,
            )
            if isinstance(value, float) and name not in _SHAPES
            else value
            for name, value in spec.parameters.items()
        },
    )


def _random_microphone(rng: np.random.Generator) -> Microphone:
    return Microphone(
        (
            float(rng.uniform(-0.8, 0.8)),
            float(rng.uniform(-0.8, 0.8)),
            float(rng.uniform(0.2, 1.5)),
        )
    )


def _random_plate(plate: Plate, rng: np.random.Generator) -> Plate:
    length = float(rng.uniform(0.4, 1.0))
    width = length * float(rng.uniform(0.5, 0.9))
    return replace(
        plate,
        length=length,
        width=width,
        thickness=float(rng.uniform(0.005, 0.0127)),
        loss_factor=float(rng.uniform(0.01, 0.06)),
        clamp_position=(
            length * float(rng.uniform(-0.12, 0.12)),
            width * float(rng.uniform(-0.3, 0.3)),
        ),
    )
