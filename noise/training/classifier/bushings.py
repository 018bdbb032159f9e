"""Random simulated bushings with labels by physics, for the classifier.

Labels are by `noise.noise_definition.label_by_physics`, which is defined at constant speed. So a
run of varying speed, or that has not settled, is labelled in pieces of a quarter of a second, and
the longest stretch with one label is used; a run without half a second of one label is drawn again.
A short preview of the motion balances the labels, and half of the unexpected squawks are discarded.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from models.errors import ParameterError
from noise.noise_definition import is_ambiguous, label_by_physics, run_criteria
from noise.training.classifier.augmentation.recorder import RATES
from noise.training.classifier.designs import Design, random_design, random_extras
from noise.training.draws import log_uniform, picked
from sim.acquisition import Acquisition
from sim.analysis.regime import Regime, friction_regime
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.motion import simulate_motion
from sim.run import Run, pulse_force, simulate
from sim.shaft import ConstantSpeed, Oscillation, ShaftMotion, SpeedRamp

_SHARES = {"creak": 0.34, "squawk": 0.17, "squeal": 0.32, "none": 0.17}
"""Shares of the wanted labels."""

_MOST_TRIES = 20
"""Maximum number of previews."""

_SPARE_SQUAWKS = 0.5
"""Probability of drawing again after a squawk instead of the wanted label."""

_WHERE_LIKELY = 0.85
"""Probability of drawing a design again if the wanted label is rare there."""

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


def random_run(rng: np.random.Generator) -> LabelledRun:
    """Return a simulated run of a random design and motion, with its label.

    Examples
    --------
    >>> drawn = random_run(np.random.default_rng(5))
    >>> drawn.label in ("creak", "squawk", "squeal", "none")
    True
    """
    wanted = picked(_SHARES, rng)
    for attempt in itertools.count():
        design = random_design(rng)
        while not _likely(design, wanted) and rng.random() < _WHERE_LIKELY:
            design = random_design(rng)
        design = replace(
            design,
            rig=replace(
                design.rig, effects=design.rig.effects + random_extras(design.rig.effects, rng)
            ),
        )
        try:
            if attempt < _MOST_TRIES and _guessed(design) != wanted:
                continue
            labelled = _labelled(design, rng)
        except ParameterError:  # an impossible design
            continue
        if labelled is None:
            continue
        spare = labelled.label == "squawk" != wanted
        if not (spare and rng.random() < _SPARE_SQUAWKS):
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


def _labelled(design: Design, rng: np.random.Generator) -> LabelledRun | None:
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
    if labelled is None or (labelled.label != "none" and _drowned(labelled.run)):
        return None
    return labelled


def _random_shaft(speed: float, seconds: float, rng: np.random.Generator) -> ShaftMotion:
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


def _drowned(run: Run) -> bool:
    """Whether the sensor noise exceeds the sound."""
    return float(run.recording["pressure"].std()) > 1.5 * float(run.pressure.std())
