"""Random simulated bushings with labels by physics, for the classifier.

Labels are by `noise.noise_definition.label_by_physics`, which is defined at constant speed. So a
run of varying speed, or that has not settled, is labelled in pieces of a quarter of a second, and
the longest stretch with one label is used; a run without half a second of one label is drawn again.
A short preview of the motion balances the labels, and half of the unexpected squawks are discarded.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from models.bench import Microphone, Plate
from models.errors import ParameterError
from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_material_rig
from noise.base import packaged_toml
from noise.base.arrays import Rng
from noise.diagnosis.cases.draws import draw_numbers
from noise.noise_definition import is_ambiguous, label_by_physics, run_criteria
from noise.training.classifier.recorder import RATES
from noise.training.draws import log_uniform, picked
from sim.acquisition import Acquisition
from sim.analysis.regime import Regime, friction_regime
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.motion import simulate_motion
from sim.parameters import Parameter
from sim.run import Run, pulse_force, simulate
from sim.shaft import ConstantSpeed, Oscillation, ShaftMotion, SpeedRamp

SHAPES = {"weakening_exponent"}
"""Parameters of laws that do not vary between designs."""


_TABLE = packaged_toml("noise.training.classifier", "bushings.toml")


@dataclass(frozen=True)
class Design:
    """Rig with an operating condition; units as in `sim.run.simulate`."""

    rig: Rig
    speed: float
    interference: float
    support_stiffness: float


def random_design(rng: Rng) -> Design:
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
    rig = _material_rig(picked(_TABLE["materials"], rng))
    # Half of them are tight, to creak, the others looser and fast enough to squeal.
    tight = bool(rng.random() < 0.5)
    interference = float(rng.uniform(0.32e-3, 0.42e-3) if tight else rng.uniform(0.15e-3, 0.34e-3))
    near = bool(rng.random() < 0.35)
    if near:
        middle = 0.381e-3 if tight else (0.178e-3, 0.279e-3)[int(rng.integers(2))]
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
        microphone=rig.microphone if near else Microphone(_random_place(rng)),
    )
    support = float(rng.choice((2214.0, 3745.0, math.inf)))
    if near and math.isfinite(support):
        support *= math.exp(rng.normal(0.0, 0.02))
    elif rng.random() < 0.4:
        support = log_uniform(1700.0, 10000.0, rng)
    # Slow creaks have few slips a second.
    speed = log_uniform(0.1, 15.0, rng) if tight else float(rng.uniform(0.5, 13.0))
    return Design(rig, speed, interference, support)


_material_rig = lru_cache(load_material_rig)


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
    spec: LawSpec, declared: Mapping[str, Parameter], scatter: float, rng: Rng
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


def _random_place(rng: Rng) -> tuple[float, float, float]:
    x, y, z = rng.uniform((-0.8, -0.8, 0.2), (0.8, 0.8, 1.5)).tolist()
    return x, y, z


def _random_plate(plate: Plate, rng: Rng) -> Plate:
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


def random_extras(present: tuple[LawSpec, ...], rng: Rng) -> tuple[LawSpec, ...]:
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
    if chance < 0.02:
        pool, n = _TABLE["dear"], 1
    elif chance < 0.35:
        pool, n = _TABLE["usual"], int(rng.integers(1, 3))
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


_PIECE = 0.25
"""Duration of the labelled pieces of a run of varying speed [s]."""

_SHORTEST = 0.5
"""Minimum duration of a stretch with one label [s]."""


@dataclass(frozen=True, eq=False)
class LabelledRun:
    """Run, or part of a run, with one label.

    It is ambiguous by `noise.noise_definition.is_ambiguous`, of pieces if most of them are.
    """

    run: Run
    label: str
    ambiguous: bool = False


def random_run(rng: Rng) -> LabelledRun:
    """Return a simulated run of a random design and motion, with its label.

    Examples
    --------
    >>> drawn = random_run(np.random.default_rng(5))
    >>> drawn.label in ("creak", "squawk", "squeal", "none")
    True
    """
    wanted = picked({"creak": 0.34, "squawk": 0.17, "squeal": 0.32, "none": 0.17}, rng)
    for attempt in itertools.count():
        design = random_design(rng)
        while not _likely(design, wanted) and rng.random() < 0.85:
            design = random_design(rng)
        extras = random_extras(design.rig.effects, rng)
        design = replace(design, rig=replace(design.rig, effects=design.rig.effects + extras))
        try:
            if attempt < 20 and _guessed(design) != wanted:
                continue
            labelled = _labelled(design, rng)
        except ParameterError:  # an impossible design
            continue
        if labelled is None:
            continue
        spare = labelled.label == "squawk" != wanted
        if not (spare and rng.random() < 0.5):
            return labelled
    raise AssertionError  # unreachable: the loop is infinite


def _likely(design: Design, wanted: str) -> bool:
    """Whether a label is common at the condition of a design."""
    fluorocarbon = design.rig.material == "fluorocarbon"
    tight = design.interference > 0.31e-3
    if wanted == "squeal":
        return fluorocarbon and design.speed > 4.0 and design.interference < 0.34e-3
    if wanted == "creak":
        film = design.rig.material == "natural-rubber-film"
        return (fluorocarbon and tight and design.speed < 11.0) or (film and design.speed > 3.0)
    return True


def _guessed(design: Design) -> str:
    """Return the label that is expected from a short motion."""
    rig = design.rig
    effects = activated(rig.effects, EFFECTS)
    motion = simulate_motion(
        rig,
        ConstantSpeed(design.speed),
        interference=design.interference,
        support_stiffness=design.support_stiffness,
        seconds=0.3,
        rate=30e3,
        effects=effects,
    )
    regime = friction_regime(motion)
    if regime is Regime.STEADY_SLIDING:
        return "none"
    if pulse_force(motion, effects)[motion.torque.size // 2 :].any():
        return "creak"
    lines = find_lines(
        autospectrum(motion.torque[motion.torque.size // 2 :], motion.rate), low=20.0, high=5e3
    )
    if not lines.power.size:
        return "creak"
    strong = lines.power >= 10.0**-1.8 * lines.power[0]
    return "squeal" if np.count_nonzero(strong) == 1 else "squawk"


def _labelled(design: Design, rng: Rng) -> LabelledRun | None:
    rate = float(RATES[int(rng.integers(len(RATES)))])
    seconds = float(rng.uniform(0.6, 3.0) if rng.random() < 0.35 else rng.uniform(0.6, 1.2))
    shaft = _random_shaft(design.speed, seconds, rng)
    run = simulate(
        design.rig,
        shaft,
        interference=design.interference,
        support_stiffness=design.support_stiffness,
        seconds=seconds,
        settling=0.5 if isinstance(shaft, ConstantSpeed) else 0.2,
        acquisition=Acquisition(rate=rate, noise={}),
        rng=rng,
    )
    if isinstance(shaft, ConstantSpeed):
        criteria = run_criteria(run)
        label = criteria.label
        half = run.pressure.size // 2 / run.motion.rate
        labelled: LabelledRun | None = LabelledRun(run, label, is_ambiguous(criteria))
        if seconds > 2 * _SHORTEST and label_by_physics(stretch(run, 0.0, half)) != label:
            labelled = _uniform_part(run)
    else:
        labelled = _uniform_part(run)
    if labelled is None or labelled.label == "none":
        return labelled
    sensed, computed = labelled.run.recording["pressure"], labelled.run.pressure
    drowned = float(sensed.std()) > 1.5 * float(computed.std())  # by the noise of the sensor
    return None if drowned else labelled


def _random_shaft(speed: float, seconds: float, rng: Rng) -> ShaftMotion:
    """Return a constant speed, a ramp by up to a third, or an oscillation."""
    chance = rng.random()
    if chance < 0.65:
        return ConstantSpeed(speed)
    if chance < 0.85:
        share = math.exp(rng.uniform(-0.4, 0.4))
        return SpeedRamp(speed, speed * share, 0.2 + seconds)
    frequency = log_uniform(0.15, 1.5, rng)
    amplitude = speed / (2.0 * math.pi * frequency)
    return Oscillation(amplitude, frequency)


def stretch(run: Run, start: float, end: float) -> Run:
    """Return the part of a run between two times [s].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.2)
    >>> stretch(run, 0.05, 0.15).recording.samples.shape
    (4, 3000)
    """
    rate = run.motion.rate
    first, last = round(start * rate), round(end * rate)
    recorded = slice(round(start * run.recording.rate), round(end * run.recording.rate))
    return Run(
        recording=replace(run.recording, samples=run.recording.samples[:, recorded]),
        motion=run.motion.part(first, last),
        pressure=run.pressure[first:last],
        pulse_pressure=run.pulse_pressure[first:last],
        settling=run.settling + start,
    )


def _uniform_part(run: Run) -> LabelledRun | None:
    """Return the longest stretch with one label; ``None`` if it is short."""
    n = int(run.pressure.size / run.motion.rate / _PIECE)
    criteria = [run_criteria(stretch(run, i * _PIECE, (i + 1) * _PIECE)) for i in range(n)]
    labels = [one.label for one in criteria]
    runs = [(label, len(list(group))) for label, group in itertools.groupby(labels)]
    longest = max(range(len(runs)), key=lambda i: runs[i][1])
    label, length = runs[longest]
    if length * _PIECE < _SHORTEST:
        return None
    first = sum(count for _, count in runs[:longest])
    unclear = sum(map(is_ambiguous, criteria[first : first + length]))
    part = stretch(run, first * _PIECE, (first + length) * _PIECE)
    return LabelledRun(part, label, 2 * unclear > length)
