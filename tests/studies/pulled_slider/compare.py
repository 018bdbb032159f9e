"""Which term of the friction law closes the gap between force records and a simulated slider.

Each record in turn is left out: the parameters, and the parameters with each term, are fitted to
the others, and judged by the one left out. One weight and one surface serve all records.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from models.errors import ParameterError
from noise.diagnosis.gap.distance import closed_fraction
from tests.studies.pulled_slider.cycles import (
    FEATURES,
    block_features,
    cycle_features,
    smooth,
    stick_slope,
    threshold,
)
from tests.studies.pulled_slider.law import SLIDER_TERMS, Slider, SliderTerm

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from tests.studies.pulled_slider.record import PulledRecord

__all__ = ["SliderComparison", "SliderModel", "compare_slider"]

_BLOCKS = 4
_LEAST = np.array([0.03, 0.03, 0.01, 0.02, 0.05, 0.05])
"""No feature is known better than this, however alike the blocks of one record are."""
_WORST = 30.0
"""Cap of a feature's distance, so that one that is hopeless does not rule all others."""
_LONGEST = 40.0  # s of simulation
_WEIGHT = 1.1
"""The weight is read off the loading of the spring, which no friction law changes."""
_PARAMETERS = ("weight", "static", "kinetic")


@dataclass(frozen=True, eq=False)
class _Target:
    """Features of a record, the unit of each, and what must be known to simulate it."""

    record: PulledRecord
    features: NDArray[np.float64]
    units: NDArray[np.float64]
    height: float
    samples: int

    def distances(self, slider: Slider) -> NDArray[np.float64]:
        force = slider.force(
            self.record.stiffness, self.record.pull, self.record.recording.rate, self.samples
        )
        skipped = len(force) // 10  # the start is not what is drawn out of a long run
        simulated = cycle_features(force[skipped:], self.record.recording.rate, self.height)
        away = np.abs(simulated - self.features) / self.units
        return np.minimum(np.nan_to_num(away, nan=_WORST), _WORST)


@dataclass(frozen=True, eq=False)
class SliderModel:
    """A model of the comparison and how far it lies from each record left out.

    Parameters
    ----------
    name : str
        ``nominal``, ``recalibrated`` or that of a term.
    slider : Slider
        Fitted to all records.
    gaps : ndarray, shape (n_records,)
        Rms distance over the features of each record, by the fit that did not see it; 1 is what
        two such records of one condition would differ by.
    features : ndarray, shape (n_records, n_features)
        The same, feature by feature.
    """

    name: str
    slider: Slider
    gaps: NDArray[np.float64]
    features: NDArray[np.float64]

    @property
    def gap(self) -> float:
        """Mean over the records."""
        return float(np.mean(self.gaps))


@dataclass(frozen=True, eq=False)
class SliderComparison:
    """What a set of force records says of the friction law.

    Parameters
    ----------
    records : tuple of str
        Names, in the order of the arrays.
    nominal, recalibrated : SliderModel
        Without a term: as read off the first record, and refitted.
    terms : tuple of SliderModel
        Each alone, and the best joined with each other; ranked by their mean gap.
    better : tuple of int
        In how many records left out each of `terms` lies nearer than the recalibrated model.
    verdict : str
        ``"none"``, the name of a term, or ``"unknown"``.
    seconds : float
        What it took.
    """

    records: tuple[str, ...]
    nominal: SliderModel
    recalibrated: SliderModel
    terms: tuple[SliderModel, ...]
    better: tuple[int, ...]
    verdict: str
    seconds: float = field(compare=False)

    def closed(self, model: SliderModel) -> float | None:
        """Share of the nominal gap above the floor of 1 that a model closes."""
        return _share(self.nominal.gap, model.gap)

    def closed_by_effect(self, model: SliderModel) -> float | None:
        """Share of the recalibrated gap above the floor of 1 that a model closes."""
        return _share(self.recalibrated.gap, model.gap)

    def table(self) -> str:
        """All gaps in floors, a line a model."""
        names = "".join(f"{name:>14}" for name in self.records)
        lines = [f"verdict: {self.verdict}", f"{'model':<40}{names}{'mean':>7}{'by term':>9}"]
        for model in (self.nominal, self.recalibrated, *self.terms):
            row = "".join(f"{gap:14.2f}" for gap in model.gaps)
            share = self.closed_by_effect(model) if model in self.terms else None
            told = "-" if share is None else f"{100 * share:.0f} %"
            lines.append(f"{model.name:<40}{row}{model.gap:7.2f}{told:>9}")
        lines.append("by feature, mean over records: " + ", ".join(FEATURES))
        lines.extend(
            f"{model.name:<40}" + " ".join(f"{v:6.1f}" for v in model.features.mean(axis=0))
            for model in (self.nominal, self.recalibrated, *self.terms)
        )
        return "\n".join(lines)


def compare_slider(
    records: Sequence[PulledRecord], terms: Sequence[SliderTerm] = SLIDER_TERMS
) -> SliderComparison:
    """Name the term that brings a simulated slider nearest to force records left out of the fit.

    Parameters
    ----------
    records : sequence of PulledRecord
        Three or more, over springs or speeds. The nominal slider is read off the one pulled most
        softly and slowly: its weight from how fast the force rises, its coefficients from where it
        turns.
    terms : sequence of SliderTerm
        What the law may lack.

    Returns
    -------
    SliderComparison
        Named is a term that is nearer than recalibration in all records left out but one in six,
        and closes half of what could be closed; ``"none"`` where that is less than a floor.

    Raises
    ------
    ParameterError
        If there are fewer than three records, or one has too few cycles.
    """
    began = time.perf_counter()
    if len(records) < 3:
        raise ParameterError(f"{len(records)} records: leaving one out needs three or more")
    targets = [_target(record) for record in records]
    nominal = _read_off(min(records, key=lambda one: one.stiffness * one.pull))
    before = _judged("nominal", nominal, [nominal] * len(targets), targets)
    weights = (nominal.weight / _WEIGHT, nominal.weight * _WEIGHT)
    plain = _fit(targets, nominal, None, weights)
    plain_folds = [
        _fit(_without(targets, i), plain, None, weights, False) for i in range(len(targets))
    ]
    recalibrated = _judged("recalibrated", plain, plain_folds, targets)
    singles = [(term, _left_out(targets, plain, term, weights)) for term in terms]
    singles.sort(key=lambda pair: pair[1].gap)
    leader, led = singles[0]
    pairs = [
        _left_out(targets, led.slider, leader.joined(term), weights) for term, _ in singles[1:]
    ]
    models = [model for _, model in singles] + pairs
    models.sort(key=lambda model: model.gap)
    better = tuple(int(np.sum(model.gaps < recalibrated.gaps)) for model in models)
    share = _share(recalibrated.gap, models[0].gap)
    if share is None:
        verdict = "none"
    elif share >= 0.5 and better[0] >= len(targets) - len(targets) // 6:
        verdict = models[0].name
    else:
        verdict = "unknown"
    return SliderComparison(
        tuple(record.name for record in records),
        before,
        recalibrated,
        tuple(models),
        better,
        verdict,
        time.perf_counter() - began,
    )


def _left_out(
    targets: list[_Target], start: Slider, term: SliderTerm, weights: tuple[float, float]
) -> SliderModel:
    """Fit a term to all records, and from there to all but each, which judges."""
    whole = _fit(targets, start, term, weights)
    folds = [_fit(_without(targets, i), whole, term, weights, False) for i in range(len(targets))]
    return _judged(term.name, whole, folds, targets)


def _share(reference: float, gap: float) -> float | None:
    return None if reference < 2.0 else closed_fraction(reference, gap)


def _without(targets: list[_Target], left_out: int) -> list[_Target]:
    return [target for i, target in enumerate(targets) if i != left_out]


def _target(record: PulledRecord) -> _Target:
    force = smooth(record.recording["force"])
    rate = record.recording.rate
    height = threshold(record.recording["force"])
    features = cycle_features(force, rate, height)
    parts = block_features(force, rate, height, _BLOCKS)
    if not (np.all(np.isfinite(features)) and np.all(np.isfinite(parts))):
        raise ParameterError(
            f"recording {record.name!r}: too few force cycles in a quarter of it; record longer"
        )
    # Two records of as many independent blocks differ by this.
    spread = np.sqrt(2.0 / _BLOCKS) * np.std(parts, axis=0, ddof=1)
    units = np.maximum(spread, _LEAST)
    samples = min(len(force), int(_LONGEST * rate))
    return _Target(record, features, units, height, samples)


def _read_off(record: PulledRecord) -> Slider:
    force = record.recording["force"]
    slope, top, bottom = stick_slope(smooth(force), record.recording.rate, threshold(force))
    return Slider(record.stiffness * record.pull / slope, top, 0.5 * (top + bottom))


def _fit(
    targets: list[_Target],
    start: Slider,
    term: SliderTerm | None,
    weights: tuple[float, float],
    fresh: bool = True,
) -> Slider:
    """Least mean gap over the targets, by the simplex method on logarithms."""
    fields = _PARAMETERS + (term.fields if term else ())
    extra = () if term is None else term.starts
    known = tuple(getattr(start, name) for name in fields)
    first = np.array(known[:3] + (extra if fresh else known[3:]))
    low, high = weights
    lowest = np.array([low, 0.05, 0.05, *(term.lowest if term else ())])
    highest = np.array([high, 1.5, 1.5, *(term.highest if term else ())])

    def slider(logs: NDArray[np.float64]) -> Slider:
        values = np.exp(logs)
        made = Slider(*(float(value) for value in values[:3]))
        return made if term is None else term.put(made, tuple(float(v) for v in values[3:]))

    def gap(logs: NDArray[np.float64]) -> float:
        made = slider(logs)
        squares = [np.sqrt(np.mean(target.distances(made) ** 2)) for target in targets]
        return float(np.mean(squares))

    widths = np.array([0.1, 0.1, 0.1] + [0.7] * len(extra)) * (1.0 if fresh else 0.5)
    simplex = np.log(first) + np.vstack((0.0 * widths, np.diag(widths)))
    found = minimize(
        gap,
        np.log(first),
        method="Nelder-Mead",
        bounds=list(zip(np.log(lowest), np.log(highest), strict=True)),
        options={
            "maxfev": 60 * len(first) if fresh else 25 * len(first),
            "initial_simplex": np.clip(simplex, np.log(lowest), np.log(highest)),
            "xatol": 1e-3,
            "fatol": 1e-3,
        },
    )
    return slider(found.x)


def _judged(name: str, slider: Slider, folds: list[Slider], targets: list[_Target]) -> SliderModel:
    features = np.array(
        [target.distances(fold) for target, fold in zip(targets, folds, strict=True)]
    )
    return SliderModel(name, slider, np.sqrt(np.mean(features**2, axis=1)), features)
