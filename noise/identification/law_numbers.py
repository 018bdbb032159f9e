"""Numbers that only a law gives a meaning to, each with its 90 % interval."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.identification.outcome import Number
from noise.identification.pooled import USUAL_SCATTER
from sim.effects import EFFECTS
from sim.friction import friction_law

if TYPE_CHECKING:
    from noise.identification.law_fit import LawFit

__all__ = ["law_numbers"]

_NORMAL = 1.645
"""Of a normal distribution, so many standard deviations on either side hold 90 %."""


def law_numbers(fit: LawFit) -> list[Number]:
    """Torques as the law means them, and the law's own parameters, by the curvature of the fit.

    Parameters
    ----------
    fit : LawFit
        To all recordings.
    """
    model, n = fit.model, len(fit.model.base.fits)
    rig = model.rig(fit.vector)
    numbers = []
    for i, one in enumerate(rig.fits):
        kinetic, drop = fit.spread[n + i], fit.spread[2 * n + i]
        share = 1.0 - one.kinetic_torque / one.critical_torque
        for name, value, error in (
            ("law_kinetic_torque", one.kinetic_torque, kinetic),
            ("law_critical_torque", one.critical_torque, math.hypot(kinetic, share * drop)),
        ):
            low, high = _interval(value, math.hypot(error, USUAL_SCATTER / math.sqrt(2.0)))
            numbers.append(Number(name, "Nm", value, low, high, 0, one.interference))
    candidate = model.candidate
    units = (
        EFFECTS[candidate.effect].parameters
        if candidate.effect
        else friction_law(candidate.law).parameters
    )
    for i, name in enumerate(candidate.free):
        value = math.exp(fit.vector[model.n_bushing + i])
        low, high = _interval(value, float(fit.spread[model.n_bushing + i]))
        numbers.append(Number(f"friction.{name}", units[name].unit, value, low, high, 0))
    return numbers


def _interval(value: float, error: float) -> tuple[float, float]:
    away = math.exp(_NORMAL * min(error, 2.0))
    return value / away, value * away
