"""First answer of a diagnosis: the gap and the probability of each cause, without fits.

The models of causes learned from recordings through sensors up to `NOISIEST` times as noisy as the
good ones of `sim.acquisition`, and through converters as coarse as the thesis's. Against repeats
that are simulated through a rig's own sensors a gap stays what it is, whatever the sensors; the
probabilities of causes do not. Nor do they where a rig's responses come from a poor hammer test:
its errors look like those of a sensor's gain or of the plate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensors
from noise.diagnosis.case import Case
from noise.diagnosis.causes.advice import unseen_causes
from noise.diagnosis.causes.posterior import CAUSES, Posterior, as_seldom, null_log_odds
from noise.diagnosis.causes.verdict import (
    UNUSUAL,
    Hypothesis,
    joint_probabilities,
    likeliest,
    marginals,
    needs_explaining,
    with_none,
)
from noise.diagnosis.evidence.channel_summary import USABLE
from noise.diagnosis.evidence.summary import case_table, lacking_coherence
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.gap import Gap
from sim.acquisition import THESIS_CONVERTER, Acquisition
from sim.effects import constant_version
from sim.effects.effect import Effect

NOISIEST = 6.0
"""Noise of the sensors that were learned with, over that of good ones at most [-]."""

_POOR = 0.05
"""What a good hammer test's coherence lacks of 1 at most, median over frequency [-]. On development
benches of the second rig good tests lack 0.001 and poor ones 0.10; between these it is assumed."""


def unlearned_sensors(sensors: Sensors, recordings: Sequence[Recording]) -> str:
    """Return a note on sensors that the causes were not learned with; empty if there are none.

    Parameters
    ----------
    sensors : Sensors
        Their noise stated or estimated.
    recordings : sequence of Recording
        Through them.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.sensors import Sensor, Sensors
    >>> run = Recording(np.zeros((1, 4)), 30e3, (Channel("torque"),))
    >>> unlearned_sensors(Sensors({"torque": Sensor(full_scale=102.5, bits=16)}), [run])
    ''
    """
    reasons = []
    for kind in Acquisition().noise:
        sensor = sensors.of(kind)
        rows = [(r, row) for r in recordings if (row := r.first(kind)) is not None]
        if not rows:
            continue
        if _is_rough(sensors, kind):
            reasons.append(f"noise or rounding of {kind}")
        if sensor.full_scale is not None:
            end = sensor.full_scale - 1.5 * sensor.step
            if any(abs(r.samples[row]).max() >= end for r, row in rows):
                reasons.append(f"a range that {kind} reaches")
        if sensor.antialias is not None and sensor.antialias < USABLE * rows[0][0].rate:
            reasons.append(f"a filter of {kind} at {sensor.antialias:g} Hz")
    if not reasons:
        return ""
    return (
        f"the causes were learned with better sensors than these ({', '.join(reasons)}); their "
        "probabilities are less sure here, and none is named within what repeats through the same "
        "sensors differ by"
    )


def _is_rough(sensors: Sensors, kind: str) -> bool:
    """Return whether noise and rounding of a sensor are above the largest in training."""
    sensor, usual = sensors.of(kind), Acquisition().noise[kind]
    level = _level(usual if sensor.noise is None else sensor.noise, sensor.step)
    return level > _level(NOISIEST * usual, THESIS_CONVERTER.of(kind).step)


def _level(noise: float, step: float) -> float:
    """Return the standard deviation of noise and rounding together [unit of the channel]."""
    return math.hypot(noise, step / math.sqrt(12.0))


_WITHIN_REPEATS = 0.9
"""Probability of nothing being the matter where repeats differ as much and the probabilities of
causes were not learned with such sensors or responses [-]; on development benches of the second rig
with poor responses it was 20 of 21."""

_SUSPECTED = 0.5
"""Probability from which on an effect that the rig file lists is said to be off [-]; assumed."""


@dataclass(frozen=True, eq=False)
class FirstAnswer:
    """Answer of a diagnosis before any fit.

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
        Notes on sensors unlike those that the probabilities were learned with.
    """

    comparison: CaseComparison
    gap: Gap
    hypotheses: Mapping[Hypothesis, float]
    probabilities: Mapping[str, float]
    verdict: tuple[str, ...]
    suspected: tuple[str, ...]
    unlearned: tuple[str, ...]


def known_effects(rig: Rig, library: Mapping[str, Effect]) -> set[str]:
    """Return the effects of a rig file that are not proposed again.

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
    """Return the first answer of a case.

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
    probabilities |= dict.fromkeys(unseen_causes(case.kinds), 0.0)
    again = {name: p for name, p in probabilities.items() if name in known}
    probabilities |= dict.fromkeys(again, 0.0)
    probabilities["parameters"] = max([probabilities["parameters"], *again.values()])
    rough = unlearned_sensors(case.rig.sensors, case.recordings)
    lacking = lacking_coherence(case.rig, case.recordings) if case.rig.measured else 0.0
    poor = ""
    if lacking > _POOR:
        poor = (
            f"the rig file's responses were measured with a coherence of {1.0 - lacking:.2f} only; "
            "nothing is named within what repeats differ by; more hits, and harder ones, would tell"
        )
    if any(_is_rough(case.rig.sensors, kind) for kind in case.estimated_noise):
        probabilities["background_noise"] = 0.0  # nothing tells it from the sensors' own
    chance = gap.p_value if poor else None
    if rough:
        tell("simulating this bench without a cause")
        nulls = null_log_odds(case, table, posterior, library, seed)
        none = CAUSES.index("none")
        own = as_seldom(posterior.log_odds(table)[none], nulls[:, none], len(case.recordings))
        chance = max(own, chance or 0.0)
    hypotheses = joint_probabilities(probabilities)
    needs = needs_explaining(probabilities["none"], posterior.alarm, gap, chance)
    if chance is not None and chance > UNUSUAL and not needs:
        hypotheses = with_none(hypotheses, _WITHIN_REPEATS)
    single = marginals(hypotheses)
    return FirstAnswer(
        comparison,
        gap,
        hypotheses,
        {name: single.get(name, 0.0) for name in {**probabilities, **single}},
        likeliest({h: p for h, p in hypotheses.items() if h}) if needs else (),
        tuple(n for n, p in again.items() if p >= _SUSPECTED) if needs else (),
        tuple(filter(None, (rough, poor))),
    )
