"""Model that infers conditions of a segment with intervals of 90 %.

A quantile forest predicts the distribution of a condition. The share of it outside of the interval
is calibrated on recordings that were not used to grow trees, for each set of channels, with and
without calibration, and for each set of logged conditions (split conformal prediction: V.
Chernozhukov, K. Wuethrich, Y. Zhu, *Distributional conformal prediction*, PNAS 118, 2021). So the
bolted clamp, a separate point, needs no special treatment. If a subset of the channels gives a
narrower interval than all, as the torque does for the interference, only the subset is used. An
interval hardly narrower than that of the population is not reported.

The intervals hold for the population of `noise.training.inference`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from features.recording import recording_features
from models.condition import Condition
from models.show import short_repr
from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.trees import QuantileForest
from noise.inference.inputs import (
    KINDS,
    LONGEST,
    MATERIAL,
    QUANTITIES,
    RATES,
    SHORTEST,
    n_segment_features,
    of_channels,
    others_of,
    scaled,
    segment_features,
    subset_of,
    unscaled,
)

if TYPE_CHECKING:
    from models.blocks import RecordingBlocks


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


class Inferred(dict[str, Interval]):
    """Inferred conditions of a segment by name.

    Examples
    --------
    >>> found = Inferred(interference=Interval(0.279e-3, 0.25e-3, 0.31e-3))
    >>> found["interference"].high
    0.00031
    """


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
        subset that is used, by `noise.inference.inputs.subset_of`.
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
    ) -> Inferred:
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
        Inferred
            Dict of str to Interval, by `QUANTITIES`, without logged conditions and those without
            a narrow interval.

        Examples
        --------
        >>> from models.condition import Condition
        >>> load_inference().infer({}, Condition(), kinds=["angle"], calibrated=True)
        {}
        """
        known = scaled(logged)
        table = np.array([[features.get(name, np.nan) for name in self.names]])
        inferred = Inferred()
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
) -> Inferred:
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
    Inferred
        As from `Inference.infer`; empty if the intervals do not hold for the recording: it is too
        short, its sampling rate too low, or its material another.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.rig_file import load_material_rig
    >>> from noise.inference import load_inference
    >>> from models.blocks import RecordingBlocks
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon"), 1.0, interference=0.381e-3)
    >>> blocks = RecordingBlocks.of(run.recording)
    >>> found = infer_stretch(blocks, 0, blocks.n_samples, Condition(), load_inference())
    >>> found["interference"].low < 0.381e-3 < found["interference"].high
    True
    """
    kinds = [kind for kind in KINDS if blocks.first(kind) is not None]
    if not kinds or blocks.rate < min(RATES) or last - first < SHORTEST * blocks.rate:
        return Inferred()
    if (logged.material or MATERIAL).lower() != MATERIAL:
        return Inferred()
    spare = max(0, last - first - round(LONGEST * blocks.rate))
    middle = blocks.cut(first + spare // 2, last - (spare - spare // 2))
    return inference.infer(
        recording_features(middle), logged, kinds=kinds, calibrated=blocks.calibrated
    )
