"""The improved rig: parameters and effects as a rig file can say them, where they close the gap.

A fit may find that a form fits best which was estimated from the recordings, or drawn at random;
no rig file knows those. Here the cause that the verdict names is fitted in forms of the simulator's
own, and the rig is offered as improved only if recordings that no fit has seen agree with it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.rig_files.change import changed_rig, multiplied
from models.rig_files.rig_parts import parse_spec
from noise.diagnosis.cases.rigs import OFFSETS
from noise.diagnosis.first_answer import first_answer
from noise.diagnosis.fit.case_comparison import CaseComparison, Model
from noise.diagnosis.fit.closing import rms
from noise.diagnosis.fit.fit_effect import number_spreads
from noise.diagnosis.fit.stated_fit import fit_stated
from noise.diagnosis.improvement import Improvement

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.rig import LawSpec, Rig
    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior
    from noise.diagnosis.fit.fit_parameters import Fitted

__all__ = ["improved_rig"]

CLOSED = 1.75
"""Floors up to which a gap counts as closed; two recordings that a right model is judged by leave
more one time in fifty."""

_SIMPLER = 0.95
"""With effects a rig must leave at most this share of what it leaves with parameters alone."""

_UNDETERMINED = 1.4
"""Standard deviation of a logarithm from which on a number is not determined."""


def improved_rig(
    case: Case,
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    held: Sequence[int],
    candidates: Sequence[Fitted],
    posterior: Posterior,
    seed: int = 0,
) -> Improvement | None:
    """Offer an improved rig.

    Parameters
    ----------
    case : Case
    comparison : CaseComparison
    fitted_to, held : sequence of int
        Recordings, as `noise.diagnosis.fit.fit_parameters.split` divides them.
    candidates : sequence of Fitted
        Parameters alone, and then effects in whatever forms fitted best, the verdict's first.
    posterior : Posterior
    seed : int
        Of what is tried, and of simulated repeats.

    Returns
    -------
    Improvement or None
        None where none closes the gap of the recordings held out, so that nothing is left to
        explain of all of them.
    """
    alone, *others = candidates
    first = [alone, *(fit_stated(comparison, fitted_to, one, alone, seed) for one in others[:1])]
    left = [rms(comparison.squared(one.model, held)) for one in first]
    if len(first) > 1 and left[1] <= _SIMPLER * left[0]:
        first = first[::-1]
    further = (fit_stated(comparison, fitted_to, one, alone, seed) for one in others[1:])
    for fitted in chain(first, further):
        after = rms(comparison.squared(fitted.model, held))
        if after > CLOSED:
            continue
        try:
            factors, rig = _rig(case.rig, fitted.model)
        except ParameterError:  # beyond what is possible of a rig
            continue
        again = first_answer(replace(case, rig=rig), comparison.library, posterior, seed)
        if not again.verdict:
            break
    else:
        return None
    spread = dict(zip(OFFSETS, fitted.spread, strict=False))
    spread |= number_spreads(comparison, fitted_to, fitted.model)
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
        gap_before=rms(comparison.squared(Model(), held)),
        gap_after=after,
    )


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
