"""Conditions inferred from a segment, with intervals that cover 90 %, or nothing.

A quantile forest gives what is asked for as a distribution. Where to cut its tails is read off
recordings that no tree has seen, one cut for each set of channels, of calibration and of other
conditions that are logged (split conformal prediction on the levels of the distribution: V.
Chernozhukov, K. Wuethrich, Y. Zhu, *Distributional conformal prediction*, PNAS 118, 2021); so the
bolted clamp, which is a place by itself, needs no treatment of its own. Where some of the channels
tell more by themselves than all together, as the torque does of the interference, those are asked.
An interval hardly narrower than what is known beforehand tells nothing, and is none.

What the intervals hold for is written down in `noise.training.inference.population`.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.html_table import html_table
from noise.base.atomic import atomic
from noise.inference.described import KINDS, described, n_described, of_subset, subset_of
from noise.inference.quantile_forest import QuantileForest
from noise.inference.quantities import QUANTITIES, places, value_at

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition

__all__ = ["TELLING", "Inference", "Inferred", "Interval", "load_inference", "others_of"]

TELLING = 0.8
"""An interval as wide as this share of the one known beforehand, or wider, tells nothing."""

_UNITS = {
    "speed": (1.0, "rad/s"), "interference": (1e3, "mm"), "support_stiffness": (1.0, "Nm/rad"),
}  # fmt: skip
_FORMAT = 1
_ARRAYS = tuple(field.name for field in fields(QuantileForest))


@dataclass(frozen=True)
class Interval:
    """A condition as far as the signal tells it, in SI units.

    Parameters
    ----------
    value : float
        As likely too high as too low.
    low, high : float
        Bounds of 90 %; the bolted clamp is ``math.inf``.

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
    >>> "0.279 mm" in found._repr_html_()
    True
    """

    def _repr_html_(self) -> str:
        rows = []
        for name, found in self.items():
            factor, unit = _UNITS[name]
            values = [f"{factor * x:.4g} {unit}" for x in (found.value, found.low, found.high)]
            rows.append([name.replace("_", " "), *values])
        header = ["condition", "value", "lowest", "highest"]
        return html_table("Inferred, with bounds of 90 %", rows, header=header)


@dataclass(frozen=True, eq=False)
class Inference:
    """Quantile forests for the three conditions, and where to cut their tails.

    Parameters
    ----------
    names : tuple of str
        Features in the forests' order, before the logged conditions.
    forests : tuple of QuantileForest
        One for each of `QUANTITIES`.
    prior : ndarray of float32, shape (3, n)
        Values of the population, which join those of the leaves: nothing in it is ruled out.
    asked : ndarray of int16, shape (3, 8, 2, 4)
        By quantity, subset of channels, calibrated or not, and others that are logged: the part
        of the subset that is looked at.
    cuts : ndarray of int16, shape (3, 8, 2, 4, 4)
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
    asked: NDArray[np.int16]
    cuts: NDArray[np.int16]
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
        known = places(logged)
        table = np.array([[features.get(name, np.nan) for name in self.names]])
        found = Inferred()
        for index, name in enumerate(QUANTITIES):
            if not np.isnan(known[index]):
                continue
            case = (index, subset_of(kinds), int(calibrated), others_of(known, index))
            cuts = self.cuts[case]
            if cuts[0] < 0:
                continue
            looked_at = of_subset(table, self.names, int(self.asked[case]))
            values = self.distribution(index, described(looked_at, self.names, known[None, :]))
            if not self.telling(index, values, cuts)[0]:
                continue
            low, high = values[0, cuts[2]], values[0, -1 - cuts[3]]
            middle = min(max(values[0, values.shape[1] // 2], low), high)
            found[name] = Interval(*(value_at(name, float(at)) for at in (middle, low, high)))
        return found

    def distribution(self, index: int, x: NDArray[np.float64]) -> NDArray[np.float32]:
        """Values of a quantity that a sample may have, on its scale and in rising order.

        Parameters
        ----------
        index : int
            Of the quantity.
        x : ndarray, shape (n, n_described)

        Returns
        -------
        ndarray, shape (n, n_values)
        """
        pooled = self.forests[index].pooled(x)
        prior = np.broadcast_to(self.prior[index], (len(x), self.prior.shape[1]))
        return np.sort(np.concatenate([pooled, prior], axis=1), axis=1)

    def telling(
        self, index: int, values: NDArray[np.float32], cuts: NDArray[np.int16]
    ) -> NDArray[np.bool_]:
        """Whether distributions, shape (n, n_values), are narrower than the population's."""
        low, high = np.quantile(self.prior[index], [0.05, 0.95])
        width = values[:, -1 - cuts[1]] - values[:, cuts[0]]
        return np.asarray(width < TELLING * (high - low))

    def _repr_html_(self) -> str:
        from noise.classifier.card import card_html

        return card_html("Inference of " + ", ".join(QUANTITIES), [], self.card)

    def save(self, path: str | Path) -> None:
        """Write the model into an NPZ file, whole or not at all."""
        header = {"format": _FORMAT, "names": self.names, "card": dict(self.card)}
        arrays = {
            f"{name}_{array}": getattr(forest, array)
            for name, forest in zip(QUANTITIES, self.forests, strict=True)
            for array in _ARRAYS
        }
        with atomic(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(
                file,
                header=np.array(json.dumps(header)),
                prior=self.prior,
                asked=self.asked,
                cuts=self.cuts,
                **arrays,
            )


def others_of(known: NDArray[np.float64], index: int) -> int:
    """Return which of the other two quantities are logged, as a number from 0 to 3.

    Examples
    --------
    >>> others_of(np.array([np.nan, 0.279, np.nan]), 0)
    1
    """
    others = np.delete(known, index)
    return sum(1 << bit for bit, place in enumerate(others) if not np.isnan(place))


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
    return _shipped() if path is None else _load(Path(path))


@lru_cache(maxsize=1)
def _shipped() -> Inference:
    with resources.as_file(resources.files("noise.inference") / "data" / "conditions.npz") as path:
        return _load(path)


def _load(path: Path) -> Inference:
    try:
        with np.load(path, allow_pickle=False) as file:
            header = json.loads(str(file["header"]))
            if header["format"] != _FORMAT:
                raise ValueError(f"format {header['format']!r}, expected {_FORMAT}")
            names = tuple(header["names"])
            forests = tuple(
                QuantileForest(**{array: file[f"{name}_{array}"] for array in _ARRAYS})
                for name in QUANTITIES
            )
            prior, asked, cuts = file["prior"], file["asked"], file["cuts"]
        for forest in forests:
            forest.check(n_described(names))
        cases = (len(QUANTITIES), 1 << len(KINDS), 2, 4)
        if prior.shape[:1] != cases[:1] or asked.shape != cases or cuts.shape != (*cases, 4):
            raise ValueError("its arrays do not fit together")
        return Inference(names, forests, prior, asked, cuts, header["card"])
    except FileNotFoundError:
        raise ParameterError(f"{path}: no such file") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise ParameterError(
            f"{path}: no model of conditions that `bushing-noise train` wrote ({error})"
        ) from None
