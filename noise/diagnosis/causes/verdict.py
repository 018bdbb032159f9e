"""Verdict of a diagnosis: causes named, causes that cannot be told apart, what to measure next."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from noise.diagnosis.gap.distance import Gap

__all__ = ["equivalent_pairs", "next_measurement", "verdict_of"]

NAMED = 0.5
"""An effect beside the first is named from this probability."""

MOST = 3

BEYOND = 2.5
"""Floors from which a gap that repeats hardly ever have is one to explain."""

RARE = 0.002
"""Probability of a gap between repeats that is hardly ever met."""

UNUSUAL = 0.05
"""Probability of a gap between repeats that has to be small for an alarm of models that have not
seen such sensors."""

_EXCLUSIVE = ("parameters", "unknown")


def verdict_of(
    probabilities: Mapping[str, float],
    alarm: float,
    gap: Gap | None = None,
    *,
    learned: bool = True,
) -> tuple[str, ...]:
    """Decide what to say.

    Parameters
    ----------
    probabilities : mapping of str to float
        Of every cause being at work [-].
    alarm : float
        Probability of ``none`` below which there is something to explain.
    gap : Gap, optional
        Against simulated repeats; one that these hardly ever have needs explaining as well.
    learned : bool
        Whether the probabilities were learned with sensors such as these; where they were not,
        there is nothing to explain unless the gap says so.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> verdict_of({"none": 0.6, "parameters": 0.3, "clipping": 0.2, "unknown": 0.1}, 0.05)
    ()
    >>> verdict_of({"none": 0.0, "parameters": 0.1, "clipping": 0.9, "unknown": 0.1}, 0.05)
    ('clipping',)
    """
    if gap is not None and not learned and gap.p_value > UNUSUAL:
        return ()
    if probabilities["none"] >= alarm and not (gap is not None and _is_beyond(gap)):
        return ()
    others = {name: p for name, p in probabilities.items() if name != "none"}
    first = max(others, key=lambda name: others[name])
    if first in _EXCLUSIVE:
        return (first,)
    effects = sorted(
        (name for name in others if name not in _EXCLUSIVE and others[name] >= NAMED),
        key=lambda name: -others[name],
    )
    return tuple(effects[:MOST]) or (first,)


def _is_beyond(gap: Gap) -> bool:
    return gap.distance >= BEYOND and gap.p_value <= RARE


_ALIKE = 0.2
"""Two causes are declared alike if both are at least so probable and neither stands out."""

_FACTOR = 2.5

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
    """Pairs of effects that this case cannot separate.

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
    found = []
    for i, one in enumerate(ranked[:4]):
        for other in ranked[i + 1 : 4]:
            high, low = probabilities[one], probabilities[other]
            if low >= _ALIKE and high < _FACTOR * low and high + low < 1.3:
                found.append((min(one, other), max(one, other)))
    if "torque" not in kinds:
        found += [pair for pair in _WITHOUT_TORQUE if ranked[0] in pair]
    return tuple(dict.fromkeys(found))


def next_measurement(
    verdict: Sequence[str], probabilities: Mapping[str, float], kinds: Collection[str]
) -> str:
    """Say what would make the answer surer.

    Examples
    --------
    >>> next_measurement(("clipping",), {"clipping": 0.99, "none": 0.0}, {"pressure"})
    'record the torque between bushing and clamp beside what there is'
    """
    if not verdict:
        return "none: repeats of one condition differ as much as recording and simulation do"
    for kind, what in _MISSING.items():
        if kind not in kinds:
            return f"record {what} beside what there is"
    ranked = sorted((n for n in probabilities if n != "none"), key=lambda n: -probabilities[n])
    for other in ranked[1:4]:
        advice = _PAIRS.get(frozenset({ranked[0], other}))
        if advice is not None and probabilities[other] > 0.5 * _ALIKE:
            return advice
    if verdict == ("unknown",):
        return (
            "the same condition at three speeds and two fits, twice each: what grows with speed, "
            "torque or time tells an effect that no library has"
        )
    if probabilities[ranked[0]] < 0.9:
        return "two more speeds, one below and one above those recorded, each twice"
    return "one condition outside those recorded, to confirm that the fitted effect predicts it"
