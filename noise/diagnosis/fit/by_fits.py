"""Effects that the fits decide about: the user's own, and an irregularity that the rig file states.

The posterior has seen neither, the one at all, the other beside itself. So an effect that leaves
less of the gap on recordings that no fit has seen than parameters alone and than every other effect
of the library takes the verdict over, with as much probability as the share of the gap that it
closes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from noise.diagnosis.gap.distance import closed_fraction

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from noise.diagnosis.findings import EffectFinding
    from noise.diagnosis.outcome import Diagnosis

__all__ = ["prefer_by_fits"]

_CLEARLY = 0.8
"""Of two gaps the smaller one counts as smaller if it is at most this share of the other."""


def prefer_by_fits(
    diagnosis: Diagnosis, findings: Mapping[str, EffectFinding], names: Sequence[str]
) -> Diagnosis:
    """Let a fitted effect take over the verdict, if it closes the gap best.

    Parameters
    ----------
    diagnosis : Diagnosis
    findings : mapping of str to EffectFinding
        All effects that were fitted.
    names : sequence of str
        Those that the fits decide about.
    """
    gaps = {name: found.gap_after for name, found in findings.items()}
    fitted = {name: max(gap, 1.0) for name, gap in gaps.items() if gap is not None}
    mine = [name for name in names if name in fitted]
    if not mine:
        return diagnosis
    best = min(mine, key=lambda name: fitted[name])
    recalibrated = findings[best].gap_recalibrated or 0.0
    if not diagnosis.verdict and findings[best].closed is None:
        return diagnosis  # nothing is the matter, and there is no gap that says otherwise
    others = [gap for name, gap in fitted.items() if name not in names]
    if fitted[best] > _CLEARLY * min([recalibrated, *others]):
        return diagnosis
    closed = findings[best].closed
    if closed is None:  # a small gap; what is left of the recalibrated one tells
        closed = closed_fraction(recalibrated, fitted[best])
    closed = min(max(closed, 0.0), 1.0)
    rest = 1.0 - closed
    probabilities = {name: rest * p for name, p in diagnosis.probabilities.items()}
    return replace(diagnosis, verdict=(best,), probabilities={**probabilities, best: closed})
