"""Training of the cause posterior on simulated cases.

The cases are drawn into files first. The shipped trees are grown on all cases. Before, other trees
are grown on four of five rigs; their answers to the cases of the fifth calibrate the probabilities
and set the alarm, over benches of all kinds. Each case is repeated with some of its recordings, and
some cases with some of their channels, so that the posterior is less certain, rather than wrong,
with fewer signals. Each split of a tree chooses from a random part of the columns, since the number
of cases is small.

A file holds the cases of a range of seeds as a joblib pickle. Reading a pickle executes code, so
read only files that you have made.

Most time is spent on simulated repeats of the rig file. The cases of a rig share them where the
difference is below the scatter: where the estimated noise of the sensors and the speeds that follow
from the angle are about equal.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from pickle import UnpicklingError

import joblib
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit

from models.condition import known_condition
from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensors
from noise.base.arrays import Array, Rng
from noise.base.files import atomic, check_target
from noise.base.trees import BoostedTrees
from noise.diagnosis.causes.posterior import CAUSES, Posterior, calibrated, odds_features
from noise.diagnosis.evidence.summary import (
    CaseTable,
    NominalNumbers,
    Numbers,
    case_table,
    evidence,
    scale_of,
)
from noise.diagnosis.prepare import prepared
from noise.diagnosis.simulated.repeats import CHANNELS
from noise.training.causes.cases.draw import SHARED, DrawnCase, Truth, draw_case, visible_through
from noise.training.trees import as_arrays, boosted_nodes
from sim.acquisition import Acquisition

_CERTAIN = 6.0
"""Log odds of a cause that no case has, or all have."""


def grow_cause_trees(
    x: NDArray[np.float32], y: NDArray[np.int64], *, n_rounds: int, seed: int
) -> BoostedTrees:
    """Grow the trees of each cause against all other cases.

    Parameters
    ----------
    x : ndarray of float32, shape (n, n_columns)
        [unit of each column], nothing missing.
    y : ndarray of int, shape (n, n_causes)
        Whether each cause is present.
    n_rounds, seed : int
        Trees per cause, and seed of the random draws.

    Returns
    -------
    BoostedTrees
        Their scores are the log odds of each cause.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> y = rng.integers(2, size=(300, 2))
    >>> x = (rng.normal(size=(300, 3)) + 4.0 * y[:, [0, 1, 1]]).astype(np.float32)
    >>> trees = grow_cause_trees(x, y, n_rounds=20, seed=0)
    >>> (trees.scores(np.array([[4.0, 0.0, 0.0], [0.0, 4.0, 4.0]])) > 0.0).tolist()
    [[True, False], [False, True]]
    """
    # A cause that no case has, or all have, needs no trees.
    base = np.where(y.any(axis=0), _CERTAIN, -_CERTAIN)
    grown = []
    for k in (k for k in range(y.shape[1]) if 0 < y[:, k].sum() < len(y)):
        rounds, (base[k],) = boosted_nodes(
            x, y[:, k], max_iter=n_rounds, learning_rate=0.05, max_leaf_nodes=14,
            min_samples_leaf=8, max_bins=63, max_features=min(80 / x.shape[1], 1.0),
            random_state=seed + k,
        )  # fmt: skip
        grown += [(k, tree) for (tree,) in rounds]
    return as_arrays(grown, base)


FALSE_ALARMS = 0.06
"""Share of cases without a cause that may raise the alarm, by trees that were grown on fewer cases
than the shipped ones [-]. It was chosen on development benches of the second rig, where one in
sixty raised it."""

_FEWEST_RECORDINGS = 3

_POOR = (
    ("pressure",), ("acceleration",), ("acceleration", "pressure"), ("torque",),
    ("torque", "angle"), ("torque", "pressure"), ("pressure", "angle"),
    ("torque", "acceleration", "pressure"),
)  # fmt: skip
"""Sets of channels that users record."""


@dataclass(frozen=True, eq=False)
class Known:
    """Training case with its rig, seed and the departures of its bench from a quiet one."""

    table: CaseTable
    truth: Truth
    rig: int = 0
    departures: tuple[str, ...] = ()
    seed: int = 0


def train_posterior(cases: Sequence[Known], *, seed: int = 0, n_rounds: int = 450) -> Posterior:
    """Grow and calibrate a cause posterior.

    Parameters
    ----------
    cases : sequence of Known
    seed, n_rounds : int
        Seed of all draws; trees per cause.

    Returns
    -------
    Posterior
    """
    names = tuple(sorted({name for case in cases for name in case.table.names}))
    scale = null_scale(cases, names)
    rng = np.random.default_rng(seed)
    rows, truths, rigs, as_drawn = [], [], [], []
    for case in cases:
        for place, copy in enumerate(_copies(case, rng)):
            rows.append(evidence(copy.table, names, scale))
            truths.append(causes_of(copy.truth))
            rigs.append(case.rig)
            as_drawn.append(place == 0)
    x, y = np.array(rows), np.array(truths)
    del rows
    columns = _telling_columns(x, y, seed)
    x = x[:, columns]
    # Every fifth rig is left out for calibration and alarm; the final trees use all rigs.
    held_out = np.unique(rigs, return_inverse=True)[1] % 5 == 0
    unseen = held_out & np.array(as_drawn)
    learned = grow_cause_trees(x[~held_out], y[~held_out], n_rounds=n_rounds, seed=seed)
    odds = learned.scores(x[unseen])
    weights = _fitted_weights(odds, y[unseen])
    without = y[unseen, CAUSES.index("none")] == 1
    alarm = float(np.quantile(calibrated(odds, weights)[without, -1], FALSE_ALARMS))
    return Posterior(
        names=names,
        scale=scale,
        columns=columns,
        trees=grow_cause_trees(x, y, n_rounds=n_rounds, seed=seed),
        weights=weights,
        alarm=min(alarm, 0.5),
        card={"seed": seed, "cases": len(cases), "rounds": n_rounds},
    )


def null_scale(cases: Sequence[Known], names: Sequence[str]) -> Array:
    """Return the scatter of each number in cases without a cause, on quiet benches if possible.

    Returns
    -------
    ndarray, shape (n_names,)
        As `noise.diagnosis.evidence.summary.scale_of` returns it [unit of the number].
    """
    without_cause = [case for case in cases if case.truth.kind == "none"]
    quiet = [case for case in without_cause if not case.departures]
    chosen = quiet if len(quiet) >= 30 else without_cause
    return scale_of([case.table for case in chosen], names)


def _telling_columns(x: NDArray[np.float32], y: NDArray[np.int64], seed: int) -> NDArray[np.int64]:
    """Return the columns with the most splits in a forest of all causes."""
    from sklearn.ensemble import ExtraTreesClassifier

    some = np.random.default_rng(seed).permutation(len(x))[:6000]
    forest = ExtraTreesClassifier(
        80, min_samples_leaf=2, max_features=0.1, n_jobs=-1, random_state=seed
    ).fit(x[some], y[some])
    most = np.argsort(-forest.feature_importances_, kind="stable")[
        :1000
    ]  # other columns only add noise
    return np.sort(most).astype(np.int64)


def _copies(case: Known, rng: Rng) -> Iterator[Known]:
    """Yield a case, then the case with fewer recordings or channels."""
    yield case
    for _ in range(2):
        yield with_fewer(case, rng)
    if rng.random() < 0.3:
        yield with_channels(case, _POOR[int(rng.integers(len(_POOR)))])


def causes_of(truth: Truth) -> NDArray[np.int64]:
    """Return which of `CAUSES` are present."""
    exclusive = truth.kind in ("none", "parameters", "unknown")
    at_work = {truth.kind} if exclusive else set(truth.effects)
    return np.array([int(cause in at_work) for cause in CAUSES])


def with_channels(case: Known, channels: Sequence[str]) -> Known:
    """Return a case with some of its channels only.

    Numbers that need a missing channel are removed. An effect that acts in none of the remaining
    channels is no longer a cause.
    """
    table, truth = case.table, case.truth
    retained = np.array([_is_known(name, channels) for name in table.names])

    def without(rows: Array) -> Array:
        return np.where(retained, rows, np.nan)

    lost = {f"{kind}_{what}" for kind in CHANNELS for what in ("noise", "step")} - {
        f"{kind}_{what}" for kind in channels for what in ("noise", "step")
    }
    bench = {name: value for name, value in table.bench.items() if name not in lost}
    if truth.channels:
        truth = visible_through(truth, truth.channels, channels)
    return replace(case, table=replace(with_rows(table, without), bench=bench), truth=truth)


def with_fewer(case: Known, rng: Rng) -> Known:
    """Return a case with some of its recordings only."""
    table = case.table
    n = len(table.measured)
    if n <= _FEWEST_RECORDINGS:
        return case
    chosen = np.sort(rng.choice(n, int(rng.integers(_FEWEST_RECORDINGS, n)), replace=False))
    conditions = tuple(table.conditions[i] for i in chosen)
    changed = with_rows(table, lambda rows: rows[chosen])
    return replace(case, table=replace(changed, conditions=conditions))


def with_rows(table: CaseTable, change: Callable[[Array], Array]) -> CaseTable:
    """Return a table with the same change of all numbers, arrays of shape (..., n_numbers)."""
    return replace(
        table,
        measured=change(table.measured),
        nominal=change(table.nominal),
        scatter=change(table.scatter),
    )


_OWN = (
    "top", "bottom", "crest", "asymmetry", "skewness", "flat", "dwell", "offset", "floor", "band",
    "raw",
)  # fmt: skip
"""First parts of the names of numbers that need one channel only."""


def _is_known(name: str, channels: Sequence[str]) -> bool:
    kind, _, what = name.partition("_")
    if kind == "contact":
        return "torque" in channels
    if kind == "common":
        return {"torque", "acceleration", "pressure"} <= set(channels)
    if kind not in channels:
        return False
    return kind in ("torque", "angle") or "torque" in channels or what.startswith(_OWN)


def _fitted_weights(odds: Array, y: NDArray[np.int64]) -> Array:
    """Return the weights of a logistic regression per cause, shrunk towards that of all causes."""
    x = odds_features(odds)
    common = _logistic(x.reshape(-1, x.shape[2]), y.reshape(-1), np.zeros(x.shape[2]), 1e-6)
    return np.array([_logistic(x[:, k], y[:, k], common, 1e-2 * len(y)) for k in range(y.shape[1])])


def _logistic(x: Array, y: NDArray[np.int64], prior: Array, stiffness: float) -> Array:
    """Return the weights of a logistic regression with a ridge towards `prior`."""

    def cost(w: Array) -> tuple[float, Array]:
        odds = np.clip(x @ w, -30.0, 30.0)
        loss = float(np.sum(np.logaddexp(0.0, odds) - y * odds))
        away = w - prior
        gradient = x.T @ (expit(odds) - y) + stiffness * away
        return loss + 0.5 * stiffness * float(away @ away), gradient

    return np.asarray(minimize(cost, prior, jac=True, method="BFGS", tol=1e-8).x)


def known_cases_of_a_rig(seeds: Sequence[int]) -> list[Known]:
    """Draw and summarise cases of one rig, without those that cannot be simulated.

    Examples
    --------
    >>> cases = known_cases_of_a_rig([400_000])
    >>> all(case.table.measured.shape == case.table.nominal.shape for case in cases)
    True
    """
    shared: list[_Shared] = []
    known = []
    for seed in seeds:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # truncated responses warn in each case
                case = draw_case(seed)
                table = _table(case, shared)
        except BushingNoiseError:
            continue
        if table is not None:
            # Single precision halves the files and leaves the cases equal.
            single = with_rows(table, lambda x: x.astype(np.float32).astype(np.float64))
            known.append(Known(single, case.truth, seed // SHARED, case.departures, seed))
    return known


def _table(case: DrawnCase, shared: list[_Shared]) -> CaseTable | None:
    """Return the table of a case, with the repeats of earlier cases where these apply."""
    rig, recordings, _, _ = prepared(case.rig, case.recordings)
    if len(recordings) < 2:
        return None
    repeats = next((s for s in shared if s.serves(rig)), None)
    if repeats is None:
        repeats = _Shared(rig)
        shared.append(repeats)
    return case_table(recordings, repeats.rig, nominal=repeats)


@dataclass(frozen=True, eq=False)
class _Shared(NominalNumbers):
    """Simulated repeats that several cases of a rig share, and their speeds."""

    speeds: dict[tuple[object, ...], list[float]] = field(default_factory=dict)

    def serves(self, rig: Rig) -> bool:
        """Return whether a rig is equal but for small differences of estimated noise."""
        same = replace(rig, sensors=self.rig.sensors) == self.rig
        return same and _alike(self.rig.sensors, rig.sensors)

    def moments(self, recording: Recording) -> tuple[Numbers, Numbers]:
        """Return mean and standard deviation of repeats, at a stored speed if one is close."""
        c = known_condition(recording.condition)
        known = self.speeds.setdefault((c.interference, c.support_stiffness), [])
        near = min(known, key=lambda v: abs(v - c.speed), default=math.inf)
        if abs(near - c.speed) > 8e-3 * abs(c.speed):
            known.append(c.speed)
            near = c.speed
        return super().moments(replace(recording, condition=replace(c, speed=near)))


def _alike(one: Sensors, other: Sensors) -> bool:
    """Return whether sensors are equal but for small differences of estimated noise and steps."""
    for kind, usual in Acquisition().noise.items():
        a, b = one.of(kind), other.of(kind)
        if (a.bits, a.antialias) != (b.bits, b.antialias) or not math.isclose(a.step, b.step):
            return False
        levels = [usual if sensor.noise is None else sensor.noise for sensor in (a, b)]
        least = 0.1 * a.step  # smaller differences are lost in the rounding
        if not math.isclose(*levels, rel_tol=0.2, abs_tol=least):
            return False
    return True


CHUNK = 40 * SHARED
"""Seeds per file."""


def draw_into(folder: Path, seeds: range, workers: int = 1) -> Iterator[Path]:
    """Draw cases into files of a folder.

    Parameters
    ----------
    folder : Path
    seeds : range
        The first is a multiple of `SHARED`.
    workers : int
        Number of processes.

    Yields
    ------
    Path
        Path of each file, as soon as it is written.

    Raises
    ------
    ParameterError
        If the folder cannot be written to.
    """
    check_target(folder / "cases", "--out")
    chunks = [seeds[i : i + CHUNK] for i in range(0, len(seeds), CHUNK)]
    yield from joblib.Parallel(n_jobs=workers, return_as="generator_unordered")(
        joblib.delayed(_draw_chunk)(folder, chunk) for chunk in chunks
    )


def _draw_chunk(folder: Path, seeds: range) -> Path:
    path = folder / f"cases-{seeds.start}-{seeds.stop}.joblib"
    rigs = (seeds[i : i + SHARED] for i in range(0, len(seeds), SHARED))
    cases = [case for rig in rigs for case in known_cases_of_a_rig(rig)]
    with atomic(path) as passing:
        joblib.dump(cases, passing, compress=3)
    return path


def load_cases(folder: Path) -> list[Known]:
    """Read the cases of all files of a folder, in the order of their seeds.

    Raises
    ------
    ParameterError
        If there are no such files, or one is damaged.
    """
    paths = sorted(folder.glob("cases-*.joblib"))
    if not paths:
        raise ParameterError(f"{folder}: no cases-*.joblib; draw some first")
    try:
        cases = [case for path in paths for case in joblib.load(path)]
    except (OSError, ValueError, EOFError, LookupError, AttributeError, UnpicklingError) as error:
        raise ParameterError(f"{folder}: a file of drawn cases is damaged ({error})") from error
    return sorted(cases, key=lambda case: case.seed)
