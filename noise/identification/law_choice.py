"""Which law of friction: each fitted, compared on recordings left out, the simplest as good.

Whole conditions are left out. What counts is how much of their oscillation a law foretells, cycle
by cycle; how far a simulation with it is from them, in floors, is stated beside.

How far recordings are from a rig, in floors: by what repeats of a condition agree in.

The distance is that of `noise.diagnosis.gap`, in units of what simulated repeats of the rig that
fits best differ by.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Rig
from noise.diagnosis.gap.distance import group_costs
from noise.diagnosis.gap.signature import channel_signature, joined_signature
from noise.diagnosis.simulated.repeats import Scatter, perturb_run
from noise.identification.law_fit import LawFit, Sketch, fit_law, fit_some, sketch_law
from noise.identification.law_model import CANDIDATES, LawModel
from noise.identification.outcome import LawScore
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from noise.identification.evidence import Evidence
    from noise.identification.measured import Beforehand, Measured
    from noise.identification.subjects import Subject

_SETTLING = 0.1
"""Simulated before what is looked at [s]; assumed."""

_SECONDS = 0.6
"""Looked at, at most [s]; assumed."""

_TOLERANCE = 1e-6
"""Of the solver: neighbouring motions part, but what they are made of does not."""

_REPEATS = 8
"""Simulated repeats, as few as tell a floor, and their least scatter, as
`noise.diagnosis.gap.distance` has it; a law that breaks down is so many floors off. Assumed."""
_LEAST_SCALE = 0.03
_LAW_DISTANCE_HOPELESS = 30.0


def repeats_scale(rig: Rig, like: Measured, first: int) -> NDArray[np.float64]:
    """Return what repeats of a recording differ by, by simulating some.

    Parameters
    ----------
    rig : Rig
    like : Measured
    first : int
        Seed of the first.

    Returns
    -------
    ndarray, shape (n_values,)
        Standard deviation of each value of the signature [-].
    """
    repeats = []
    for seed in range(first, first + _REPEATS):
        try:
            repeats.append(_signature(_simulated(rig, like, seed=seed), like.rate))
        except ParameterError:
            continue
    if len(repeats) < 3:
        return np.full(_signature(like.torque, like.rate).size, 0.1)
    spread = np.std(repeats, axis=0, ddof=1)
    # a run that is a little longer or shorter than another, and their error of eight
    typical = float(np.nanmedian(spread))
    return np.asarray(
        np.sqrt(0.7 * spread**2 + 0.3 * typical**2 + _LEAST_SCALE**2) * math.sqrt(1.1)
    )


def squared_distance(
    rig: Rig, recordings: Sequence[Measured], scales: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Squared distance of recordings from a rig, in floors.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Measured
    scales : sequence of ndarray, shape (n_values,)
        Of each, by `repeats_scale` [-].

    Returns
    -------
    ndarray, shape (n_recordings,)
        [-]
    """
    squares = []
    for one, scale in zip(recordings, scales, strict=True):
        try:
            away = _signature(one.torque, one.rate) - _signature(_simulated(rig, one), one.rate)
        except ParameterError:
            squares.append(_LAW_DISTANCE_HOPELESS**2)
            continue
        squares.append(float(np.nanmean(group_costs(away / scale))))
    return np.array(squares)


def _signature(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    return joined_signature({"torque": channel_signature(torque, rate, "torque")})


def _simulated(rig: Rig, like: Measured, *, seed: int | None = None) -> NDArray[np.float64]:
    """Simulate the torque at the condition of a recording, with a seed as a repeat of it."""
    once, at = rig, like.condition
    if seed is not None:
        once, at = perturb_run(rig, at, Scatter(), np.random.default_rng([seed, 0]))
    motion = simulate_motion(
        once, ConstantSpeed(at.speed), interference=at.interference,
        support_stiffness=at.support_stiffness, rate=like.rate, tolerance=_TOLERANCE,
        seconds=_SETTLING + min(like.torque.size / like.rate, _SECONDS),
    )  # fmt: skip
    return motion.torque[round(_SETTLING * like.rate) :]


MARGIN = 1.09
"""A simpler law may miss so many times as much for each number that it has less; assumed."""

_LEAST = 0.005
"""Share of the oscillation that any law may miss: what a cell and a start leave; assumed."""

_NEAR, _ENOUGH = 1.3, 1.1
"""And its distance may be so many times that of the best, or so many floors in any case;
assumed."""

_HOPELESS = 3.0
"""A law that misses so many times as much at first is not searched to the end; assumed."""


@dataclass(frozen=True, eq=False)
class Choice:
    """The law that was chosen.

    Parameters
    ----------
    fit : LawFit
        To all recordings.
    scores : tuple of LawScore
        Best first.
    held_out : tuple of str
        Recordings that the laws were compared on.
    """

    fit: LawFit
    scores: tuple[LawScore, ...]
    held_out: tuple[str, ...]


def overall(score: LawScore) -> float:
    """Distance over recordings held out and fitted to, both alike [floors].

    Examples
    --------
    >>> round(overall(LawScore("constant", 3.0, 4.0, 0.1, {})), 2)
    3.54
    """
    return math.sqrt(0.5 * (score.held_out**2 + score.trained**2))


def left_out(recordings: Sequence[Measured]) -> list[int]:
    """Choose recordings to leave out: whole conditions, about a third, no interference altogether.

    Returns
    -------
    list of int
        None of them where there are fewer than three conditions.
    """
    by_condition: dict[tuple[float, float, float], list[int]] = {}
    for i, one in enumerate(recordings):
        c = one.condition
        key = (round(c.speed, 1), c.interference, c.support_stiffness)
        by_condition.setdefault(key, []).append(i)
    if len(by_condition) < 3:
        return []
    chosen: list[int] = []
    ordered = sorted(by_condition, key=lambda key: (key[1], key[2], key[0]))
    for key in ordered[1::2]:
        rest = [k for k in ordered if k != key and not set(by_condition[k]) & set(chosen)]
        known = any(k[1] == key[1] for k in rest) and any(k[2] == key[2] for k in rest)
        if known and len(chosen) + len(by_condition[key]) <= len(recordings) / 3:
            chosen += by_condition[key]
    return chosen


def choose_law(
    beforehand: Beforehand,
    subjects: Sequence[Subject],
    material: str,
    progress: Callable[[str], None],
    *,
    evidence: Mapping[bool, tuple[Evidence, ...]] | None = None,
    seed: int = 0,
) -> Choice:
    """Fit all laws and choose.

    Parameters
    ----------
    beforehand : Beforehand
    subjects : sequence of Subject
        Recordings that slip.
    material : str
    progress : callable
        Told what is being done.
    evidence : mapping of bool to tuple of Evidence, optional
        Of the rig's numbers from elsewhere than stick-slip, by whether a law truly sticks.
    seed : int
        Of simulated repeats.

    Returns
    -------
    Choice
    """
    base, known = beforehand.rig, beforehand.known
    recordings = [one.measured for one in subjects]
    held = left_out(recordings)
    trained = [i for i in range(len(subjects)) if i not in held]
    sketches: dict[str, Sketch] = {}
    for candidate in CANDIDATES:
        progress(f"law {candidate.name}: a first look")
        said = evidence[candidate.sticks] if evidence else ()
        model = LawModel(candidate, tuple(subjects[i] for i in trained), known, said)
        alike = [s for s in sketches.values() if s.model.candidate.sticks == candidate.sticks]
        sketches[candidate.name] = sketch_law(model, alike)
    least = min(sketch.away for sketch in sketches.values())
    fits: dict[str, LawFit] = {}
    missed = {}
    for name, sketch in sketches.items():
        fits[name] = fit_law(sketch, hopeless=sketch.away > _HOPELESS * least)
        everything = _with_held(fits[name], subjects, trained, held)
        missed[name] = float(np.exp(np.mean(np.log(everything.missed))))
        progress(f"law {name}: leaves {100.0 * missed[name]:.1f} % of the oscillation unexplained")
    rigs = {name: fit.model.rig(fit.vector, base, material) for name, fit in fits.items()}
    best = min(missed, key=lambda name: missed[name])
    scales = [repeats_scale(rigs[best], one, seed) for one in recordings]
    scores = []
    for name, rig in rigs.items():
        squares = squared_distance(rig, recordings, scales)
        scores.append(
            LawScore(
                name, math.sqrt(float(squares[held or trained].mean())),
                math.sqrt(float(squares[trained].mean())), missed[name], _parameters(fits[name]),
            )
        )  # fmt: skip
    scores.sort(key=lambda score: score.missed)
    chosen = _simplest(scores)
    fit = fits[chosen]
    if held:
        whole = _with_held(fit, subjects, trained, held)
        fit = fit_law(Sketch(whole.model, (whole.vector,), 0.0))
    return Choice(fit, tuple(scores), tuple(recordings[i].name for i in held))


def _simplest(scores: Sequence[LawScore]) -> str:
    """Name the simplest law that foretells nearly as much as the best, and is as near in floors."""
    best = scores[0]
    numbers = {candidate.name: candidate.n_parameters for candidate in CANDIDATES}
    near = max(_NEAR * min(overall(s) for s in scores[:2]), _ENOUGH)
    by_law = {score.law: score for score in scores}
    for candidate in CANDIDATES:
        own = by_law[candidate.name]
        fewer = max(numbers[best.law] - numbers[own.law], 0)
        as_good = own.missed + _LEAST <= MARGIN**fewer * (best.missed + _LEAST)
        if as_good and overall(own) <= near:
            return own.law
    return best.law


def _with_held(
    fit: LawFit, subjects: Sequence[Subject], trained: Sequence[int], held: Sequence[int]
) -> LawFit:
    """Let recordings left out have numbers of their own about the rig that the others gave."""
    if not held:
        return fit
    model = replace(fit.model, subjects=tuple(subjects))
    x = model.extended(fit.model, fit.vector, trained)
    free = np.zeros(x.size, dtype=bool)
    free[: model.n_local].reshape(len(subjects), -1)[held] = True
    return fit_some(model, x, free)


def _parameters(fit: LawFit) -> dict[str, float]:
    law, effects = fit.model.specs(fit.vector)
    return {key: float(value) for spec in (law, *effects) for key, value in spec.parameters.items()}
