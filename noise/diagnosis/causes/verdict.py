"""From probabilities to a verdict: nothing, parameters, unknown, or one to three effects."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.diagnosis.gap.distance import Gap

__all__ = ["verdict_of"]

NAMED = 0.5
"""An effect beside the first is named from this probability."""

MOST = 3

BEYOND = 2.5
"""Floors from which a gap that repeats hardly ever have is one to explain."""

RARE = 0.002
"""Probability of a gap between repeats that is hardly ever met."""

_EXCLUSIVE = ("parameters", "unknown")


def verdict_of(
    probabilities: Mapping[str, float], alarm: float, gap: Gap | None = None
) -> tuple[str, ...]:
    """Decide what to say.

    Parameters
    ----------
    probabilities : mapping of str to float
        Of every cause being at work.
    alarm : float
        Probability of ``none`` below which there is something to explain.
    gap : Gap, optional
        Against simulated repeats; one that these hardly ever have needs explaining as well.

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
