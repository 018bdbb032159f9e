"""Verdict of a diagnosis: causes named, causes that cannot be told apart, what to measure next.

Causes that the recorded channels cannot show, whatever stands in those that were recorded.

Hypotheses from causes taken one by one, and causes from hypotheses.

A hypothesis is the set of causes that are at work: none, ``parameters`` or ``unknown`` by itself,
or up to three effects.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from sim.effects import EFFECTS
from sim.effects.effect import Stage

if TYPE_CHECKING:
    from noise.diagnosis.gap import Gap


Hypothesis = frozenset[str]

_EXCLUSIVE = ("none", "parameters", "unknown")
_LEAST = 1e-4
"""Probabilities are held this far from 0 and 1 [-]: no library is large enough to tell more."""


_UNKNOWN_ODDS = 2.2
"""Factor on the odds of an unknown cause, since real rigs are more unlike those that the posterior
learned from than these are unlike each other [-]; of 281 development cases of the second rig (seeds
51 to 53, all with a gap) it lowers the Brier score from 0.378 to 0.361, cross-validated."""


def joint_probabilities(probabilities: Mapping[str, float]) -> dict[Hypothesis, float]:
    """Return the probability of each hypothesis if causes are independent.

    Parameters
    ----------
    probabilities : mapping of str to float
        Of every cause being at work, ``none``, ``parameters`` and ``unknown`` among them [-].

    Returns
    -------
    dict of frozenset of str to float
        The likeliest first; they sum to 1 [-].

    Examples
    --------
    >>> p = {"none": 0.0, "parameters": 0.1, "unknown": 0.0, "clipping": 0.9, "mains_hum": 0.7}
    >>> sorted(next(iter(joint_probabilities(p))))
    ['clipping', 'mains_hum']
    """
    odds = {
        cause: bounded / (1.0 - bounded)
        for cause, p in probabilities.items()
        if p > 0.0
        for bounded in [min(max(p, _LEAST), 1.0 - _LEAST)]
    }
    effects = [cause for cause in odds if cause not in _EXCLUSIVE]
    weights = {frozenset(set() if c == "none" else {c}): odds.get(c, 0.0) for c in _EXCLUSIVE}
    weights[frozenset({"unknown"})] *= _UNKNOWN_ODDS
    for size in (1, 2, 3):
        for members in combinations(effects, size):
            weights[frozenset(members)] = float(np.prod([odds[m] for m in members]))
    return normalised(weights)


def normalised(weights: Mapping[Hypothesis, float]) -> dict[Hypothesis, float]:
    """Return weights in proportion, so that they sum to 1 [-]; the largest first."""
    whole = sum(weights.values())
    ranked = sorted(weights.items(), key=lambda entry: -entry[1])
    return {hypothesis: weight / whole for hypothesis, weight in ranked}


def with_none(joint: Mapping[Hypothesis, float], least: float) -> dict[Hypothesis, float]:
    """Raise the probability of no cause to a minimum and rescale the others.

    Parameters
    ----------
    joint : mapping of frozenset of str to float
        Of the hypotheses [-].
    least : float
        Of nothing being the matter, where it has less [-].

    Examples
    --------
    >>> raised = with_none({frozenset({"clipping"}): 0.9, frozenset(): 0.1}, 0.7)
    >>> {"+".join(causes): round(p, 3) for causes, p in raised.items()}
    {'': 0.7, 'clipping': 0.3}
    """
    none: Hypothesis = frozenset()
    least = max(least, joint.get(none, 0.0))
    rest = sum(p for hypothesis, p in joint.items() if hypothesis)
    share = (1.0 - least) / rest if rest > 0.0 else 0.0
    others = {hypothesis: share * p for hypothesis, p in joint.items() if hypothesis}
    return normalised({none: least, **others})


def marginals(joint: Mapping[Hypothesis, float]) -> dict[str, float]:
    """Return the probability that each cause is present.

    Parameters
    ----------
    joint : mapping of frozenset of str to float
        Of the hypotheses [-].

    Returns
    -------
    dict of str to float
        By cause, ``none`` among them [-].

    Examples
    --------
    >>> marginals({frozenset(): 0.1, frozenset({"a"}): 0.5, frozenset({"a", "b"}): 0.4})
    {'none': 0.1, 'a': 0.9, 'b': 0.4}
    """
    single: dict[str, float] = {}
    for hypothesis, p in joint.items():
        for cause in sorted(hypothesis or {"none"}):
            single[cause] = single.get(cause, 0.0) + p
    return single


_SHOWN_BY = {
    Stage.STRUCTURE: {"acceleration", "pressure"},
    Stage.RADIATION: {"pressure"},
}
"""Channels of which one is needed; all others show the other stages."""


def unseen_causes(kinds: Collection[str]) -> frozenset[str]:
    """Return the effects that none of the recorded channels can show.

    Parameters
    ----------
    kinds : collection of str
        Of the channels that were recorded.

    Returns
    -------
    frozenset of str

    Examples
    --------
    >>> sorted(unseen_causes({"torque", "acceleration"}))
    ['plate_modes', 'room_reflections']
    >>> unseen_causes({"torque", "acceleration", "pressure"})
    frozenset()
    """
    return frozenset(
        name
        for name, effect in EFFECTS.items()
        if (needed := _SHOWN_BY.get(effect.stage)) is not None and not needed & set(kinds)
    )


def channel_costs(kinds: Collection[str]) -> list[str]:
    """Return one line for each consequence of channels that were not recorded.

    Parameters
    ----------
    kinds : collection of str
        Of the channels that were recorded.

    Examples
    --------
    >>> channel_costs({"torque", "pressure", "angle"})
    ['no acceleration: structure and radiation cannot be told apart']
    """
    missing = {"torque", "acceleration", "pressure", "angle"} - set(kinds)
    lines = []
    if "torque" in missing:
        recorded = " and ".join(
            word for kind, word in (("acceleration", "acceleration"), ("pressure", "sound"))
            if kind not in missing
        )  # fmt: skip
        lines.append(
            f"no torque: drive, contact and structure cannot be told apart by {recorded} alone"
        )
    unseen = ", ".join(sorted(name.replace("_", " ") for name in unseen_causes(kinds)))
    if {"acceleration", "pressure"} <= missing:
        lines.append(f"no acceleration and no sound: {unseen} cannot be assessed")
    elif "acceleration" in missing:
        lines.append("no acceleration: structure and radiation cannot be told apart")
    elif "pressure" in missing:
        lines.append(f"no sound: {unseen} cannot be assessed")
    if "angle" in missing:
        lines.append(
            "no shaft angle: the shaft is taken to turn evenly at the speed that was set, and an "
            "uneven drive is told by what else it changes"
        )
    return lines


ALONE: tuple[Hypothesis, ...] = (frozenset({"parameters"}), frozenset({"unknown"}))
"""Hypotheses of a cause that no effect is named beside."""

BEYOND = 5.0
"""Floors from which a gap that repeats hardly ever have is one to explain; assumed."""

RARE = 0.002
"""Probability of a gap between repeats that is hardly ever met; assumed."""

UNUSUAL = 0.05
"""Probability without a cause of what has to be seldom for an alarm of models that have not seen
such sensors or responses; the customary level, assumed."""


def needs_explaining(
    none: float, alarm: float, gap: Gap | None = None, chance: float | None = None
) -> bool:
    """Return whether the gap needs an explanation.

    Parameters
    ----------
    none : float
        Probability [-] of nothing being the matter.
    alarm : float
        Below which there is something to explain [-].
    gap : Gap, optional
        Against simulated repeats; one that these hardly ever have needs explaining as well.
    chance : float, optional
        How often such an answer is given on this bench where nothing is the matter [-]; asked for
        where the probabilities were not learned with such a bench.

    Examples
    --------
    >>> needs_explaining(0.6, 0.05), needs_explaining(0.01, 0.05)
    (False, True)
    >>> needs_explaining(0.01, 0.05, chance=0.3)
    False
    """
    if gap is not None and _is_beyond(gap):
        return True
    return none < alarm and (chance is None or chance <= UNUSUAL)


NAMED = 0.5
"""Probability from which on an effect is in a verdict [-]: it is likelier than not."""


def likeliest(
    hypotheses: Mapping[Hypothesis, float], fitted: Container[Hypothesis] | None = None
) -> tuple[str, ...]:
    """Return the causes of the likeliest hypothesis, the likeliest of them first.

    An effect that many sets share is likelier than any of these: it is weighed with all of them
    against the hypotheses that are no set of effects. What is less likely than not is not named,
    and where that is so of all of it, the cause is unknown.

    Parameters
    ----------
    hypotheses : mapping of frozenset of str to float
        [-]
    fitted : container of frozenset of str, optional
        Sets of effects that were fitted, and may be named; by default all may.

    Examples
    --------
    >>> likely = {frozenset({"clipping", "mains_hum"}): 0.5, frozenset({"mains_hum"}): 0.15,
    ...           frozenset({"unknown"}): 0.35}
    >>> likeliest(likely), likeliest(likely, [frozenset({"mains_hum"})])
    (('mains_hum', 'clipping'), ('mains_hum',))
    >>> likeliest({frozenset({"clipping"}): 0.4, frozenset({"mains_hum"}): 0.35})
    ('unknown',)
    """
    single = marginals(hypotheses)
    alone = [h for h in hypotheses if not h or h in ALONE]
    sets = [h for h in hypotheses if h not in alone and (fitted is None or h in fitted)]
    best = max(sets, key=lambda h: (max(single[name] for name in h), hypotheses[h]), default=None)
    apart = max(alone, key=lambda h: hypotheses[h], default=None)
    if best is None or (
        apart is not None and hypotheses[apart] >= max(single[name] for name in best)
    ):
        return tuple(apart or ())
    named = [name for name in best if single[name] >= NAMED]
    return tuple(sorted(named, key=lambda name: (-single[name], name))) or ("unknown",)


def _is_beyond(gap: Gap) -> bool:
    return gap.distance >= BEYOND and gap.p_value <= RARE


_ALIKE = 0.2
"""Two causes are declared alike if both are at least so probable and neither stands out; assumed,
as is the next."""

_FACTOR = 2.5
"""The likelier of them stands out from so many times the other's probability on [-]."""

_PAIRS: Mapping[frozenset[str], str] = {
    frozenset({"frictional_heating", "velocity_weakening"}): (
        "run one condition for a minute from cold: heating drifts with time, weakening does not"
    ),
    frozenset({"amplitude_softening", "viscoelastic_stiffness"}): (
        "oscillate the shaft in stick at two amplitudes and two frequencies"
    ),
    frozenset({"beam_modes", "plate_modes"}): (
        "a second accelerometer on the plate: does the band ring there or on the beams"
    ),
    frozenset({"plate_modes", "room_reflections"}): (
        "the same run with the microphone at half the distance: the room's share falls"
    ),
    frozenset({"critical_torque_scatter", "static_ageing"}): (
        "stop the shaft for 0.1, 1 and 10 s and turn on: ageing grows with the stop"
    ),
    frozenset({"partial_slip", "shaft_compliance"}): (
        "an angle sensor at the bushing's end of the shaft"
    ),
    frozenset({"gain_error", "parameters"}): "a known weight on the torque arm",
}

_MISSING = {
    "torque": "the torque between bushing and clamp",
    "acceleration": "an acceleration on the beams",
    "pressure": "the sound, with a calibrated microphone",
    "angle": "the angle of the shaft",
}

_WITHOUT_TORQUE = (
    ("critical_torque_scatter", "static_ageing"),
    ("partial_slip", "static_ageing"),
    ("frictional_heating", "velocity_weakening"),
    ("amplitude_softening", "viscoelastic_stiffness"),
)


def equivalent_pairs(
    ranked: Sequence[str], probabilities: Mapping[str, float], kinds: Collection[str]
) -> tuple[tuple[str, str], ...]:
    """Return the pairs of effects that this case cannot separate.

    Parameters
    ----------
    ranked : sequence of str
        Effects, the most probable first.
    probabilities : mapping of str to float
        [-]
    kinds : collection of str
        Of the channels that were recorded.

    Examples
    --------
    >>> p = {"velocity_weakening": 0.4, "frictional_heating": 0.3, "clipping": 0.1}
    >>> equivalent_pairs(list(p), p, {"torque"})
    (('frictional_heating', 'velocity_weakening'),)
    """
    pairs = []
    for i, one in enumerate(ranked[:4]):
        for other in ranked[i + 1 : 4]:
            high, low = probabilities[one], probabilities[other]
            if low >= _ALIKE and high < _FACTOR * low and high + low < 1.3:
                pairs.append((min(one, other), max(one, other)))
    if "torque" not in kinds:
        pairs += [pair for pair in _WITHOUT_TORQUE if ranked[0] in pair]
    return tuple(dict.fromkeys(pairs))


_WHERE_UNKNOWN = {
    "drive": "the angle at both ends of the shaft, and a run with the bushing taken out",
    "friction": (
        "the same condition at three speeds and two fits, twice each: what grows with speed, "
        "torque or time tells an effect that no library has"
    ),
    "structure": (
        "hammer hits on clamp and beams, and a second accelerometer beside the first: what rings "
        "there tells an effect that no library has"
    ),
    "radiation": (
        "the same run with the microphone at half the distance, and with the plate damped: what "
        "changes tells an effect that no library has"
    ),
    "measurement": (
        "a run with the shaft at rest, and one with another sensor in the place of each: what "
        "stays tells an effect that no library has"
    ),
}
"""What tells more of a difference that nothing known closes, by stage."""


def next_measurement(
    verdict: Sequence[str],
    probabilities: Mapping[str, float],
    kinds: Collection[str],
    stage: str = "friction",
    *,
    differs: bool = False,
    farthest: str = "",
    own_fit: bool = True,
) -> str:
    """Return the next measurement that would reduce the uncertainty most; empty if none would.

    Parameters
    ----------
    verdict : sequence of str
    probabilities : mapping of str to float
        [-]
    kinds : collection of str
        Of the channels that were recorded.
    stage : str
        That differs most.
    differs : bool
        Whether the gap is larger than that of repeats.
    farthest : str
        Recording that deviates most, if by more than repeats do.
    own_fit : bool
        Whether the rig file states the bushing that was recorded, rather than a shipped one.

    Examples
    --------
    >>> next_measurement(("clipping",), {"clipping": 0.99, "none": 0.0}, {"pressure"})
    'record the torque between bushing and clamp beside what there is'
    """
    if not verdict:
        if differs:
            return "each condition once more: what its two recordings share is no chance"
        if farthest:
            return f"the condition of {farthest} once more, to see whether its deviation is chance"
        return ""
    if verdict == ("parameters",) and not own_fit:
        return (
            "nothing yet: the rig file has no [[fit]] of its own. Let bushing-noise identify make "
            "a rig file of these recordings, and diagnose them with that one"
        )
    for kind, what in _MISSING.items():
        if kind not in kinds:
            return f"record {what} beside what there is"
    ranked = sorted((n for n in probabilities if n != "none"), key=lambda n: -probabilities[n])
    for other in ranked[1:4]:
        advice = _PAIRS.get(frozenset({ranked[0], other}))
        if advice is not None and probabilities[other] > 0.5 * _ALIKE:
            return advice
    if verdict == ("unknown",):
        return _WHERE_UNKNOWN[stage]
    if probabilities[ranked[0]] < 0.9:
        return "two more speeds, one below and one above those recorded, each twice"
    return "one condition outside those recorded, to confirm that the effect predicts it"
