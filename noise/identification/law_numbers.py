"""Numbers that only a law gives a meaning to, each with its 90 % interval."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.rig import Rig
from noise.base.interval import SURE_90
from noise.identification.law_model import LOCAL
from noise.identification.outcome import Number
from sim.effects import EFFECTS
from sim.friction import friction_law

if TYPE_CHECKING:
    from noise.identification.law_fit import LawFit


def law_numbers(fit: LawFit, rig: Rig) -> list[Number]:
    """Torques as the law means them, and the law's own parameters, by the curvature of the fit.

    Parameters
    ----------
    fit : LawFit
        To all recordings.
    rig : Rig
        Identified by it.
    """
    model, spread = fit.model, np.sqrt(np.diag(fit.covariance))
    error = {group: float(spread[model.n_local + g]) for g, group in enumerate(model.groups)}
    numbers = []
    for one in rig.fits:
        kinetic, drop = (
            error[LOCAL.index(name), one.interference] for name in ("kinetic_torque", "drop")
        )
        share = 1.0 - one.kinetic_torque / one.critical_torque
        for name, value, of in (
            ("law_kinetic_torque", one.kinetic_torque, kinetic),
            ("law_critical_torque", one.critical_torque, math.hypot(kinetic, share * drop)),
        ):
            low, high = _interval(value, of)
            numbers.append(Number(name, "Nm", value, low, high, 0, one.interference))
    candidate = model.candidate
    units = (
        EFFECTS[candidate.effect].parameters
        if candidate.effect
        else friction_law(candidate.law).parameters
    )
    for i, name in enumerate(candidate.free):
        value = math.exp(fit.vector[model.n_common + i])
        low, high = _interval(value, float(spread[model.n_common + i]))
        numbers.append(Number(f"friction.{name}", units[name].unit, value, low, high, 0))
    return numbers


def _interval(value: float, error: float) -> tuple[float, float]:
    away = math.exp(SURE_90 * min(error, 2.0))
    return value / away, value * away
