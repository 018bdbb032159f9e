"""What recordings cannot tell, and what to measure next."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import combinations

from noise.base import packaged_toml
from sim.effects import EFFECTS
from sim.effects.effect import Stage

_ADVICE = packaged_toml("noise.diagnosis.causes", "advice.toml")

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
    lines = [text for kind, text in _ADVICE["without"].items() if kind not in kinds]
    if unseen := sorted(name.replace("_", " ") for name in unseen_causes(kinds)):
        lines.append(f"not assessed, by these channels: {', '.join(unseen)}")
    return lines


_ALIKE = 0.2
"""Two causes are declared alike if both are at least so probable and neither stands out; assumed,
as is the next."""

_FACTOR = 2.5
"""The likelier of them stands out from so many times the other's probability on [-]."""


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
    for one, other in combinations(ranked[:4], 2):
        high, low = probabilities[one], probabilities[other]
        if low >= _ALIKE and high < _FACTOR * low and high + low < 1.3:
            pairs.append((min(one, other), max(one, other)))
    if "torque" not in kinds:
        without = map(tuple, _ADVICE["without_torque"]["pairs"])
        pairs += [pair for pair in without if ranked[0] in pair]
    return tuple(dict.fromkeys(pairs))


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
    for kind, what in _ADVICE["missing"].items():
        if kind not in kinds:
            return str(what)
    ranked = sorted((n for n in probabilities if n != "none"), key=lambda n: -probabilities[n])
    for other in ranked[1:4]:
        for pair in _ADVICE["pair"]:
            if {ranked[0], other} == set(pair["causes"]) and probabilities[other] > 0.5 * _ALIKE:
                return str(pair["next"])
    if verdict == ("unknown",):
        return str(_ADVICE["unknown"][stage])
    if probabilities[ranked[0]] < 0.9:
        return "two more speeds, one below and one above those recorded, each twice"
    return "one condition outside those recorded, to confirm that the effect predicts it"
