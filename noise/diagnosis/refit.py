"""How far a candidate closes the gap: fitted on some recordings, scored on others.

First the rig's parameters alone are recalibrated, within what a rig file may be wrong by; then
parameters and effect together. Both are judged by recordings that no fit has seen. What the
recalibration closes by itself is told apart, because it may hide the effect that is missing
(Kennedy and O'Hagan 2001; Brynjarsdottir and O'Hagan 2014).

Every model is simulated with the same few seeds, so that two of them differ by what they are and
not by chance. Fits go by the numbers of `noise.diagnosis.summary`, which change smoothly with what
is fitted, with residuals that saturate; scores go by the signatures' distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.rig import LawSpec
from noise.diagnosis.chain_run import chain_of, fine_rate, recorded, run_signals
from noise.diagnosis.distance import Reference, reference
from noise.diagnosis.evidence import aligned
from noise.diagnosis.library.rigs import OFFSETS, with_offsets
from noise.diagnosis.paths import KnownWays
from noise.diagnosis.signature import signature
from noise.diagnosis.summary import summary, through_same
from sim.effects.effect import activated

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition
    from models.recording import Recording
    from models.response import Response
    from models.rig import Rig
    from noise.diagnosis.paths import Way
    from noise.diagnosis.summary import CaseTable
    from sim.effects.effect import ActiveEffect, Effect

__all__ = ["Bench", "Fitted", "Model", "fit_effect", "fit_parameters", "split"]

PRIOR = 0.12
"""Relative standard deviation of what a rig file may be wrong by."""

N_REPEATS = 6
"""Simulated repeats that tell what repeats differ by."""

SEEDS = (0, 1)
"""Of the simulations of a candidate."""

_STRENGTHS = (0.03, 0.1, 0.25, 0.5, 1.0)
"""Tried first, as shares of the strongest; see `_scale`."""

_SATURATION = 4.0
"""Deviations beyond so many standard deviations hardly count in a fit."""

_HOLD = 0.3
"""Weight of the prior against one number of one recording."""

_HONEST = 3.0
"""Numbers of a recording hang together, which a fit does not know: its errors are so much larger;
assumed."""

_OFFSET_STEP = 0.06
_SHAPE_STEP = 0.5
_FEW = 3
"""Recordings that a fit looks at, of different conditions."""

_SHRINK = (1.0, 0.4)
"""Steps of the search: of an offset's logarithm, of an effect's, and how they shrink."""


@dataclass(frozen=True)
class Model:
    """A rig with offsets and effects.

    Parameters
    ----------
    offsets : tuple of float
        Logarithms of the factors on `OFFSETS`.
    effects : tuple of LawSpec
        Beyond those that the rig file lists.
    """

    offsets: tuple[float, ...] = (0.0,) * len(OFFSETS)
    effects: tuple[LawSpec, ...] = ()


@dataclass(frozen=True)
class Fitted:
    """A model, and what it leaves on the recordings it was fitted to."""

    model: Model
    cost: float
    spread: tuple[float, ...] = ()


@dataclass(eq=False)
class Bench:
    """Recordings of a case, ready to be compared with any model again and again."""

    rig: Rig
    recordings: tuple[Recording, ...]
    library: Mapping[str, Effect]
    table: CaseTable
    names: tuple[str, ...]
    scale: NDArray[np.float64]
    signatures: list[NDArray[np.float64]] = field(default_factory=list)
    references: list[Reference] = field(default_factory=list)
    chains: dict[tuple[float, float, float, bool], Response] = field(default_factory=dict)
    runs: dict[tuple[object, ...], NDArray[np.float64]] = field(default_factory=dict)
    numbers: dict[tuple[object, ...], NDArray[np.float64]] = field(default_factory=dict)
    known_ways: KnownWays = field(init=False)

    def __post_init__(self) -> None:
        self.known_ways = KnownWays(self.rig)
        self.signatures = [signature(recording) for recording in self.recordings]
        kept: dict[tuple[object, ...], Reference] = {}
        for recording in self.recordings:
            key = (recording.condition, recording.rate, recording.duration)
            if key not in kept:
                repeats = [self.simulated(Model(), recording, 100 + i) for i in range(N_REPEATS)]
                kept[key] = reference([signature(r) for r in repeats])
            self.references.append(kept[key])

    def simulated(self, model: Model, like: Recording, seed: int) -> Recording:
        """Simulate a recording by a model, at the condition, rate and length of another."""
        rig = with_offsets(
            self.rig,
            {name: math.exp(x) for name, x in zip(OFFSETS, model.offsets, strict=True)},
        )
        specs = (*self.rig.effects, *model.effects)
        effects = activated(specs, self.library)
        condition = like.condition
        fine = fine_rate(like.rate)
        rng = np.random.default_rng(seed)
        signals = run_signals(
            rig, condition, effects, self._chain(condition, fine, effects), like.duration, rng
        )
        return recorded(signals, fine, like.rate, condition, rng)

    def deviations(self, model: Model, chosen: Sequence[int]) -> list[NDArray[np.float64]]:
        """How far each chosen recording lies from a model, in units of what repeats differ by."""
        found = []
        for i in chosen:
            like = self.recordings[i]
            key = (repr(model), like.condition, like.rate, like.duration)
            if key not in self.runs:
                runs = [signature(self.simulated(model, like, seed)) for seed in SEEDS]
                self.runs[key] = np.mean(runs, axis=0)
            scale = self.references[i].scale * math.sqrt(
                (1.0 + 1.0 / len(SEEDS)) / (1.0 + 1.0 / N_REPEATS)
            )
            found.append((self.signatures[i] - self.runs[key]) / scale)
        return found

    def squared(self, model: Model, chosen: Sequence[int]) -> NDArray[np.float64]:
        """Squared distance of each chosen recording from a model; 1 is the floor."""
        return np.array(
            [
                self.references[i].squared_of(deviation)
                for i, deviation in zip(chosen, self.deviations(model, chosen), strict=True)
            ]
        )

    def residuals(self, model: Model, chosen: Sequence[int]) -> NDArray[np.float64]:
        """Differences of the numbers of each chosen recording from a model's, saturating.

        Returns
        -------
        ndarray, shape (n_chosen, n_names)
            Their mean square is 1 where all numbers are hopelessly off.
        """
        measured, _, scatter = aligned(self.table, self.names)
        rows = []
        for i in chosen:
            like = self.recordings[i]
            key = (repr(model), like.condition, like.rate, like.duration)
            if key not in self.numbers:
                run = through_same(self.simulated(model, like, SEEDS[0]), like)
                found = summary(run, self.rig, self._ways(like))
                self.numbers[key] = np.array([found.get(name, math.nan) for name in self.names])
            scale = np.sqrt(np.nan_to_num(scatter[i]) ** 2 + self.scale**2)
            z = (measured[i] - self.numbers[key]) / scale
            undefined = np.isfinite(measured[i]) != np.isfinite(self.numbers[key])
            z = np.where(undefined, _SATURATION, np.nan_to_num(z))
            rows.append(np.tanh(z / _SATURATION))
        return np.array(rows)

    def _ways(self, like: Recording) -> dict[str, Way]:
        c = like.condition
        assert c.interference is not None
        assert c.support_stiffness is not None
        return self.known_ways.at(c.interference, c.support_stiffness)

    def _chain(
        self, condition: Condition, rate: float, effects: Sequence[ActiveEffect]
    ) -> Response:
        assert condition.interference is not None
        assert condition.support_stiffness is not None
        blows = any(e.effect.force is not None for e in effects)
        key = (condition.interference, condition.support_stiffness, rate, blows)
        if key not in self.chains:
            found = self.known_ways.at(key[0], key[1])
            self.chains[key] = chain_of(self.rig, key[0], key[1], found, rate, blows=blows)
        return self.chains[key]


def split(conditions: Sequence[Condition]) -> tuple[list[int], list[int]]:
    """Which recordings are fitted to, and which are held out: whole conditions, about two fifths.

    Examples
    --------
    >>> from models.condition import Condition
    >>> at = [Condition(speed=v) for v in (1.0, 2.0, 2.0, 3.0, 4.0)]
    >>> split(at)
    ([0, 3, 4], [1, 2])
    """
    different = list(dict.fromkeys(conditions))
    if len(different) == 1:
        half = max(1, len(conditions) // 2)
        return list(range(half)), list(range(half, len(conditions))) or [0]
    in_order = sorted(different, key=lambda c: (c.interference or 0.0, c.speed or 0.0))
    out = set(in_order[1::3] if len(in_order) < 5 else in_order[1::5] + in_order[3::5])
    held = [i for i, c in enumerate(conditions) if c in out]
    fitted = [i for i, c in enumerate(conditions) if c not in out]
    return fitted, held


def fit_parameters(bench: Bench, chosen: Sequence[int]) -> Fitted:
    """Recalibrate the rig's parameters alone."""
    return _fit(bench, chosen, Model(), None)


def fit_effect(bench: Bench, chosen: Sequence[int], names: Sequence[str], start: Model) -> Fitted:
    """Fit parameters together with effects: every form, strengths from weak to strong.

    Parameters
    ----------
    bench : Bench
    chosen : sequence of int
        Recordings to fit to.
    names : sequence of str
        Of effects in the bench's library.
    start : Model
        With the parameters to begin at.
    """
    few = _different(bench, chosen)
    specs: tuple[LawSpec, ...] = ()
    for name in names:
        tried = [
            (_cost(bench, few, Model(start.offsets, (*specs, spec))), spec)
            for spec in _candidates(bench.library[name])
        ]
        specs = (*specs, min(tried, key=lambda pair: pair[0])[1])
    # Recalibrated parameters may have taken the effect's place: both beginnings get their chance.
    begin = min(
        (Model(offsets, specs) for offsets in dict.fromkeys((start.offsets, Model().offsets))),
        key=lambda model: _cost(bench, few, model),
    )
    return _fit(bench, chosen, begin, names[-1])


def _candidates(effect: Effect) -> list[LawSpec]:
    """Forms and strengths to begin with, and channels where a fault may be of one alone."""
    largest = _largest(effect)
    shares: list[dict[str, float]] = [{}]
    sensed = [n for n in ("torque", "acceleration", "pressure") if n in effect.parameters]
    if sensed and all(effect.parameters[n].high <= 1.0 for n in sensed):
        off = dict.fromkeys(sensed, 0.0)
        shares = [off | {n: 1.0} for n in sensed] + [dict.fromkeys(sensed, 1.0)]
    signs = (1.0, -0.6) if effect.parameters[effect.strength].low < 0.0 else (1.0,)
    return [
        LawSpec(effect.name, {"form": form, **share, effect.strength: sign * a * largest})
        for form in effect.forms
        for share in shares
        for sign in signs
        for a in (_STRENGTHS if len(shares) == 1 else _STRENGTHS[1::2])
    ]


def _largest(effect: Effect) -> float:
    """Return a strength that nobody overlooks."""
    declared = effect.parameters[effect.strength]
    return min(declared.high, _STRONG.get(effect.name, max(3.0 * declared.default, 1e-9)))


_STRONG = {
    "amplitude_softening": 0.6, "background_noise": 20.0, "beam_modes": 6.0,
    "channel_delay": 2e-3, "clipping": 0.75, "critical_torque_scatter": 0.5,
    "frictional_heating": 0.02, "gain_error": 0.8, "mains_hum": 10.0, "mount_resonance": 1.0,
    "partial_slip": 0.92, "plate_modes": 2.0, "room_reflections": 4.0, "shaft_compliance": 8e-4,
    "slip_pulse": 250.0, "speed_fluctuation": 0.25, "static_ageing": 0.97, "transfer_film": 1.0,
    "velocity_strengthening": 0.5, "velocity_weakening": 0.5, "viscoelastic_stiffness": 0.9,
}  # fmt: skip


def _fit(bench: Bench, chosen: Sequence[int], start: Model, effect: str | None) -> Fitted:
    """Search offsets and, of the last effect, its strength and what shapes it, one by one.

    Where a rig changes its regime the cost jumps, so a search that follows no slope is used:
    each number in turn by a step up or down, kept where it helps, with steps that shrink.
    """
    few = _different(bench, chosen)
    spec = start.effects[-1] if start.effects else None
    free = _free(bench.library[effect], spec) if effect is not None and spec is not None else []
    n_offsets = len(OFFSETS)

    def model_at(x: NDArray[np.float64]) -> Model:
        effects = start.effects
        if spec is not None and free:
            declared = bench.library[spec.name].parameters
            values = dict(spec.parameters)
            for (name, base), log in zip(free, x[n_offsets:].tolist(), strict=True):
                p = declared[name]
                values[name] = float(np.clip(base * math.exp(log), p.low, p.high))
            effects = (*start.effects[:-1], LawSpec(spec.name, values))
        return Model(tuple(x[:n_offsets].tolist()), effects)

    def cost_at(x: NDArray[np.float64]) -> float:
        held = float(np.sum((x[:n_offsets] / PRIOR) ** 2) + np.sum(x[n_offsets:] ** 2))
        return _cost(bench, few, model_at(x)) + _HOLD * held

    x = np.concatenate([np.array(start.offsets), np.zeros(len(free))])
    best = cost_at(x)
    curvature = np.full(x.size, np.nan)
    steps = np.where(np.arange(x.size) < n_offsets, _OFFSET_STEP, _SHAPE_STEP)
    for shrink in _SHRINK:
        for i in (*range(n_offsets, x.size), *range(n_offsets)):
            tried = []
            for sign in (1.0, -1.0):
                candidate = x.copy()
                candidate[i] += sign * shrink * steps[i]
                tried.append((cost_at(candidate), candidate))
            curvature[i] = (tried[0][0] + tried[1][0] - 2.0 * best) / (shrink * steps[i]) ** 2
            if min(tried, key=lambda pair: pair[0])[0] < best:
                best, x = min(tried, key=lambda pair: pair[0])
    spread = _HONEST / np.sqrt(np.maximum(0.5 * _SATURATION**2 * curvature, 1.0 / PRIOR**2))
    return Fitted(model_at(x), best, tuple(spread.tolist()))


def _free(effect: Effect, spec: LawSpec) -> list[tuple[str, float]]:
    """Parameters of an effect that are fitted: the strength, and what shapes it most."""
    names = [effect.strength, *_SHAPES.get(effect.name, ())]
    free = []
    for name in names:
        value = spec.parameters.get(name, effect.parameters[name].default)
        if isinstance(value, float) and value != 0.0:
            free.append((name, value))
    return free


_SHAPES: Mapping[str, tuple[str, ...]] = {
    "amplitude_softening": ("twist",), "beam_modes": ("frequency", "damping_ratio"),
    "frictional_heating": ("time_constant",), "gain_error": ("corner",),
    "mount_resonance": ("frequency", "damping_ratio"), "partial_slip": ("exponent",),
    "plate_modes": ("frequency", "damping_ratio"), "room_reflections": ("reverberation_time",),
    "slip_pulse": ("duration",), "speed_fluctuation": ("bandwidth",),
    "static_ageing": ("ageing_time",), "transfer_film": ("torque_ratio",),
    "velocity_strengthening": ("speed",), "velocity_weakening": ("speed",),
    "viscoelastic_stiffness": ("relaxation_time",),
}  # fmt: skip


def _different(bench: Bench, chosen: Sequence[int]) -> list[int]:
    """One recording a condition: repeats tell a fit nothing new."""
    first: dict[Condition, int] = {}
    for i in chosen:
        first.setdefault(bench.recordings[i].condition, i)
    return list(first.values())[:_FEW]


def _cost(bench: Bench, chosen: Sequence[int], model: Model) -> float:
    try:
        rows = bench.residuals(model, chosen)
    except ParameterError:
        return math.inf
    return float(np.sum(rows**2))
