"""Known cause of a simulated case."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

KINDS = {
    "none": 0.16,
    "parameters": 0.12,
    "one": 0.35,
    "pair": 0.18,
    "triple": 0.06,
    "unknown": 0.13,
}
"""Classes of cases, and the share of each."""


@dataclass(frozen=True)
class Truth:
    """What a case is about.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    effects : tuple of str
        Names of what is missing in the model; of an unknown effect the name it has here.
    forms : tuple of str
    strengths : tuple of float
        From 0.01, which cannot be seen, to 1, which is strong [-].
    offsets : tuple of (str, float)
        Parameters that are off in all recordings, and by what factor.
    channels : tuple of tuple of str
        In which each of the effects acts; empty where that is not known.
    """

    kind: str
    effects: tuple[str, ...] = ()
    forms: tuple[str, ...] = ()
    strengths: tuple[float, ...] = ()
    offsets: tuple[tuple[str, float], ...] = ()
    channels: tuple[tuple[str, ...], ...] = ()


def seen_through(
    truth: Truth, acting: Sequence[Collection[str]], channels: Collection[str]
) -> Truth:
    """Return what can be told of a cause from some channels: what acts in others is not there.

    Parameters
    ----------
    truth : Truth
    acting : sequence of collection of str
        Channels in which each of its effects acts.
    channels : collection of str
        That were recorded.

    Examples
    --------
    >>> noisy = Truth("pair", ("room_reflections", "clipping"), ("a", "b"), (1.0, 0.5))
    >>> seen_through(noisy, [("pressure",), ("torque", "pressure")], ("torque", "angle"))
    Truth(kind='one', effects=('clipping',), forms=('b',), strengths=(0.5,), offsets=(), \
channels=(('pressure', 'torque'),))
    """
    kept = [i for i, seen in enumerate(acting) if set(seen) & set(channels)]
    kind = truth.kind
    if len(kept) < len(truth.effects):
        kind = {0: "none", 1: "one", 2: "pair"}[len(kept)]
    return replace(
        truth,
        kind=kind,
        effects=tuple(truth.effects[i] for i in kept),
        forms=tuple(truth.forms[i] for i in kept),
        strengths=tuple(truth.strengths[i] for i in kept),
        channels=tuple(tuple(sorted(acting[i])) for i in kept),
    )
