"""Inference of conditions from a segment, with intervals that cover 90 %, or nothing.

A quantile forest gives what is asked for as a distribution. How much of it lies outside of the
interval is calibrated on recordings that no tree has seen, for each set of channels, of calibration
and of other conditions that are logged (split conformal prediction on the levels of the
distribution: V. Chernozhukov, K. Wuethrich, Y. Zhu, *Distributional conformal prediction*, PNAS
118, 2021); so the bolted clamp, which is a point by itself, needs no treatment of its own. Where
some of the channels give a narrower interval than all together, as the torque does for the
interference, only those count. An interval hardly narrower than what is known beforehand is none.

The population that the intervals hold for is that of `noise.training.inference.population`.
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
"""An interval as wide as this share of the one known beforehand, or wider, is none [-];
assumed."""

INFERENCE = ModelKind(
    "model of conditions", 1, "bushing-noise train --inference",
    ("noise.inference", "conditions.npz"),
)  # fmt: skip


@dataclass(frozen=True)
class Interval:
    """A condition as far as the signal tells it, in SI units.

    Parameters
    ----------
    value : float
        As likely too high as too low [rad/s], [m] or [Nm/rad].
    low, high : float
        Bounds of 90 %, in the same unit; the bolted clamp is ``math.inf``.

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
    """Conditions that a segment tells of, by name.

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
        Features in the forests' order, before the logged conditions.
    forests : tuple of QuantileForest
        One for each of `QUANTITIES`.
    prior : ndarray of float32, shape (3, n)
        Values of the population [on the scale of each quantity], which join those of the leaves:
        nothing in it is ruled out.
    used : ndarray of int16, shape (3, 8, 2, 4)
        By quantity, subset of channels, calibrated or not, and others that are logged: the part
        of the subset that counts, as `noise.inference.inputs.subset_of` numbers it.
    outside : ndarray of int16, shape (3, 8, 2, 4, 4)
        Likewise, how many of the lowest and highest values lie outside, first over all
        recordings, by which it is decided whether there is an interval, then over those for which
        there is. -1 where there is never one.
    card : mapping
        How it was trained: seed, counts, coverage.

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
        """Infer what is not logged.

        Parameters
        ----------
        features : mapping of str to float
            Of a segment, as `features.recording_features` gives them.
        logged : Condition
            What is known.
        kinds : sequence of str
            Of the channels that the features are of.
        calibrated : bool
            Whether the samples are in physical units.

        Returns
        -------
        Inferred
            A dict of str to Interval, by `QUANTITIES`; those that are logged, and those that the
            signal does not tell, are left out.

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
        """Values of a quantity that a sample may have, on its scale and in rising order.

        Parameters
        ----------
        index : int
            Of the quantity.
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
        """Whether distributions, shape (n, n_values), are narrower than the population's."""
        low, high = np.quantile(self.prior[index], [0.05, 0.95])
        width = values[:, -1 - outside[1]] - values[:, outside[0]]
        return np.asarray(width < _NARROWER * (high - low))

    def save(self, path: str | Path) -> None:
        """Write the model into an NPZ file, whole or not at all.

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
    """Load a model, by default the one that is shipped.

    Parameters
    ----------
    path : path-like, optional
        NPZ file that `Inference.save` wrote.

    Returns
    -------
    Inference

    Raises
    ------
    ParameterError
        If the file is none that `Inference.save` wrote.

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
    """Infer what is not logged of a stretch that creaks, squawks or squeals.

    Parameters
    ----------
    blocks : RecordingBlocks
    first, last : int
        The stretch from sample `first` up to `last`; of a longer one than 1 s the middle counts.
    logged : Condition
    inference : Inference

    Returns
    -------
    Inferred
        As `Inference.infer` gives it; nothing where the recording is none of those that the
        intervals hold for: shorter, sampled more slowly, or of another material.

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
