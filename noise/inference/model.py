"""Model that infers conditions of a segment with intervals of 90 %.

A quantile forest predicts the distribution of a condition. The share of it outside of the interval
is calibrated on recordings that were not used to grow trees, for each set of channels, with and
without calibration, and for each set of logged conditions (split conformal prediction: V.
Chernozhukov, K. Wuethrich, Y. Zhu, *Distributional conformal prediction*, PNAS 118, 2021). So the
bolted clamp, a separate point, needs no special treatment. If a subset of the channels gives a
narrower interval than all, as the torque does for the interference, only the subset is used. An
interval hardly narrower than that of the population is not reported.

Speed and support stiffness are scaled by their logarithm, the interference is not. The bolted clamp
has infinite stiffness, so it is a separate point at the upper end of the scale: an interval that
reaches it reads "from 5000 Nm/rad up to the bolted clamp". With a logged speed, the number of slips
per radian depends on torque and stiffness alone. It is a feature of its own because trees
approximate quotients poorly.

The intervals hold for the population of `noise.training.inference`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from features.table import recording_features
from models.condition import FIXED, Condition
from models.show import short_repr
from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.trees import QuantileForest

if TYPE_CHECKING:
    from models.recording import RecordingBlocks

_NARROWER = 0.8
"""Maximum width of a reported interval, as a share of that of the population [-]; assumed."""

INFERENCE = ModelKind(
    "model of conditions", 1, "noise.train_inference",
    ("noise.inference", "conditions.npz"),
)  # fmt: skip


@dataclass(frozen=True)
class Interval:
    """Interval of an inferred condition, in SI units.

    Parameters
    ----------
    value : float
        Median [rad/s], [m] or [Nm/rad].
    low, high : float
        Bounds of the 90 % interval, in the same unit; the bolted clamp is ``math.inf``.

    Examples
    --------
    >>> speed = Interval(5.0, 4.1, 6.3)
    >>> speed.low <= speed.value <= speed.high
    True
    """

    value: float
    low: float
    high: float


@short_repr
@dataclass(frozen=True, eq=False)
class Inference:
    """Quantile forests for the three conditions, with calibrated intervals.

    Parameters
    ----------
    names : tuple of str
        Features of the forests, before the logged conditions.
    forests : tuple of QuantileForest
        One for each of `QUANTITIES`.
    prior : ndarray of float32, shape (3, n)
        Values of the population, which are added to those of the leaves, so that no value of it
        is ruled out [on the scale of each quantity].
    used : ndarray of int16, shape (3, 8, 2, 4)
        By quantity, subset of channels, calibration and other logged conditions: the part of the
        subset that is used, by `noise.inference.model.subset_of`.
    outside : ndarray of int16, shape (3, 8, 2, 4, 4)
        Likewise, the numbers of lowest and highest values outside of the interval: two over all
        recordings, which decide whether an interval is reported, then two over those with an
        interval. -1 if an interval is never reported.
    card : mapping
        Summary of the training: seed, counts, coverage.

    Examples
    --------
    >>> load_inference().prior.shape[0] == len(QUANTITIES)
    True
    """

    names: tuple[str, ...]
    forests: tuple[QuantileForest, ...]
    prior: NDArray[np.float32]
    used: NDArray[np.int16]
    outside: NDArray[np.int16]
    card: Mapping[str, object]

    def infer(
        self,
        features: Mapping[str, float],
        logged: Condition,
        *,
        kinds: Sequence[str],
        calibrated: bool,
    ) -> dict[str, Interval]:
        """Return inferred conditions of a segment that are not logged.

        Parameters
        ----------
        features : mapping of str to float
            Features of the segment, from `features.recording_features` [unit of each].
        logged : Condition
            Logged conditions.
        kinds : sequence of str
            Kinds of the recorded channels.
        calibrated : bool
            Whether the samples are in physical units.

        Returns
        -------
        dict of str to Interval
            By `QUANTITIES`, without logged conditions and those without
            a narrow interval.

        Examples
        --------
        >>> from models.condition import Condition
        >>> load_inference().infer({}, Condition(), kinds=["angle"], calibrated=True)
        {}
        """
        known = scaled(logged)
        table = np.array([[features.get(name, np.nan) for name in self.names]])
        inferred: dict[str, Interval] = {}
        for index, name in enumerate(QUANTITIES):
            if not np.isnan(known[index]):
                continue
            case = (index, subset_of(kinds), int(calibrated), others_of(known, index))
            outside = self.outside[case]
            if outside[0] < 0:
                continue
            table_of_used = of_channels(table, self.names, int(self.used[case]))
            values = self.distribution(
                index, segment_features(table_of_used, self.names, known[None, :])
            )
            if not self.is_narrow(index, values, outside)[0]:
                continue
            low, high = values[0, outside[2]], values[0, -1 - outside[3]]
            middle = min(max(values[0, values.shape[1] // 2], low), high)
            inferred[name] = Interval(*(unscaled(name, float(at)) for at in (middle, low, high)))
        return inferred

    def distribution(self, index: int, x: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return the predicted distributions of a quantity as sorted values on its scale.

        Parameters
        ----------
        index : int
            Index of the quantity.
        x : ndarray, shape (n, n_segment_features)
            [unit of each feature]

        Returns
        -------
        ndarray of float32, shape (n, n_values)
            [on the scale of the quantity]
        """
        pooled = self.forests[index].pooled(x)
        prior = np.broadcast_to(self.prior[index], (len(x), self.prior.shape[1]))
        return np.sort(np.concatenate([pooled, prior], axis=1), axis=1)

    def is_narrow(
        self, index: int, values: NDArray[np.float32], outside: NDArray[np.int16]
    ) -> NDArray[np.bool_]:
        """Whether distributions, shape (n, n_values), are narrower than that of the population."""
        low, high = np.quantile(self.prior[index], [0.05, 0.95])
        width = values[:, -1 - outside[1]] - values[:, outside[0]]
        return np.asarray(width < _NARROWER * (high - low))

    def save(self, path: str | Path) -> None:
        """Write the model to an NPZ file atomically.

        Raises
        ------
        ParameterError
            The file cannot be written.
        """
        arrays: dict[str, NDArray[Any]] = {
            "prior": self.prior, "asked": self.used, "cuts": self.outside
        }  # fmt: skip
        for quantity, forest in zip(QUANTITIES, self.forests, strict=True):
            arrays |= {f"{quantity}_{name}": array for name, array in forest.arrays().items()}
        save_model(path, INFERENCE, {"names": self.names, "card": dict(self.card)}, arrays)


def load_inference(path: str | Path | None = None) -> Inference:
    """Load a model, by default the shipped one.

    Parameters
    ----------
    path : path-like, optional
        NPZ file of `Inference.save`.

    Returns
    -------
    Inference

    Raises
    ------
    ParameterError
        The file was not written by `Inference.save`.

    Examples
    --------
    >>> load_inference().card["seed"]
    0
    """
    return load_model(path, INFERENCE, _built)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Inference:
    names = tuple(header["names"])
    forests = []
    for quantity in QUANTITIES:
        prefix = f"{quantity}_"
        of_one = {k.removeprefix(prefix): a for k, a in arrays.items() if k.startswith(prefix)}
        forests.append(QuantileForest.of_arrays(of_one))
        forests[-1].check(n_segment_features(names))
    prior, used, outside = arrays["prior"], arrays["asked"], arrays["cuts"]
    cases = (len(QUANTITIES), 1 << len(KINDS), 2, 4)
    if prior.shape[:1] != cases[:1] or used.shape != cases or outside.shape != (*cases, 4):
        raise ValueError("its arrays do not fit together")
    return Inference(names, tuple(forests), prior, used, outside, header["card"])


def infer_stretch(
    blocks: RecordingBlocks, first: int, last: int, logged: Condition, inference: Inference
) -> dict[str, Interval]:
    """Return inferred conditions of a stretch with a creak, squawk or squeal.

    Parameters
    ----------
    blocks : RecordingBlocks
    first, last : int
        Range of samples of the stretch; of more than 1 s the middle is used.
    logged : Condition
    inference : Inference

    Returns
    -------
    dict of str to Interval
        As from `Inference.infer`; empty if the intervals do not hold for the recording: it is too
        short, its sampling rate too low, or its material another.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.rig_file import load_material_rig
    >>> from noise.inference import load_inference
    >>> from models.recording import RecordingBlocks
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon"), 1.0, interference=0.381e-3)
    >>> blocks = RecordingBlocks.of(run.recording)
    >>> found = infer_stretch(blocks, 0, blocks.n_samples, Condition(), load_inference())
    >>> found["interference"].low < 0.381e-3 < found["interference"].high
    True
    """
    kinds = [kind for kind in KINDS if blocks.first(kind) is not None]
    if not kinds or blocks.rate < min(RATES) or last - first < SHORTEST * blocks.rate:
        return {}
    if (logged.material or MATERIAL).lower() != MATERIAL:
        return {}
    spare = max(0, last - first - round(LONGEST * blocks.rate))
    middle = blocks.cut(first + spare // 2, last - (spare - spare // 2))
    return inference.infer(
        recording_features(middle), logged, kinds=kinds, calibrated=blocks.calibrated
    )


MATERIAL = "fluorocarbon"
"""Material of the bushings for which the intervals hold."""

SPEED_RANGE = (0.1, 15.0)
"""Range of the speed of the shaft [rad/s]; includes that of the thesis; assumed."""

INTERFERENCE_RANGE = (0.15e-3, 0.42e-3)
"""Range of the interference [m]; includes the 0.178 to 0.381 mm of the thesis; assumed."""

SUPPORT_RANGE = (1e3, 1e4)
"""Range of the support stiffness [Nm/rad]; includes the 2214 and 3745 of the thesis; assumed."""

SHORTEST, LONGEST = 0.25, 1.0
"""Minimum and maximum duration of a described stretch [s]; assumed."""

RATES = (16_000, 22_050, 30_000, 44_100, 48_000)
"""Sampling rates of recordings in training [Hz]."""

QUANTITIES = ("speed", "interference", "support_stiffness")
"""Fields of `models.condition.Condition`, in the order of all arrays."""

KINDS = ("pressure", "acceleration", "torque")
"""Kinds of channel with features, in the order of the bits that number their subsets."""

_SLIPS_A_SECOND = (
    "pressure_fundamental",
    "pressure_pulse_rate",
    "acceleration_fundamental",
    "acceleration_pulse_rate",
    "torque_fundamental",
    "torque_slip_rate",
)
"""Features that are slip rates [Hz]."""

_FIXED = 10.0
"""Scaled support stiffness of the bolted clamp; others end at 9.2 [-]; assumed."""


_RANGES = {
    "speed": SPEED_RANGE, "interference": INTERFERENCE_RANGE, "support_stiffness": SUPPORT_RANGE,
}  # fmt: skip


def scaled(condition: Condition) -> NDArray[np.float64]:
    """Return a condition on the scales of `QUANTITIES`.

    Parameters
    ----------
    condition : Condition

    Returns
    -------
    ndarray, shape (3,)
        Logarithm of the speed in rad/s [-], interference [mm], logarithm of the support stiffness
        in Nm/rad [-]; NaN if unknown.

    Examples
    --------
    >>> from models.condition import Condition
    >>> scaled(Condition(speed=-1.0, interference=0.279e-3, support_stiffness=FIXED)).tolist()
    [0.0, 0.279, 10.0]
    """
    speed, interference, support = (getattr(condition, name) for name in QUANTITIES)
    return np.array(
        [
            math.log(abs(speed)) if speed else math.nan,
            math.nan if interference is None else 1e3 * interference,
            math.nan if not support else min(math.log(support), _FIXED),
        ]
    )


def unscaled(name: str, point: float) -> float:
    """Return the value of a scaled quantity, limited to its range.

    Parameters
    ----------
    name : str
        One of `QUANTITIES`.
    point : float
        Scaled value, as from `scaled` [-] or [mm].

    Returns
    -------
    float
        [rad/s], [m] or [Nm/rad]

    Examples
    --------
    >>> unscaled("interference", 0.279), unscaled("support_stiffness", 10.0)
    (0.000279, inf)
    """
    low, high = _RANGES[name]
    if name == "support_stiffness" and point >= _FIXED:
        return FIXED
    value = 1e-3 * point if name == "interference" else math.exp(point)
    return min(max(value, low), high)


def segment_features(
    table: NDArray[np.float64], names: Sequence[str], known: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return features of segments joined with logged conditions and slips per radian.

    Parameters
    ----------
    table : ndarray, shape (n, n_names)
        Features of segments [unit of each feature].
    names : sequence of str
        Names of the columns, as from `features.table.recording_feature_names`.
    known : ndarray, shape (n, 3)
        Conditions as from `scaled` [-, mm, -], NaN if not logged.

    Returns
    -------
    ndarray, shape (n, n_segment_features)
        [unit of each feature]

    Examples
    --------
    >>> known = np.array([[0.7, 0.279, np.nan]])
    >>> segment_features(np.array([[50.0]]), ["torque_slip_rate"], known).round(2)
    array([[50.  ,  0.7 ,  0.28,   nan, 24.83]])
    """
    rates = [names.index(name) for name in _SLIPS_A_SECOND if name in names]
    return np.concatenate([table, known, table[:, rates] * np.exp(-known[:, :1])], axis=1)


def n_segment_features(names: Sequence[str]) -> int:
    """Return the number of columns of `segment_features`.

    Examples
    --------
    >>> n_segment_features(["torque_slip_rate"])
    5
    """
    return len(names) + 3 + sum(name in names for name in _SLIPS_A_SECOND)


def of_channels(
    table: NDArray[np.float64], names: Sequence[str], subset: int | NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return features in which those of channels outside a subset are NaN.

    Parameters
    ----------
    table : ndarray, shape (n, n_names)
        [unit of each feature]
    names : sequence of str
    subset : int or ndarray of int, shape (n,)
        Number from `subset_of`, one for all samples or one for each.

    Returns
    -------
    ndarray, shape (n, n_names)
        [unit of each feature]

    Examples
    --------
    >>> of_channels(np.ones((1, 2)), ["pressure_crest", "torque_mean"], subset_of(["torque"]))
    array([[nan,  1.]])
    """
    bits = np.array([KINDS.index(name.partition("_")[0]) for name in names])
    retained = np.atleast_1d(subset)[:, None] >> bits & 1
    return np.where(retained.astype(bool), table, np.nan)


def subset_of(kinds: Sequence[str]) -> int:
    """Return the number of a subset of `KINDS`.

    Examples
    --------
    >>> subset_of(["pressure", "angle"]), subset_of(KINDS)
    (1, 7)
    """
    return sum(1 << bit for bit, kind in enumerate(KINDS) if kind in kinds)


def others_of(known: NDArray[np.float64], index: int) -> int:
    """Return the number, 0 to 3, of the set of other quantities that are logged.

    Parameters
    ----------
    known : ndarray, shape (3,)
        Condition as from `scaled` [-, mm, -].
    index : int
        Index of the inferred quantity.

    Examples
    --------
    >>> others_of(np.array([np.nan, 0.279, np.nan]), 0)
    1
    """
    others = np.delete(known, index)
    return sum(1 << bit for bit, point in enumerate(others) if not np.isnan(point))
