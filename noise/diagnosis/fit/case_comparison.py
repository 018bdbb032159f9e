"""Comparison of the recordings of a case with models of their rig, with cached simulations.

Every model is simulated with the same few seeds, so that two of them differ by what they are and
not by chance. A fit compares with one run that has no scatter, which is the middle of what the
model can do; a score with as many scattered repeats as tell the floor.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np

from models.errors import ParameterError
from models.recording import Recording
from models.rig import LawSpec, Rig
from noise.base.arrays import Array
from noise.diagnosis.evidence.reconstruction import closed_spectrum
from noise.diagnosis.evidence.summary import (
    CaseTable,
    aligned,
    case_table,
    path_numbers,
    same_channels,
    signals_of,
)
from noise.diagnosis.floor import Reference, references_of
from noise.diagnosis.gap import Gap, gap_of
from noise.diagnosis.signature import signature, squared_distance
from noise.diagnosis.simulated.model_runs import (
    Model,
    ModelRuns,
    with_effects,
    with_offsets,
)
from noise.diagnosis.simulated.repeats import Scatter, condition_key
from sim.effects import EFFECTS
from sim.effects.effect import Effect

N_REPEATS = 12
"""Simulated repeats that tell what repeats differ by; what a diagnosis may cost settles it;
assumed."""

_N_OF_MODEL = 6
"""The first of these, that tell where a model lies; assumed."""

_BRIEF = 0.5
"""Runs without scatter are no longer than this [s]; assumed."""

_SLOW = ("frictional_heating", "transfer_film")
"""Effects that need as long as was recorded to show; so may those of users."""

_SEED = 100
"""Of the repeats; conditions share no repeat's rig, which would err in all of them alike."""

_SATURATION = 4.0
"""Deviations beyond so many standard deviations hardly count in `CaseComparison.residuals`."""

_WIDEST = 2.0
"""A model's own repeats widen the floor by so much at most; assumed."""

_SEEDS = (0, 1)
"""Of runs without scatter; one is enough but for effects that are chance themselves."""

_BY_CHANCE = (
    "background_noise", "channel_delay", "critical_torque_scatter", "gain_error", "mains_hum",
    "speed_fluctuation",
)  # fmt: skip


class CaseComparison:
    """Recordings of a case with the simulations of their rig.

    Parameters
    ----------
    rig : Rig
    recordings : tuple of Recording
    library : mapping of str to Effect
    table : CaseTable
        Of the same recordings.
    names : tuple of str
        Numbers that `residuals` has.
    scale : ndarray, shape (n_names,)
        Their scatter without a cause [unit of the number].
    """

    def __init__(
        self,
        rig: Rig,
        recordings: tuple[Recording, ...],
        library: Mapping[str, Effect],
        table: CaseTable,
        names: tuple[str, ...],
        scale: Array,
    ) -> None:
        self.rig, self.recordings, self.library = rig, recordings, library
        self.table, self.names, self.scale = table, names, scale
        # Forms of effects beside the library's, by the name of the effect and their own.
        self.forms: dict[tuple[str, str], Effect] = {}
        self.runs = ModelRuns(rig, library, self.forms)
        self._signed: dict[tuple[object, ...], Array] = {}
        self._repeated: dict[tuple[object, ...], list[Array]] = {}
        self._numbers: dict[tuple[object, ...], Array] = {}
        self._briefly = [_brief(recording) for recording in recordings]
        self._seeds = {
            key: np.random.SeedSequence([_SEED, place]).generate_state(N_REPEATS).tolist()
            for place, key in enumerate(dict.fromkeys(map(condition_key, recordings)))
        }
        self.signatures = [signature(recording) for recording in recordings]
        # Whose repeats tell the floor: the rig as its file has it.
        self.about = Model()
        self.references = self._references()

    def _references(self) -> list[Reference]:
        repeats = {
            condition_key(r): list(self._repeats(self.about, r, N_REPEATS))
            for r in reversed(self.recordings)
        }
        return references_of(self.recordings, self.signatures, repeats)

    def gap(self, seed: int = 0) -> Gap:
        """Return the gap between the recordings and the rig of the file.

        Its distance is 1 on average, and its p-value uniform, where only chance sets them apart.
        """
        return gap_of(self.signatures, self.references, seed=seed)

    def compared_about(self, model: Model) -> CaseComparison:
        """Return the same comparison in floors that the repeats of a model tell.

        Where the rig as its file has it is about to change its regime, its repeats differ by more
        than those of a model that is not; its floors would hide what that model leaves.

        Raises
        ------
        ParameterError
            The model cannot be simulated.
        """
        other = copy(self)
        other.about = model
        other.references = other._references()
        return other

    def table_beside(self, model: Model) -> CaseTable:
        """Return the numbers of the recordings beside those of repeats of a model.

        Raises
        ------
        ParameterError
            The model cannot be simulated.
        """
        rig = with_effects(with_offsets(self.rig, model.factors), model.effects)
        own = {spec.name: self.effect_of(spec) for spec in model.effects}
        return case_table(self.recordings, rig, library={**self.library, **own})

    def effect_of(self, spec: LawSpec) -> Effect:
        """Return the effect that a model names, in a form of the simulator's or a further one."""
        return self.runs.effect_of(spec)

    def is_stated(self, spec: LawSpec) -> bool:
        """Return whether a rig file can state an effect as fitted."""
        return (spec.name, str(spec.parameters.get("form"))) not in self.forms

    def deviations(self, model: Model, chosen: Sequence[int]) -> list[Array]:
        """Return deviations of recordings from a model, in standard deviations of repeats.

        Where the model's own repeats differ by more than those of the rig file, as with an effect
        that is chance itself, they tell what repeats of it differ by.

        Parameters
        ----------
        model : Model
        chosen : sequence of int

        Returns
        -------
        list of ndarray, shape (n_values,)
            In standard deviations of repeats [-].
        """
        deviations = []
        for i in chosen:
            reference = self.references[i]
            if model == self.about:
                deviations.append(reference.deviation(self.signatures[i]))
                continue
            repeats = self._repeats(model, self.recordings[i], _N_OF_MODEL)
            own = repeats.std(axis=0, ddof=1) * math.sqrt(1.0 + 1.0 / len(repeats))
            scale = np.clip(own, reference.scale, _WIDEST * reference.scale)
            deviations.append((self.signatures[i] - repeats.mean(axis=0)) / scale)
        return deviations

    def squared(self, model: Model, chosen: Sequence[int]) -> Array:
        """Return the squared distance of recordings from a model; 1 is the floor.

        Parameters
        ----------
        model : Model
        chosen : sequence of int

        Returns
        -------
        ndarray, shape (n_chosen,)
            In squared floors [-]; infinite where the model cannot be simulated.
        """

        def squared(i: int) -> float:
            try:
                (deviation,) = self.deviations(model, [i])
            except ParameterError:
                return math.inf
            return self.references[i].squared(deviation)

        return np.array([squared(i) for i in chosen])

    def misfits(self, model: Model, chosen: Sequence[int], *, single_run: bool = False) -> Array:
        """Return the distance of recordings from runs of a model without scatter.

        Such runs lie a little off the middle of the scattered ones; by how much the rig file's do
        is known, and taken off.

        Parameters
        ----------
        model : Model
        chosen : sequence of int
        single_run : bool
            Whether one run is enough, whatever chance there is in the effects.

        Returns
        -------
        ndarray, shape (n_chosen,)
            In standard deviations of repeats [-]; infinite where the model cannot be simulated.
        """

        def misfit(place: int) -> float:
            away = self._away(model, place, single_run=single_run)
            return math.sqrt(squared_distance(away))

        try:
            return np.array(self._each(misfit, chosen))
        except ParameterError:
            return np.full(len(chosen), np.inf)

    def _each(self, make: Callable[[int], Any], given: Sequence[int]) -> list[Any]:
        """Map a function over a sequence with several threads."""
        if len(given) < 2:
            return [make(one) for one in given]
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            return list(pool.map(make, given))

    def _away(self, model: Model, place: int, *, single_run: bool) -> Array:
        reference = self.references[place]
        names = [spec.name for spec in model.effects]
        briefly = not any(name in _SLOW or name not in EFFECTS for name in names)
        template = (self._briefly if briefly else self.recordings)[place]
        plain = self._middle(self.about, template, single_run=True)
        middle = self._middle(model, template, single_run=single_run)
        off = np.clip(reference.mean - plain, -reference.scale, reference.scale)
        return np.asarray((self.signatures[place] - middle - off) / reference.scale)

    def _middle(self, model: Model, template: Recording, *, single_run: bool) -> Array:
        """Return the signature of a model without scatter."""
        by_chance = any(spec.name in _BY_CHANCE for spec in model.effects)
        seeds = _SEEDS if by_chance and not single_run else _SEEDS[:1]
        key = (repr(model), condition_key(template), len(seeds))
        if key not in self._signed:
            self._signed[key] = np.mean(
                [self.runs.noise_free_signature(model, template, seed) for seed in seeds], axis=0
            )
        return self._signed[key]

    def residuals(self, model: Model, chosen: Sequence[int]) -> Array:
        """Return differences of recordings and a model in their path from torque to outputs.

        Returns
        -------
        ndarray, shape (n_chosen, n_names)
            Saturating [-]; their mean square is 1 where all numbers are hopelessly off. None where
            there is no torque, or nothing that follows from it.
        """
        measured, _, scatter = aligned(self.table, self.names)
        rows = []
        for i in chosen:
            template = self.recordings[i]
            key = (repr(model), condition_key(template))
            if key not in self._numbers:
                self._numbers[key] = self._path_numbers(model, template)
            scale = np.sqrt(np.nan_to_num(scatter[i]) ** 2 + self.scale**2)
            z = (measured[i] - self._numbers[key]) / scale
            rows.append(np.tanh(np.nan_to_num(z)[np.isfinite(self._numbers[key])] / _SATURATION))
        return np.array(rows)

    def _path_numbers(self, model: Model, template: Recording) -> Array:
        run = self.runs.simulated(model, template, 0, Scatter(0.0, 0.0, 0.0, 0.0))
        signal, rate, numbers = signals_of(same_channels(run, template)), run.rate, {}
        if "torque" in signal:
            transfer_functions = self.runs.transfer_functions.whole(template)
            spectrum = closed_spectrum(signal["torque"], rate)
            numbers = path_numbers(signal, spectrum, rate, transfer_functions, np.empty(0))[0]
        return np.array([numbers.get(name, math.nan) for name in self.names])

    def _repeats(self, model: Model, template: Recording, n: int) -> Array:
        """Return signatures of the first scattered repeats of a model, shape (n, n_values)."""
        known = self._repeated.setdefault((repr(model), condition_key(template)), [])

        def repeat(seed: int) -> Array:
            return signature(self.runs.simulated(model, template, seed))

        known += self._each(repeat, self._seeds[condition_key(template)][len(known) : n])
        return np.array(known[:n])


def _brief(recording: Recording) -> Recording:
    """Return a recording no longer than runs that are compared with it without scatter."""
    n = min(recording.samples.shape[1], round(_BRIEF * recording.rate))
    return replace(recording, samples=recording.samples[:, :n])
