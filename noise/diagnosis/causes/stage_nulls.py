"""What numbers and stages differ by where nothing is the matter, as simulated cases show it.

A p-value of a stage is the share of cases without a cause in which a difference is as surprising
as its most surprising one. A few numbers have long tails in such cases, as what a converter's steps
or a start do to them; so each number is as surprising as its own tail says, a power law through two
of its quantiles, and none hides the others.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from noise.base.model_file import ModelKind, load_model, save_model
from noise.diagnosis.evidence.evidence import deviations, standard_errors
from sim.effects.effect import Stage

if TYPE_CHECKING:
    from noise.diagnosis.evidence.summary import CaseTable


STAGES = tuple(stage.value for stage in Stage)
"""In the order of the chain."""

_KIND = ModelKind(
    "stage nulls", 1, "python -m noise.training.causes stages FOLDER --out",
    ("noise.diagnosis", "stages.npz"),
)  # fmt: skip

_ARRAYS = ("scale", "usual", "seldom", "typical", "largest")

_USUAL, _SELDOM = 0.9, 0.995
"""Shares of cases without a cause in which a number differs by less: the two quantiles."""

_LEAST_USUAL = 0.5
"""Of the first of them, in standard errors; assumed."""

_NARROWEST = 1.4
"""Ratio of the two at least; a tail is no steeper than that; assumed."""

_KEPT = 1000
"""Quantiles of largest surprises that are kept."""

_HEALTH = (
    "top", "bottom", "crest", "asymmetry", "flat", "dwell", "offset", "floor", "hum", "low_floor",
    "high_floor", "delay", "phase_match", "raw",
)  # fmt: skip
"""Numbers that tell a sensor's fault rather than the rig's."""

_OVERALL = ("band", "level", "raw", "skewness")
"""Numbers that a channel has of all that comes before it: with a torque to compare with, they tell
nothing of the channel's own stage."""


@dataclass(frozen=True, eq=False)
class StageNulls:
    """Differences in cases without a cause.

    Parameters
    ----------
    names : tuple of str
        Numbers of a recording.
    scale : ndarray, shape (n_names,)
        Scatter of each without a cause [unit of the number].
    usual, seldom : ndarray, shape (n_names,)
        Quantiles of what each differs by In standard errors [-].
    typical : ndarray, shape (n_stages,)
        Median of the largest size of a stage [-].
    largest : ndarray, shape (n_quantiles, n_stages)
        Largest surprises of each stage, each column rising [-].
    """

    names: tuple[str, ...]
    scale: NDArray[np.float64]
    usual: NDArray[np.float64]
    seldom: NDArray[np.float64]
    typical: NDArray[np.float64]
    largest: NDArray[np.float64]

    def sizes(self, table: CaseTable) -> NDArray[np.float64]:
        """Size of the mean difference of each number.

        Parameters
        ----------
        table : CaseTable

        Returns
        -------
        ndarray, shape (n_names,)
            In what it seldom differs by [-]; NaN where it tells nothing.
        """
        return np.asarray(_errors(table, self.names, self.scale) / self.seldom)

    def surprises(self, table: CaseTable) -> NDArray[np.float64]:
        """How surprising the mean difference of each number is.

        Parameters
        ----------
        table : CaseTable

        Returns
        -------
        ndarray, shape (n_names,)
            Negative logarithm of the share of cases without a cause that differ by as much, as
            their tail has it [-], 0 at least; NaN where it tells nothing.
        """
        return _surprises(_errors(table, self.names, self.scale), self.usual, self.seldom)

    def save(self, path: str | Path) -> None:
        """Write them into an NPZ file, whole or not at all.

        Raises
        ------
        ParameterError
            The file cannot be written.
        """
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        save_model(path, _KIND, {"names": self.names}, arrays)


def load_stage_nulls(path: str | Path | None = None) -> StageNulls:
    """Load what stages differ by, by default what is shipped.

    Raises
    ------
    ParameterError
        If the file is none that `StageNulls.save` wrote.
    """
    return load_model(path, _KIND, _built)


def learn_stage_nulls(
    tables: Sequence[CaseTable], names: Sequence[str], scale: NDArray[np.float64]
) -> StageNulls:
    """Learn from cases without a cause what they differ by.

    Parameters
    ----------
    tables : sequence of CaseTable
    names : sequence of str
    scale : ndarray, shape (n_names,)
        As of `StageNulls` [unit of the number].
    """
    errors = np.array([_errors(table, names, scale) for table in tables])
    stages = np.array([stage_of(name) for name in names])

    def of_stages(rows: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([[largest_of(row[stages == stage]) for stage in STAGES] for row in rows])

    # Cases that a tail is learned from surprise it less than others do.
    halves = (errors[::2], errors[1::2])
    surprises = np.concatenate(
        [of_stages(_surprises(one, *_tails(other))) for one, other in (halves, halves[::-1])]
    )
    usual, seldom = _tails(errors)
    typical = np.median(of_stages(errors / seldom), axis=0)
    shares = np.linspace(0.0, 1.0, min(len(surprises), _KEPT))
    return StageNulls(
        tuple(names), scale, usual, seldom, np.maximum(typical, 1e-3),
        np.quantile(surprises, shares, axis=0),
    )  # fmt: skip


def _tails(errors: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two quantiles of each number."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that no table has
        usual, seldom = np.nanquantile(errors, (_USUAL, _SELDOM), axis=0)
    usual = np.maximum(np.nan_to_num(usual, nan=1.0), _LEAST_USUAL)
    return usual, np.maximum(np.nan_to_num(seldom, nan=1.0), _NARROWEST * usual)


def _surprises(
    errors: NDArray[np.float64], usual: NDArray[np.float64], seldom: NDArray[np.float64]
) -> NDArray[np.float64]:
    slopes = math.log((1.0 - _USUAL) / (1.0 - _SELDOM)) / np.log(seldom / usual)
    away = slopes * np.log(np.maximum(errors, 1e-12) / usual) - math.log(1.0 - _USUAL)
    return np.asarray(np.maximum(away, 0.0))


def largest_of(sizes: NDArray[np.float64]) -> float:
    """Return the largest of those that are known, 0 where none is [-].

    Parameters
    ----------
    sizes : ndarray, shape (n,)
        [-]
    """
    known = sizes[np.isfinite(sizes)]
    return float(known.max()) if known.size else 0.0


def stage_of(name: str) -> str:
    """Stage that a number tells of.

    Examples
    --------
    >>> stage_of("contact_peak"), stage_of("pressure_gain_4"), stage_of("pressure_hum_50")
    ('friction', 'radiation', 'measurement')
    """
    kind, _, what = name.partition("_")
    if kind == "angle":
        return "drive"
    if what.startswith(_HEALTH):
        return "measurement"
    return {"acceleration": "structure", "pressure": "radiation", "common": "structure"}.get(
        kind, "friction"
    )


def _errors(
    table: CaseTable, names: Sequence[str], scale: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Size of each mean difference in standard errors; NaN where it tells nothing."""
    z = deviations(table, names, scale)
    errors = np.where(np.isfinite(z).any(axis=0), np.abs(standard_errors(z)), np.nan)
    if any(name.startswith("contact") for name in table.names):
        errors[[_is_overall(name) for name in names]] = np.nan
    return np.asarray(errors)


def _is_overall(name: str) -> bool:
    kind, _, what = name.partition("_")
    return kind in ("acceleration", "pressure") and what.startswith(_OVERALL)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> StageNulls:
    own = {name: arrays[name] for name in _ARRAYS}
    n = len(header["names"])
    if any(own[name].shape != (n,) for name in ("scale", "usual", "seldom")):
        raise ValueError("its arrays do not fit together")
    return StageNulls(names=tuple(header["names"]), **own)
