"""From a driven record to the term that its linear model lacks.

The steps are those that keep a ranking honest: a floor from data where the linear model holds, a
gap that must stand out of it before anything is explained, recalibration before any term, all
parameters refitted with each term, and a ranking on data that no fit has seen.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.diagnosis.gap.distance import closed_fraction
from tests.studies.oscillator_terms.blocks import BlockErrors, block_errors, cut, drawn_blocks
from tests.studies.oscillator_terms.finding import Gap, OscillatorDiagnosis, TermFinding
from tests.studies.oscillator_terms.fit import Model, fit_model, linear_guess
from tests.studies.oscillator_terms.registry import LIBRARY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from tests.studies.oscillator_terms.oscillator import DrivenRecord, Oscillator, Span
    from tests.studies.oscillator_terms.registry import Term

__all__ = ["diagnose_oscillator"]

_DRAWS = 2000
_MARGIN = 1.1
"""A gap must exceed the floor by more than this, intervals included, to be called one."""
_SURE = 0.005
"""Chance that a term of ten is said to beat recalibration by luck: each of them gets this."""
_MOST = 0.5
"""Least share of the closable gap that a cause must close: one cause can't be half of it."""


def diagnose_oscillator(
    record: DrivenRecord,
    quiet: Sequence[Span],
    train: Sequence[Span],
    held_out: Mapping[str, Sequence[Span]],
    rng: np.random.Generator,
    nominal: Oscillator | None = None,
    library: Sequence[Term] = LIBRARY,
) -> OscillatorDiagnosis:
    """Name the term that the linear model of a measured oscillator lacks.

    Parameters
    ----------
    record : DrivenRecord
        Drive and response.
    quiet : sequence of tuple
        Stretches of small amplitude, where the linear model holds: nominal model and floor. The
        floor is the error in each half of the linear model that was fitted to the other half, or
        of one with dry friction if that is less, since dry friction weighs most in quiet data.
    train : sequence of tuple
        Stretches for recalibration and for the terms.
    held_out : mapping of str to sequence of tuple
        Stretches that no fit sees, by name. The first set ranks the terms.
    rng : numpy.random.Generator
        Draws the blocks of the bootstrap.
    nominal : Oscillator, optional
        The linear model at hand; without it, the one of the quiet stretches. A system that quiet
        drives leave stuck needs it given.
    library : sequence of Term
        What may be missing.

    Returns
    -------
    OscillatorDiagnosis
        Verdict, gaps, shares closed, ranking.

    Raises
    ------
    ParameterError
        If a stretch lies outside the record, is too short, or is held out and fitted to as well;
        or if the quiet stretches show no oscillator.
    """
    began = time.perf_counter()
    _validate(record, quiet, train, held_out)
    guess = nominal or linear_guess(record, quiet)
    linear = fit_model(record, quiet, guess, guess)
    before = Model(nominal or linear.oscillator, None, np.zeros(0), linear.reference)
    base = before.oscillator
    recalibrated = fit_model(record, train, base, base)
    fitted = [fit_model(record, train, base, recalibrated.oscillator, term) for term in library]
    shortest = min(stop - start for spans in held_out.values() for start, stop in spans)
    length = min(max(128, 10 * _decay_samples(record, base)), shortest // 2)
    floor = _floor(record, quiet, base, library, length)
    scores = _Scores(floor, rng)
    for name, spans in held_out.items():
        scores.add(
            name,
            [
                block_errors([model.error(record, span) for span in spans], length)
                for model in (before, recalibrated, *fitted)
            ],
        )
    ranking = next(iter(held_out))
    order = np.argsort([score.rms for score in scores.blocks[ranking][2:]], kind="stable")
    winner = int(order[0]) + 2
    findings = tuple(
        TermFinding(
            library[index].name,
            library[index].meaning,
            fitted[index].oscillator,
            tuple(float(value) for value in fitted[index].coefficients),
            {name: scores.gap(name, index + 2) for name in held_out},
            {name: scores.closed(name, 0, index + 2) for name in held_out},
            {name: scores.closed(name, 1, index + 2) for name in held_out},
            scores.surely_below(ranking, index + 2, 1),
            not scores.surely_below(ranking, winner, index + 2),
        )
        for index in order
    )
    first = findings[0]
    gap = scores.above_floor(ranking, 1)
    by_effect = first.closed_by_effect[ranking]
    named = first.beats_recalibration and by_effect is not None and by_effect.value >= _MOST
    return OscillatorDiagnosis(
        verdict="none" if not gap else first.name if named else "unknown",
        remainder=scores.blocks[ranking][winner].rms / floor.rms,
        remainder_is_real=scores.above_floor(ranking, winner),
        floor=scores.floor_gap,
        nominal=base,
        recalibrated=recalibrated.oscillator,
        gap_before={name: scores.gap(name, 0) for name in held_out},
        gap_recalibrated={name: scores.gap(name, 1) for name in held_out},
        hidden={
            name: None if share is None else share.value
            for name, share in ((name, scores.closed(name, 0, 1)) for name in held_out)
        },
        findings=findings,
        seconds=time.perf_counter() - began,
    )


def _floor(
    record: DrivenRecord,
    quiet: Sequence[Span],
    base: Oscillator,
    library: Sequence[Term],
    length: int,
) -> BlockErrors:
    """Error in either half of the quiet data of the model fitted to the other half."""
    halves = cut(quiet, 2)
    candidates = []
    for term in (None, *(term for term in library if term.spoils_quiet)):
        crossed = [
            fit_model(record, one, base, base, term).error(record, span)
            for one, other in (halves, halves[::-1])
            for span in other
        ]
        shortest = min(len(part) for part in crossed)
        candidates.append(block_errors(crossed, min(length, shortest)))
    return min(candidates, key=lambda errors: errors.rms)


def _decay_samples(record: DrivenRecord, model: Oscillator) -> int:
    decay = 2.0 * math.pi * model.frequency * model.damping
    return math.ceil(record.rate / decay)


class _Scores:
    """Block errors of all models in all held-out sets, with one draw of blocks a set."""

    def __init__(self, floor: BlockErrors, rng: np.random.Generator) -> None:
        self._floor = floor
        self._rng = rng
        self._floors = floor.resampled(drawn_blocks(len(floor.squares), _DRAWS, rng))
        self.floor_gap = _interval(floor.rms, self._floors)
        self.blocks: dict[str, list[BlockErrors]] = {}
        self._drawn: dict[str, list[NDArray[np.float64]]] = {}

    def add(self, name: str, models: list[BlockErrors]) -> None:
        drawn = drawn_blocks(len(models[0].squares), _DRAWS, self._rng)
        self.blocks[name] = models
        self._drawn[name] = [model.resampled(drawn) for model in models]

    def gap(self, name: str, model: int) -> Gap:
        return _interval(self.blocks[name][model].rms, self._drawn[name][model])

    def closed(self, name: str, reference: int, model: int) -> Gap | None:
        """Return the closed share of what a reference model leaves above the floor."""
        if not self.above_floor(name, reference):
            return None
        start, end = self.blocks[name][reference].rms, self.blocks[name][model].rms
        starts, ends = self._drawn[name][reference], self._drawn[name][model]
        floors = np.minimum(self._floors, starts - 1e-12 * start)
        shares = closed_fraction(starts, ends, floors)
        return _interval(closed_fraction(start, end, self._floor.rms), shares)

    def above_floor(self, name: str, model: int) -> bool:
        return self.gap(name, model).low > _MARGIN * self.floor_gap.high

    def surely_below(self, name: str, model: int, other: int) -> bool:
        differences = self._drawn[name][other] - self._drawn[name][model]
        return float(np.quantile(differences, _SURE)) > 0.0


def _interval(value: float, draws: NDArray[np.float64]) -> Gap:
    low, high = np.quantile(draws, (0.05, 0.95))
    return Gap(value, float(low), float(high))


def _validate(
    record: DrivenRecord,
    quiet: Sequence[Span],
    train: Sequence[Span],
    held_out: Mapping[str, Sequence[Span]],
) -> None:
    if not held_out:
        raise ParameterError("held_out names no data; a ranking needs some that no fit has seen")
    for name, spans in (("quiet", quiet), ("train", train), *held_out.items()):
        if not spans:
            raise ParameterError(f"{name}: no span given")
        for start, stop in spans:
            if not 0 <= start < stop <= len(record.drive) or stop - start < 300:
                raise ParameterError(
                    f"{name}: span {start}..{stop} must have 300 samples or more within the "
                    f"record's {len(record.drive)}"
                )
            fits = (*train, *quiet) if name in held_out else ()
            for other in fits:
                if start < other[1] and other[0] < stop:
                    raise ParameterError(
                        f"{name}: span {start}..{stop} is fitted to as well "
                        f"({other[0]}..{other[1]}); hold it out"
                    )
