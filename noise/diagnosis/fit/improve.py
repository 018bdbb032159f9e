"""The improved rig: parameters and effects as a rig file can say them, where they close the gap.

A fit may find that a form fits best which was estimated from the recordings, or drawn at random;
no rig file knows those. Here the cause that the verdict names is fitted in forms of the simulator's
own, and the rig is offered as improved only if recordings that no fit has seen agree with it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.rig_files.change import changed_rig, multiplied
from models.rig_files.rig_parts import parse_spec
from noise.diagnosis.cases.rigs import OFFSETS
from noise.diagnosis.fit.case_comparison import CaseComparison, Model
from noise.diagnosis.fit.closing import rms
from noise.diagnosis.fit.fit_effect import fit_effect, is_stated, number_spreads
from noise.diagnosis.improvement import Improvement

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.rig import LawSpec, Rig
    from noise.diagnosis.case import Case
    from noise.diagnosis.fit.fit_parameters import Fitted

__all__ = ["improved_rig"]

CLOSED = 1.35
"""Floors on held-out recordings up to which a gap counts as closed."""

_LESS = 0.95
"""Of two gaps the smaller one counts as smaller if it is at most this share of the other."""

_UNDETERMINED = 1.4
"""Standard deviation of a logarithm from which on a number is not determined."""


def improved_rig(
    case: Case,
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    held: Sequence[int],
    names: Sequence[str],
    fitted: Fitted | None,
    alone: Fitted,
    seed: int = 0,
) -> Improvement | None:
    """Offer an improved rig.

    Parameters
    ----------
    case : Case
    comparison : CaseComparison
    fitted_to, held : sequence of int
        Recordings, as `noise.diagnosis.fit.fit_parameters.split` divides them.
    names : sequence of str
        Effects of the verdict; none where parameters are off, or the cause is unknown.
    fitted : Fitted, optional
        These, in whatever forms fitted best.
    alone : Fitted
        The parameters without any effect.
    seed : int

    Returns
    -------
    Improvement or None
        None where the gap does not close.
    """
    candidates = [alone]
    if fitted is not None:
        if not all(is_stated(comparison, spec) for spec in fitted.model.effects):
            fitted = fit_effect(comparison, fitted_to, names, alone.model, seed, stated=True)
        candidates.append(fitted)
    left = [_left(comparison, one.model, held) for one in candidates]
    best = 1 if len(left) > 1 and left[1] <= _LESS * left[0] else 0
    before = rms(comparison.squared(Model(), held))
    if left[best] > min(CLOSED, _LESS * before):
        return None
    chosen = candidates[best]
    try:
        factors, rig = _rig(case.rig, chosen.model)
    except ParameterError:  # beyond what is possible of a rig
        return None
    spread = dict(zip(OFFSETS, chosen.spread, strict=False)) | number_spreads(
        comparison, fitted_to, chosen.model
    )
    return Improvement(
        rig=rig,
        factors=factors,
        effects=rig.effects[len(case.rig.effects) :],
        spread={
            name: math.sqrt(math.expm1(s**2)) for name, s in spread.items() if s < _UNDETERMINED
        },
        undetermined=tuple(name for name, s in spread.items() if s >= _UNDETERMINED),
        fitted_to=tuple(case.names[i] for i in fitted_to),
        held_out=tuple(case.names[i] for i in held),
        gap_before=before,
        gap_after=left[best],
    )


def _left(comparison: CaseComparison, model: Model, held: Sequence[int]) -> float:
    try:
        return rms(comparison.squared(model, held))
    except ParameterError:
        return math.inf


def _rig(rig: Rig, model: Model) -> tuple[dict[str, float], Rig]:
    """Return factors and the rig with them and with effects, to the digits of a rig file."""
    factors = {
        name: math.exp(x) for name, x in zip(OFFSETS, model.offsets, strict=True) if x != 0.0
    }
    kinetic, critical = (factors.get(name, 1.0) for name in ("kinetic_torque", "critical_torque"))
    least = max(kinetic * fit.kinetic_torque / fit.critical_torque for fit in rig.fits)
    if critical < least * (1.0 + _ROUNDING):  # a contact breaks at no less than it slides at
        factors["critical_torque"] = least * (1.0 + _ROUNDING)
    changed = changed_rig(rig, multiplied(rig, {}, factors), "improved rig")
    return factors, replace(changed, effects=(*rig.effects, *map(_in_file, model.effects)))


_ROUNDING = 2e-6


def _in_file(spec: LawSpec) -> LawSpec:
    return parse_spec(str(spec))
