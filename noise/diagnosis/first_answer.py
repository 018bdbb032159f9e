"""The first answer of a diagnosis: is there a gap, and which cause is how probable."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from models.rig import Rig
from noise.diagnosis.bench.flat_tops import flat_channels
from noise.diagnosis.causes.joint import Hypothesis, joint_probabilities, marginals, with_none
from noise.diagnosis.causes.unlearned import poor_responses, unlearned_sensors
from noise.diagnosis.causes.unseen import unseen_causes
from noise.diagnosis.causes.verdict import UNUSUAL, likeliest, needs_explaining
from noise.diagnosis.evidence.summary import CaseTable, case_table
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.gap.distance import Gap
from noise.diagnosis.simulated.model_runs import Model
from sim.constant_version import constant_version
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior


_WITHIN_REPEATS = 0.9
"""Probability of nothing being the matter where repeats differ as much and the probabilities of
causes were not learned with such sensors or responses [-]; on development benches of the second rig
with poor responses it was 20 of 21."""

_SUSPECTED = 0.5
"""Probability from which on an effect that the rig file lists is said to be off [-]; assumed."""


@dataclass(frozen=True, eq=False)
class FirstAnswer:
    """What is said before anything is fitted.

    Parameters
    ----------
    comparison : CaseComparison
        With the table of the recordings, and the repeats that the gap is measured by.
    gap : Gap
    hypotheses : mapping of frozenset of str to float
        Of each set of causes, the likeliest first [-].
    probabilities : mapping of str to float
        Of each cause [-]; 0 of the effects that the rig file lists, but those of which there can
        be more (`known_effects`).
    verdict : tuple of str
        As of `noise.diagnosis.outcome.Diagnosis`.
    suspected : tuple of str
        Effects that the rig file lists and that what is left looks like all the same.
    unlearned : tuple of str
        What is said of sensors that the probabilities were not learned with.
    flat : tuple of str
        Kinds of channel that are overloaded, as `noise.diagnosis.bench.flat_tops` tells.
    """

    comparison: CaseComparison
    gap: Gap
    hypotheses: Mapping[Hypothesis, float]
    probabilities: Mapping[str, float]
    verdict: tuple[str, ...]
    suspected: tuple[str, ...]
    unlearned: tuple[str, ...]
    flat: tuple[str, ...] = ()

    @property
    def table(self) -> CaseTable:
        """Numbers of the recordings, and of simulated repeats."""
        return self.comparison.table

    def with_hypotheses(self, hypotheses: Mapping[Hypothesis, float]) -> FirstAnswer:
        """Return the answer by other probabilities of hypotheses; each cause's follow from them."""
        single = marginals(hypotheses)
        return replace(
            self,
            hypotheses=hypotheses,
            probabilities={n: single.get(n, 0.0) for n in {**self.probabilities, **single}},
            verdict=likeliest({h: p for h, p in hypotheses.items() if h}),
        )


def known_effects(rig: Rig, library: Mapping[str, Effect]) -> set[str]:
    """Name the effects of a rig file that are not proposed again.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect
        Effects that the rig's can be found among.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.effects import EFFECTS
    >>> known_effects(load_material_rig("fluorocarbon"), EFFECTS)
    {'slip_pulse'}
    """
    return {spec.name for spec in constant_version(rig, library).effects}


def first_answer(
    case: Case,
    library: Mapping[str, Effect],
    posterior: Posterior,
    seed: int = 0,
    tell: Callable[[str], None] = lambda _text: None,
) -> FirstAnswer:
    """Compare a case with its rig file.

    What looks like an effect that the rig file lists is not proposed again: its numbers are off,
    which is a matter of the rig's parameters. Of an irregularity that it lists there can be more.

    Parameters
    ----------
    case : Case
    library : mapping of str to Effect
        Effects that the rig's can be found among.
    posterior : Posterior
    seed : int
        Of simulated repeats.
    tell : callable
        Told what is being done.
    """
    tell("comparing the recordings with the rig file")
    table = case_table(case.recordings, case.rig, library=library, seed=seed)
    tell("measuring the gap against simulated repeats")
    comparison = CaseComparison(
        case.rig, case.recordings, library, table, posterior.names, posterior.scale
    )
    gap = comparison.gap(seed)
    known = known_effects(case.rig, library)
    probabilities = dict(posterior.probabilities(table))
    kinds = {channel.kind for one in case.recordings for channel in one.channels}
    probabilities |= dict.fromkeys(unseen_causes(kinds), 0.0)
    again = {name: p for name, p in probabilities.items() if name in known}
    probabilities |= dict.fromkeys(again, 0.0)
    probabilities["parameters"] = max([probabilities["parameters"], *again.values()])
    unlearned = (
        *unlearned_sensors(case.rig.sensors, case.recordings),
        *poor_responses(case.rig, case.recordings),
    )
    hypotheses = joint_probabilities(probabilities)
    if unlearned and gap.p_value > UNUSUAL:
        hypotheses = with_none(hypotheses, _WITHIN_REPEATS)
    flat = flat_channels(case.recordings, lambda one: comparison.simulated(Model(), one, seed))
    answer = FirstAnswer(comparison, gap, {}, probabilities, (), (), unlearned, flat)
    answer = answer.with_hypotheses(hypotheses)
    if not needs_explaining(probabilities["none"], posterior.alarm, gap, learned=not unlearned):
        return replace(answer, verdict=())
    return replace(answer, suspected=tuple(n for n, p in again.items() if p >= _SUSPECTED))
