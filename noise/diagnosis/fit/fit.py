"""Fit of parameters and effects to recordings by pattern search.

Parameters are recalibrated within what a rig file may be wrong by. What that closes by itself is
told apart, because it may hide the effect that is missing (Kennedy and O'Hagan 2001;
Brynjarsdottir and O'Hagan 2014). An effect is tried in the simulator's own forms, from weak to
strong, and in forms that were estimated from the recordings; what comes nearest at a look is
searched about.

Where a rig changes its regime a cost jumps, and between two jumps it is rough; least squares stop
there. So each number is tried by a step up and a step down, kept where that helps and tried again
in the same direction, with steps that shrink (Hooke and Jeeves 1961, J. ACM 8, 212).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError
from models.rig import LawSpec
from noise.diagnosis.cases.draws import drawn_effect
from noise.diagnosis.evidence.summary import CaseTable
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.estimated_forms import ESTIMATED, estimated_forms
from noise.diagnosis.simulated.model_runs import OFFSETS, Model
from sim.effects import EFFECTS
from sim.effects.effect import Effect

PRIOR = 0.12
"""Relative standard deviation of what a rig file may be wrong by; assumed."""

_HOLD = 0.15
"""Weight of the prior against the distance of one recording; assumed."""

_SHRINK = (1.0, 0.5, 0.25, 0.125)
_STEP_OF_OFFSET, _STEP_OF_EFFECT = 0.08, 0.5
"""Of logarithms."""

_READ = {
    "elastomer_stiffness": "contact_stiffness_all",
    "critical_torque": "contact_peak",
    "kinetic_torque": "contact_kinetic",
}
"""Numbers of a recording that offsets are read off."""

_FARTHEST_READ = 0.3
"""Logarithm that such a number tells at most [-]; assumed."""

_FARTHEST = 4
"""A step is repeated in one direction so often at most."""

_MOST = 4
"""Recordings that a fit looks at, of different conditions; assumed."""

_DRAWN = 18
"""Of the simulator's own forms tried; what a fit may cost settles it, as the next; assumed."""

_LOOKED, _PROMISING = 2, 6
"""Recordings that candidates are looked at with, and candidates looked at more closely."""

_WORTH = 0.95
"""Share of the cost that a further effect must come below at a look to be searched about; one that
is to be named has to close about half of what is left (`noise.diagnosis.fit.decide`); assumed."""

_SETTLING = (1.0, 0.7, 1.4)
"""Factors on the strength, tried last."""

_BEYOND_DEFAULT = (0.1, 0.3, 1.0, 3.0, 10.0)
"""Strengths tried of an effect that is not the library's, over its default."""

_SHARES = ("torque", "acceleration", "pressure", "angle")
"""Parameters that say which channel an effect is on; they are drawn, not searched."""

_BY_NUMBERS = ("channel_delay",)
"""Effects that change phases, of which a signature knows nothing and the summary does."""

_NUMBERS = 20.0
"""Weight of the summary's numbers, were all of them hopelessly off; assumed."""

_UNSURE = 0.2
"""By how much the mean distance of three or four recordings is off by chance: 0.36 of one
(`noise.diagnosis.fit.closing`) over the root of their number."""

_BESIDE = 0.035
"""Standard deviation of an offset beside that, by the others that may stand for it, the recordings'
own scatter and the search: with it 92 % of 60 offsets of twelve simulated rigs were within their
90 % intervals, without it 68 %."""

_LOOK_OF_OFFSET, _LOOK_OF_EFFECT = 0.04, 0.3
_LEAST_SURE = 1.5
"""So far off the cost is looked at for how sure a number is; standard deviation of a logarithm of
an effect's number at most; assumed."""


def pattern_search(
    cost: Callable[[NDArray[np.float64]], float],
    start: NDArray[np.float64],
    steps: NDArray[np.float64],
    shrink: Sequence[float],
) -> tuple[NDArray[np.float64], float]:
    """Return the minimum of a cost by pattern search.

    Parameters
    ----------
    cost : callable
        Of an ndarray as `start`; may be infinite.
    start, steps : ndarray, shape (n,)
        Steps of 0 leave a number as it is [any unit].
    shrink : sequence of float
        Factors on the steps, one a round.

    Returns
    -------
    ndarray, shape (n,)
        The best that was tried [unit of `start`].
    float
        Its cost [unit of the cost].

    Examples
    --------
    >>> found, _ = pattern_search(lambda x: float(abs(x - 0.7).sum()), np.zeros(2), np.ones(2),
    ...                           (1.0, 0.5, 0.25, 0.125))
    >>> bool(np.all(abs(found - 0.7) < 0.1))
    True
    """
    x, best = start.copy(), cost(start)
    for factor in shrink:
        for i in np.flatnonzero(steps):
            for sign in (1.0, -1.0):
                improved = False
                for _ in range(_FARTHEST):
                    candidate = x.copy()
                    candidate[i] += sign * factor * steps[i]
                    candidate_cost = cost(candidate)
                    if candidate_cost >= best:
                        break
                    x, best, improved = candidate, candidate_cost, True
                if improved:
                    break
    return x, best


@dataclass(frozen=True, eq=False)
class Fitted:
    """Model fitted to recordings, with the uncertainty of its numbers.

    Parameters
    ----------
    model : Model
    comparison : CaseComparison
    few : sequence of int
        Recordings that the fit looked at.
    """

    model: Model
    comparison: CaseComparison
    few: Sequence[int]

    @cached_property
    def spread(self) -> dict[str, float]:
        """Standard deviation of the logarithm of each number, by name.

        Parameters by their own, numbers of an effect as ``EFFECT.NUMBER``: how far each can be off
        before the cost tells, which is taken to rise as the square. What the fit leaves above the
        floor makes it less sure in proportion (Birge 1932). It is that of one form, the other
        numbers as they are.
        """
        best, spreads = cost_of(self.comparison, self.few, self.model), {}
        for number in (*_offsets(), *_numbers(self.comparison, self.model)):
            of_offset = number[0] is None
            look = _LOOK_OF_OFFSET if of_offset else _LOOK_OF_EFFECT
            costs = [self._cost_at(number, x) for x in (look, -look)]
            known = [one for one in costs if math.isfinite(one)]
            rise = max(sum(known) / len(known) - best, 1e-9) if known else 1e-9
            most, beside = (PRIOR, _BESIDE) if of_offset else (_LEAST_SURE, 0.0)
            own = math.hypot(look * math.sqrt(_UNSURE * max(best, 1.0) / rise), beside)
            spreads[_name(self.model, number)] = min(own, most)
        return spreads

    def _cost_at(self, number: _Number, x: float) -> float:
        return cost_of(self.comparison, self.few, _moved(self.model, [number], np.array([x])))


def split(
    conditions: Sequence[Condition], gaps: Sequence[float] = ()
) -> tuple[list[int], list[int]]:
    """Split recordings into fitted and held-out ones, about two fifths of the conditions.

    The fastest is among those held out, and the slowest where there are several: what closes there
    is foretold and not only filled in. Where no gap shows there but in several others, the one of
    these with the second largest takes the place of one of them: without a gap nothing closes.
    Where a single condition shows one, half of its recordings are held out, if there are several.

    Parameters
    ----------
    conditions : sequence of Condition
    gaps : sequence of float
        Of the recordings [floors]; without them none is looked at [-].

    Examples
    --------
    >>> from models.condition import Condition
    >>> at = [Condition(speed=v) for v in (1.0, 2.0, 2.0, 3.0, 4.0)]
    >>> split(at)
    ([0, 1, 2, 3], [4])
    >>> split(at, [4.0, 3.0, 3.0, 1.0, 1.0])
    ([0, 3, 4], [1, 2])
    >>> split(at, [1.0, 3.0, 3.0, 1.0, 1.0])
    ([0, 1, 3], [2, 4])
    """
    different = list(dict.fromkeys(conditions))
    if len(different) == 1:
        half = max(1, len(conditions) // 2)
        return list(range(half)), list(range(half, len(conditions))) or [0]
    by_speed = sorted(different, key=lambda c: (abs(c.speed or 0.0), c.interference or 0.0))
    count = max(1, 2 * len(different) // 5)
    out = by_speed[::-2][:count]
    if len(out) > 1:  # the slowest in the place of the slowest of these
        out = [*by_speed[::-2][: count - 1], by_speed[0]]
    largest: dict[Condition, float] = {}
    for condition, gap in zip(conditions, gaps, strict=False):
        largest[condition] = max(gap, largest.get(condition, 0.0))
    showing = sorted((c for c in largest if largest[c] > SHOWS), key=lambda c: -largest[c])
    if len(showing) > 1 and not set(showing) & set(out):
        out = [*out[:-1], showing[1]]
    held = {i for i, c in enumerate(conditions) if c in out}
    if len(showing) == 1:
        alike = [i for i, c in enumerate(conditions) if c == showing[0]]
        if len(alike) > 1:
            held = (held - set(alike)) | set(alike[len(alike) // 2 :])
    return [i for i in range(len(conditions)) if i not in held], sorted(held)


SHOWS = 1.5
"""Floors from which on a gap is worth closing; assumed."""


def different(comparison: CaseComparison, chosen: Sequence[int]) -> list[int]:
    """Return one recording of each condition for a fit."""
    first: dict[Condition, int] = {}
    for i in chosen:
        first.setdefault(comparison.recordings[i].condition, i)
    listed = list(first.values())
    places = np.linspace(0, len(listed) - 1, min(_MOST, len(listed))).round().astype(int)
    return [listed[k] for k in places.tolist()]


def cost_of(
    comparison: CaseComparison, few: Sequence[int], model: Model, *, single_run: bool = False
) -> float:
    """Return mean distance of recordings from a model plus the cost of offsets, in floors [-]."""
    held = _HOLD * float(np.sum((np.array(model.offsets) / PRIOR) ** 2)) / len(few)
    try:
        if any(spec.name in _BY_NUMBERS for spec in model.effects):
            held += _NUMBERS * float(np.mean(comparison.residuals(model, few) ** 2))
    except ParameterError:
        return math.inf
    return float(np.mean(comparison.misfits(model, few, single_run=single_run))) + held


_Number = tuple[int | None, str, float, float]
"""Of a model: place of its effect, None for an offset; name; lowest and highest value."""


def _offsets() -> list[_Number]:
    return [(None, name, -math.inf, math.inf) for name in OFFSETS]


def _numbers(comparison: CaseComparison, model: Model, *places: int) -> list[_Number]:
    """Return the fitted numbers of the effects of a model."""
    return [
        (place, name, declared.low, declared.high)
        for place in places or range(len(model.effects))
        for spec in [model.effects[place]]
        for name, declared in comparison.effect_of(spec).parameters.items()
        if isinstance(value := spec.parameters.get(name), float | int)
        and value != 0.0
        and name not in _SHARES
    ]


def _name(model: Model, number: _Number) -> str:
    place, name, *_ = number
    return name if place is None else f"{model.effects[place].name}.{name}"


def _moved(model: Model, numbers: Sequence[_Number], x: NDArray[np.float64]) -> Model:
    """Return a model with numbers changed by logarithms, within their limits."""
    offsets, effects = list(model.offsets), list(model.effects)
    for (place, name, low, high), log in zip(numbers, x.tolist(), strict=True):
        if place is None:
            offsets[OFFSETS.index(name)] += log
            continue
        spec = effects[place]
        value = float(np.clip(float(spec.parameters[name]) * math.exp(log), low, high))
        effects[place] = LawSpec(spec.name, {**spec.parameters, name: value})
    return Model(tuple(offsets), tuple(effects))


def _searched(
    comparison: CaseComparison,
    few: Sequence[int],
    model: Model,
    numbers: Sequence[_Number],
    shrink: Sequence[float],
) -> tuple[float, Model]:
    """Return the least cost of a search over numbers of a model, and its model."""
    steps = [_STEP_OF_OFFSET if place is None else _STEP_OF_EFFECT for place, *_ in numbers]
    x, cost = pattern_search(
        lambda x: cost_of(comparison, few, _moved(model, numbers, x)), np.zeros(len(steps)),
        np.array(steps), shrink,
    )  # fmt: skip
    return cost, _moved(model, numbers, x)


def fit_parameters(comparison: CaseComparison, chosen: Sequence[int]) -> Fitted:
    """Fit the parameters of the rig.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to fit to.
    """
    few = different(comparison, chosen)
    plain, read = Model(), Model(read_offsets(comparison.table, few))
    fits = [_searched(comparison, few, read, _offsets(), _SHRINK[1:])]
    if cost_of(comparison, few, plain) < cost_of(comparison, few, read):
        fits.append(_searched(comparison, few, plain, _offsets(), _SHRINK))
    return Fitted(min(fits, key=itemgetter(0))[1], comparison, few)


def read_offsets(table: CaseTable | None, chosen: Sequence[int]) -> tuple[float, ...]:
    """Estimate offsets of torques and stiffness from the evidence of the recordings.

    A law or an effect moves these numbers as well; where none does, they are within 1 to 2 %.

    Parameters
    ----------
    table : CaseTable, optional
        Without one nothing is read.
    chosen : sequence of int
        Recordings.

    Returns
    -------
    tuple of float
        Logarithms of the factors on `OFFSETS`, 0 of what is not read [-].
    """
    offsets = []
    for name in (_READ.get(name) for name in OFFSETS):
        ratio = np.empty(0)
        if table is not None and name in table.names:
            column = table.names.index(name)
            measured, nominal = (x[list(chosen), column] for x in (table.measured, table.nominal))
            ratio = np.log(np.maximum(measured, 1e-3) / np.maximum(nominal, 1e-3))
            ratio = np.clip(ratio[np.isfinite(ratio)], -_FARTHEST_READ, _FARTHEST_READ)
        offsets.append(float(np.median(ratio)) if ratio.size else 0.0)
    return tuple(offsets)


def fit_effects(
    comparison: CaseComparison,
    chosen: Sequence[int],
    names: Sequence[str],
    start: Model,
    seed: int = 0,
    *,
    begun: Model | None = None,
    stated: bool = False,
) -> Fitted:
    """Fit effects together with the parameters.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to fit to.
    names : sequence of str
        Of effects in the comparison's library, the strongest first.
    start : Model
        With the parameters as they were recalibrated alone.
    seed : int
        Of what is tried.
    begun : Model, optional
        Of a fit of some of the effects, which the others are added to.
    stated : bool
        Whether only forms are tried that a rig file can state.

    Raises
    ------
    ParameterError
        No form of an effect can be simulated.
    """
    few = different(comparison, chosen)
    best = begun or Model()
    there, worth = {spec.name for spec in best.effects}, True
    for name in (name for name in names if name not in there):
        candidates = stated_candidates(comparison.library[name], seed)
        if name == ESTIMATED and not stated:
            forms = estimated_forms(comparison, chosen)
            comparison.forms.update({(name, form.forms[0]): form for form in forms})
            candidates += [LawSpec(name, {"form": form.forms[0], "amount": 1.0}) for form in forms]
        looked = _looked(comparison, few, best, candidates)
        now = cost_of(comparison, few[:_LOOKED], best, single_run=True)
        worth = not best.effects or not _WORTH * now < looked[0][0] < math.inf
        if not worth:
            best = looked[0][1]
            continue
        before = _WORTH * cost_of(comparison, few, best) if best.effects else math.inf
        best = _added(comparison, few, best, start.offsets, looked)
        worth = cost_of(comparison, few, best) <= before
    if not worth:  # there is nothing that a search could make close more
        return Fitted(best, comparison, few)
    if len(names) > 1:  # what the first had to stand for is the others' now
        for place in range(len(names)):
            numbers = _numbers(comparison, best, place)
            _, best = _searched(comparison, few, best, numbers, _SHRINK[:3])
    _, best = _searched(comparison, few, best, _offsets(), _SHRINK[2:])
    return Fitted(_settled(comparison, few, best), comparison, few)


def stated_candidates(effect: Effect, seed: int) -> list[LawSpec]:
    """Return the starting forms of an effect for a fit.

    The library's are drawn as its cases are, strengths from weak to strong; of others the strength
    goes over two decades about its default.
    """
    if EFFECTS.get(effect.name) is effect:
        rng, forms = np.random.default_rng([seed, 7]), effect.forms
        specs = [
            drawn_effect(effect.name, float(np.exp(rng.uniform(np.log(0.02), 0.0))), rng)
            for _ in range(_DRAWN)
        ]
        return [
            LawSpec(effect.name, {**spec.parameters, "form": forms[i % len(forms)]})
            for i, spec in enumerate(specs)
        ]
    declared = effect.parameters[effect.strength]
    size = abs(declared.default) or 1.0
    signs = (1.0, -1.0) if declared.low < 0.0 else (1.0,)
    values = {
        min(max(sign * factor * size, declared.low), declared.high)
        for sign in signs
        for factor in _BEYOND_DEFAULT
    }
    return [
        LawSpec(effect.name, {"form": form, effect.strength: value})
        for form in effect.forms
        for value in sorted(values - {0.0})
    ]


def _looked(
    comparison: CaseComparison, few: Sequence[int], model: Model, candidates: Sequence[LawSpec]
) -> list[tuple[float, Model]]:
    """Return cost and model with each candidate of a further effect, the least cost first."""
    models = [replace(model, effects=(*model.effects, spec)) for spec in candidates]
    looked = [(cost_of(comparison, few[:_LOOKED], m, single_run=True), m) for m in models]
    return sorted(looked, key=lambda pair: pair[0])


def _added(
    comparison: CaseComparison,
    few: Sequence[int],
    model: Model,
    offsets: tuple[float, ...],
    looked: Sequence[tuple[float, Model]],
) -> Model:
    """Return the best refined model with one further effect."""
    # The effect may be what the parameters had to stand for, or one beside them.
    starts = []
    for x in dict.fromkeys((model.offsets, offsets)):
        shown = [replace(one, offsets=x) for _, one in looked[:_PROMISING]]
        starts.append(min(shown, key=lambda one: cost_of(comparison, few, one)))
    place = len(model.effects)
    refined = [
        _searched(comparison, few, one, _numbers(comparison, one, place), _SHRINK[:3])
        for one in starts
    ]
    cost, best = min(refined, key=itemgetter(0))
    if not math.isfinite(cost):
        comparison.runs.simulated(best, comparison.recordings[few[0]], 0)  # says why
        raise ParameterError("it breaks down in some of the recordings, in all forms tried")
    return best


def _settled(comparison: CaseComparison, few: Sequence[int], model: Model) -> Model:
    """Return a model whose last strength is the best against scattered repeats."""
    place = len(model.effects) - 1
    strength = comparison.effect_of(model.effects[place]).strength
    numbers = [one for one in _numbers(comparison, model, place) if one[1] == strength]
    if not numbers:
        return model
    settled = [_moved(model, numbers, np.log([factor])) for factor in _SETTLING]
    return min(settled, key=lambda one: float(np.sum(np.sqrt(comparison.squared(one, few)))))
