"""Which law of friction: each fitted, compared on recordings left out, the simplest as good.

Whole conditions are left out. A law's distance from them is that of `noise.diagnosis.gap`: in units
of what simulated repeats of the law that fits best differ by, 1.0 being the floor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.diagnosis.gap.distance import group_costs
from noise.diagnosis.gap.signature import channel_signature, joined_signature
from noise.identification.law_candidates import CANDIDATES
from noise.identification.law_fit import LawFit, fit_law
from noise.identification.law_model import LawModel, simulated_torque, torque_statistics
from noise.identification.outcome import LawScore

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from noise.identification.measured import Measured

__all__ = ["MARGIN", "Choice", "choose_law", "left_out", "overall"]

MARGIN = 1.15
"""A simpler law is chosen while its distance is at most so many times the best one's."""

_ENOUGH = 1.1
"""Distance from which nothing is gained by a law with more parameters."""

_REPEATS = 8
_PLACES = 3
"""From which a law with true stick is searched."""

_LEAST_SCALE = 0.03
_HOPELESS = 30.0


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
    >>> round(overall(LawScore("constant", 3.0, 4.0, {})), 2)
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
    base: Rig, recordings: Sequence[Measured], progress: Callable[[str], None], *, seed: int = 0
) -> Choice:
    """Fit all laws and choose.

    Parameters
    ----------
    base : Rig
        With the numbers that no law is needed for; damping at each support in each fit.
    recordings : sequence of Measured
    progress : callable
        Told what is being done.
    seed : int
        Of simulated repeats.

    Returns
    -------
    Choice
    """
    supports = tuple(sorted({one.condition.support_stiffness for one in recordings}))
    targets = [torque_statistics(one.torque, one.rate) for one in recordings]
    held = left_out(recordings)
    trained = [i for i in range(len(recordings)) if i not in held]
    judged = held or trained
    fits: dict[str, LawFit] = {}
    bushing = None
    for candidate in CANDIDATES:
        model = LawModel(base, candidate, supports)
        starts = model.starts(bushing)
        some = [recordings[i] for i in trained], [targets[i] for i in trained]
        tried = [fit_law(model, *some, bushing=bushing)]
        if candidate.sticks and len(starts) > 1:  # solved fast, and rough: from several places
            tried += [
                fit_law(model, *some, begin=start)
                for start in starts[:: -(-len(starts) // _PLACES)]
            ]
        fits[candidate.name] = min(tried, key=lambda fit: fit.cost)
        if bushing is None:
            bushing = fits[candidate.name].vector[: model.n_bushing]
        progress(f"law {candidate.name}: misfit {fits[candidate.name].cost:.2f}")
    best = min(fits.values(), key=lambda fit: fit.cost)
    scales = [_repeats_scale(best, one, seed) for one in recordings]
    scores = []
    for name, fit in fits.items():
        squares = np.array(
            [_squared(fit, one, scale) for one, scale in zip(recordings, scales, strict=True)]
        )
        scores.append(
            LawScore(
                name, math.sqrt(float(squares[judged].mean())),
                math.sqrt(float(squares[trained].mean())), _parameters(fit),
            )
        )  # fmt: skip
    # held-out recordings are few: a law that fails those it was fitted to is no better for them
    scores.sort(key=overall)
    enough = max(overall(scores[0]) * MARGIN, _ENOUGH)
    within = {score.law for score in scores if overall(score) <= enough}
    simplest = next(c.name for c in CANDIDATES if c.name in within)
    fit = fits[simplest]
    if held:
        fit = fit_law(fit.model, recordings, targets, iterations=2, begin=fit.vector)
    return Choice(fit, tuple(scores), tuple(recordings[i].name for i in held))


def _parameters(fit: LawFit) -> dict[str, float]:
    specs = (fit.model.friction(fit.vector), *fit.model.effects(fit.vector))
    return {key: float(value) for spec in specs for key, value in spec.parameters.items()}


def _signature(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    return joined_signature({"torque": channel_signature(torque, rate, "torque")})


def _repeats_scale(fit: LawFit, like: Measured, first: int) -> NDArray[np.float64]:
    """Return the standard deviation of each value of the signature over simulated repeats."""
    rig = fit.model.rig(fit.vector)
    repeats = []
    for seed in range(first, first + _REPEATS):
        try:
            repeats.append(_signature(simulated_torque(rig, like, seed=seed)[0], like.rate))
        except ParameterError:
            continue
    spread = np.std(repeats, axis=0, ddof=1)
    # a run that is a little longer or shorter than another, and their error of eight
    typical = float(np.nanmedian(spread))
    return np.asarray(
        np.sqrt(0.7 * spread**2 + 0.3 * typical**2 + _LEAST_SCALE**2) * math.sqrt(1.1)
    )


def _squared(fit: LawFit, one: Measured, scale: NDArray[np.float64]) -> float:
    """Squared distance of a recording from a law, in floors."""
    try:
        torque, _ = simulated_torque(fit.model.rig(fit.vector), one)
    except ParameterError:
        return _HOPELESS**2
    away = _signature(one.torque, one.rate) - _signature(torque, one.rate)
    return float(np.nanmean(group_costs(away / scale)))
