"""Location of a gap: stage by stage, each fed with what was measured before it.

The contact is rebuilt from the measured torque, the structure is driven by it, the sound is
predicted from it, the shaft's motion is read off its angle. So an error of one stage does not show
in the next ones, but for the loop through which drive and contact hang together. Each number of a
recording belongs to a stage, a channel, a band or a phase of the cycle; how unlikely its difference
is follows from the largest one that cases without a cause have in that stage, which corrects for
the number of looks.

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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from noise.base.model_file import ModelKind, load_model, save_model
from noise.diagnosis.evidence.channel_summary import BAND_EDGES
from noise.diagnosis.evidence.summary import CaseTable, deviations, standard_errors
from noise.diagnosis.outcome import LARGEST_GAP, SURE, Location, StageFinding
from sim.effects.effect import Stage

STAGES = tuple(stage.value for stage in Stage)
"""In the order of the chain."""

_KIND = ModelKind(
    "stage nulls", 1, "python -m noise.training.causes train FOLDER --out causes.npz --stages",
    ("noise.diagnosis", "stages.npz"),
)  # fmt: skip

_ARRAYS = ("scale", "usual", "seldom", "typical", "largest")

_USUAL, _SELDOM = 0.9, 0.995
"""Shares of cases without a cause in which a number differs by less: the two quantiles."""

_LEAST_USUAL = 0.5
"""Of the first of them, in standard errors; assumed."""

_NARROWEST = 1.4
"""Ratio of the two at least; a tail is no steeper than that; assumed."""

_N_SHARES = 1000
"""Quantiles of the largest surprises in the model file."""

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
    """Distribution of differences in cases without a cause.

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
        """Return the size of the mean difference of each number.

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
        """Return the surprise of the mean difference of each number.

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
        """Write the distributions to an NPZ file, whole or not at all.

        Raises
        ------
        ParameterError
            The file cannot be written.
        """
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        save_model(path, _KIND, {"names": self.names}, arrays)


def load_stage_nulls(path: str | Path | None = None) -> StageNulls:
    """Load the distributions of stage differences, by default the shipped ones.

    Raises
    ------
    ParameterError
        If the file is none that `StageNulls.save` wrote.
    """
    return load_model(path, _KIND, _built)


def learn_stage_nulls(
    tables: Sequence[CaseTable], names: Sequence[str], scale: NDArray[np.float64]
) -> StageNulls:
    """Estimate the distributions of stage differences from cases without a cause.

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
    shares = np.linspace(0.0, 1.0, min(len(surprises), _N_SHARES))
    return StageNulls(
        tuple(names), scale, usual, seldom, np.maximum(typical, 1e-3),
        np.quantile(surprises, shares, axis=0),
    )  # fmt: skip


def _tails(errors: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two quantiles of each number."""
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
    """Return the stage that a number belongs to.

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
    """Return each mean difference in standard errors; NaN where it is uninformative."""
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


_WHOLE_BAND = (0.0, 1800.0)
"""Of a difference that is in no band: where the contact's cycle lives [Hz]; assumed."""

_STICK = ("creep", "stick", "stiffness", "calm", "after", "before", "ring", "slow_")

_PHASES = {
    "stick": (*_STICK, "time_stuck"),
    "slip": ("law", "fastest", "duration", "kinetic", "trough", "slip"),
    "cycle": ("peak", "interval", "spread", "skewness", "highest", "lowest", "friction"),
}


def stage_findings(table: CaseTable, nulls: StageNulls) -> dict[str, StageFinding]:
    """Return the gap, share and p-value of each stage.

    The gap is that of the number that differs most, over what is usual without a cause; the
    p-value is that of the most surprising one, corrected for the looks within and between stages.

    Parameters
    ----------
    table : CaseTable
    nulls : StageNulls
    """
    size, surprise = nulls.sizes(table), nulls.surprises(table)
    stages = np.array([stage_of(name) for name in nulls.names])
    of_stage = {}
    for i, stage in enumerate(STAGES):
        inside = stages == stage
        gap = min(largest_of(size[inside]) / float(nulls.typical[i]), LARGEST_GAP)
        of_stage[stage] = (gap, _p_value(largest_of(surprise[inside]), nulls.largest[:, i]))
    excess = {stage: max(gap - 1.0, 0.0) ** 2 for stage, (gap, _) in of_stage.items()}
    whole = sum(excess.values())
    return {
        stage: StageFinding(gap, excess[stage] / whole if whole > 0.0 else 0.0, p_value)
        for stage, (gap, p_value) in of_stage.items()
    }


def locate(table: CaseTable, nulls: StageNulls, stage: str | None = None) -> Location:
    """Return the place where the difference is most significant.

    Parameters
    ----------
    table : CaseTable
    nulls : StageNulls
    stage : str, optional
        Where to look; by default the stage that differs most surely.
    """
    findings = stage_findings(table, nulls)
    if stage is None:
        stage = min(findings, key=lambda name: (findings[name].p_value, -findings[name].gap))
    names = nulls.names
    inside = np.array([stage_of(name) == stage for name in names])
    if not inside.any():
        inside[:] = True
    size = np.where(inside, np.nan_to_num(nulls.surprises(table)), -1.0)
    strongest = np.argsort(size)[::-1][:12]
    strongest = strongest[size[strongest] >= 0.5 * size[strongest[0]]]
    shown = [names[int(i)] for i in strongest]
    channels = set(map(_channel, shown))
    bands = [band for name in shown if (band := _band(name)) is not None]
    low, high = (min(b[0] for b in bands), max(b[1] for b in bands)) if bands else _WHOLE_BAND
    return Location(
        stage=stage,
        channels=tuple(c for c in ("torque", "acceleration", "pressure", "angle") if c in channels),
        band=(low, high),
        phase=_phase(shown[0]),
        conditions=_conditions(table, nulls, strongest),
        p_value=findings[stage].p_value,
    )


def differences(table: CaseTable, nulls: StageNulls) -> tuple[Location, ...]:
    """Return the significant differences by stage, channel, band and phase of the cycle.

    Parameters
    ----------
    table : CaseTable
    nulls : StageNulls

    Returns
    -------
    tuple of Location
        Those that differ, the surest first; empty where none does. A p-value is that of the place's
        largest surprise among the largest ones that whole stages have without a cause, so it is
        corrected for all looks.
    """
    size = nulls.surprises(table)
    places: dict[tuple[str, str, tuple[float, float] | None, str], list[int]] = {}
    for i, name in enumerate(nulls.names):
        if np.isfinite(size[i]):
            key = (stage_of(name), _channel(name), _band(name), _phase(name))
            places.setdefault(key, []).append(i)
    by_surprise = []
    for (stage, channel, band, phase), numbers in places.items():
        largest = np.array(numbers)[np.argsort(-size[numbers])][:3]
        most = float(size[largest[0]])
        p_value = _p_value(most, nulls.largest[:, STAGES.index(stage)])
        if p_value <= SURE:
            conditions = _conditions(table, nulls, largest)
            place = Location(stage, (channel,), band or _WHOLE_BAND, phase, conditions, p_value)
            by_surprise.append((p_value, -most, place))
    return tuple(place for *_, place in sorted(by_surprise, key=lambda entry: entry[:2]))


def _p_value(size: float, null: NDArray[np.float64]) -> float:
    """Probability of so large a difference without a cause, corrected for all stages [-].

    A surprise is the negative logarithm of a tail's share, so its own tail is exponential: beyond
    the largest of those without a cause the probability falls on as that does.
    """
    beyond = int(np.count_nonzero(null >= size))
    farther = max(size - float(null.max()), 0.0)
    return min(1.0, len(STAGES) * (1.0 + beyond) / (len(null) + 1.0) * math.exp(-farther))


def _channel(name: str) -> str:
    kind = name.partition("_")[0]
    return {"contact": "torque", "common": "acceleration"}.get(kind, kind)


def _band(name: str) -> tuple[float, float] | None:
    head, _, number = name.rpartition("_")
    if not number.isdigit() or "_" not in head:
        return None
    what = head.partition("_")[2]
    if what not in ("gain", "incoherent", "transfer", "left", "excess", "level", "band"):
        return None
    i = int(number)
    return float(BAND_EDGES[i - 1]), float(BAND_EDGES[i])


def _phase(name: str) -> str:
    kind, _, what = name.partition("_")
    if kind != "contact":
        return "all"
    return next((phase for phase, heads in _PHASES.items() if what.startswith(heads)), "cycle")


def _conditions(table: CaseTable, nulls: StageNulls, strongest: NDArray[np.int64]) -> str:
    """In which conditions it shows, if only fast or only slow ones."""
    turned = np.array([c.speed for c in table.conditions], dtype=np.float64)
    speed = np.abs(turned)
    if np.unique(speed).size < 3:
        return "all"
    z = np.abs(deviations(table, nulls.names, nulls.scale)[:, strongest])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        size = np.nanmean(z, axis=1)
    middle = float(np.median(speed))
    fast, slow = size[speed >= middle].mean(), size[speed < middle].mean()
    if not max(fast, slow) > 2.0 * min(fast, slow):  # nor where one of them is unknown
        return "all"
    backwards = bool(np.all(turned <= 0.0))
    up, down = ("<=", ">") if backwards else (">=", "<")
    return f"speed_rad_s {up if fast > slow else down} {-middle if backwards else middle:g}"
