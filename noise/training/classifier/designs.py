"""Random designs: rigs and operating conditions, for the classifier."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from models.bench import Microphone, Plate
from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_material_rig
from noise.base import packaged_toml
from noise.diagnosis.cases.draws import draw_numbers
from noise.training.draws import log_uniform, picked
from sim.effects import EFFECTS
from sim.friction import friction_law
from sim.parameters import Parameter

_MATERIALS = {
    "fluorocarbon": 0.6,
    "fluorocarbon-thesis": 0.08,
    "PDMS": 0.08,
    "natural-rubber": 0.08,
    "natural-rubber-film": 0.08,
    "natural-rubber-film-removed": 0.08,
}
"""Shares of the materials of the designs."""

SHAPES = {"weakening_exponent"}
"""Parameters of laws that do not vary between designs."""

_NEAR = 0.35
"""Share of the designs close to the shipped rigs, with a scatter of some per cent."""

_INTERFERENCES = (0.178e-3, 0.279e-3, 0.381e-3)
"""Interferences of the thesis [m]."""

_SUPPORTS = (2214.0, 3745.0, math.inf)
"""Support stiffnesses of the thesis [Nm/rad]."""


_EXTRAS = packaged_toml("noise.training.classifier", "extras.toml")

_SHARE_OF_DEAR = 0.02


@dataclass(frozen=True)
class Design:
    """Rig with an operating condition; units as in `sim.run.simulate`."""

    rig: Rig
    speed: float
    interference: float
    support_stiffness: float


def random_design(rng: np.random.Generator) -> Design:
    """Return a random design.

    Stiffness, inertia and torque scatter by about a third around those of the shipped bushing. The
    inertia of the elastomer varies by a factor of ten, which moves its mode, hence the squeal, up
    to 3 kHz. Plate, microphone and slip pulse vary as between cars. A third of the designs are
    close to the shipped rigs and the interferences of the thesis, with a sixth of that scatter.

    Examples
    --------
    >>> import numpy as np
    >>> random_design(np.random.default_rng(3)).rig.material
    'fluorocarbon'
    """
    rig = _material_rig(picked(_MATERIALS, rng))
    # Half of them are tight, to creak, the others looser and fast enough to squeal.
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
        fits=tuple(scaled(fit, stiffness, torque) for fit in rig.fits),
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


def scaled(fit: Fit, stiffness: float, torque: float, damping: float = 1.0) -> Fit:
    """Return a fit with scaled properties.

    Parameters
    ----------
    fit : Fit
    stiffness, torque, damping : float
        Factors [-].

    Returns
    -------
    Fit

    Examples
    --------
    >>> scaled(Fit(0.279e-3, 6000.0, 9.0, 6.0, {}), 2.0, 1.0).elastomer_stiffness
    12000.0
    """
    return replace(
        fit,
        elastomer_stiffness=fit.elastomer_stiffness * stiffness,
        critical_torque=fit.critical_torque * torque,
        kinetic_torque=fit.kinetic_torque * torque,
        damping={support: c * damping for support, c in fit.damping.items()},
    )


def _jittered(
    spec: LawSpec, declared: Mapping[str, Parameter], scatter: float, rng: np.random.Generator
) -> LawSpec:
    """Return a law or effect with random parameters within their ranges."""
    return LawSpec(
        spec.name,
        {
            name: min(
                max(value * math.exp(min(0.5, rng.normal(0.0, scatter))), declared[name].low),
                declared[name].high,
            )
            if isinstance(value, float) and name not in SHAPES
            else value
            for name, value in spec.parameters.items()
        },
    )


def _random_microphone(rng: np.random.Generator) -> Microphone:
    return Microphone(
        (float(rng.uniform(-0.8, 0.8)), float(rng.uniform(-0.8, 0.8)), float(rng.uniform(0.2, 1.5)))
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


def random_extras(present: tuple[LawSpec, ...], rng: np.random.Generator) -> tuple[LawSpec, ...]:
    """Return one or two random effects that are not `present`, in a third of the calls.

    Their strengths range from negligible to much more than the scatter of repeats.

    Examples
    --------
    >>> import numpy as np
    >>> extras = [random_extras((), np.random.default_rng(seed)) for seed in range(60)]
    >>> sum(map(bool, extras)), max(map(len, extras))
    (18, 2)
    """
    chance = rng.random()
    if chance < _SHARE_OF_DEAR:
        pool, n = _EXTRAS["dear"], 1
    elif chance < 0.35:
        pool, n = _EXTRAS["usual"], int(rng.integers(1, 3))
    else:
        return ()
    taken = {spec.name for spec in present}
    names = [name for name in pool if name not in taken]
    extras = []
    for i in rng.permutation(len(names))[:n].tolist():
        forms = EFFECTS[names[i]].forms
        form = forms[int(rng.integers(len(forms)))]
        extras.append(LawSpec(names[i], {"form": form, **draw_numbers(pool[names[i]], rng)}))
    return tuple(extras)
