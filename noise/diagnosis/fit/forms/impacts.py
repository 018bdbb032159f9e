"""Impacts at slips, estimated: what each drop of the torque does to acceleration and sound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.transfer_functions.filtering import impulse_response
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.fit.forms.form import Form, amount_form
from noise.diagnosis.fit.forms.wiener import wiener_estimate
from sim.effects.effect import Values
from sim.effects.slip_pulse import torque_drops

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses
    from noise.diagnosis.fit.forms.form import Compared
    from sim.motion import Motion


_LENGTH = 0.08
"""How long an impact rings on [s]; assumed."""

_POWERS = (0.5, 1.0, 0.0)
"""Of a drop, to which its impact is proportional."""

_LEAST_DROP = 0.15
"""Smallest drop that counts, as a share of the torque's range; assumed."""


def impact_forms(compared: Sequence[Compared]) -> list[Form]:
    """Estimate the impacts.

    Parameters
    ----------
    compared : sequence of Compared

    Returns
    -------
    list of Form
        By the power of the drop that an impact is proportional to.
    """
    having = [c for c in compared if {"acceleration", "pressure"} <= set(c.expected)]
    return [_form(having, power) for power in _POWERS] if having else []


def _form(compared: Sequence[Compared], power: float) -> Form:
    rate = compared[0].rate
    trains = [_train(c.measured["torque"], power) for c in compared]
    found = {
        kind: wiener_estimate(
            [
                (train, c.measured[kind] - c.expected[kind])
                for train, c in zip(trains, compared, strict=True)
            ],
            rate, _LENGTH, 5e-4, restored=True,
        )
        for kind in ("acceleration", "pressure")
    }  # fmt: skip

    def force(motion: Motion, _form: str, values: Values) -> NDArray[np.float64]:
        return np.asarray(values["amount"] * _train(motion.torque, power))

    def chain(
        paths: ImpulseResponses, _form: str, _values: Values, _rng: np.random.Generator
    ) -> ImpulseResponses:
        to_acceleration, to_pressure = (_kernel(found[k], paths.rate, rate) for k in found)
        return replace(paths, pulse_to_acceleration=to_acceleration, pulse_to_pressure=to_pressure)

    return amount_form("slip_pulse", f"estimated, power {power:g}", force=force, chain=chain)


def _train(torque: NDArray[np.float64], power: float) -> NDArray[np.float64]:
    """One sample for each drop of the torque, its size a power of the drop's."""
    train = np.zeros_like(torque)
    low, high = np.quantile(torque, (0.005, 0.995))
    turn = -1.0 if torque.mean() < 0.0 else 1.0
    where, drops = torque_drops(turn * torque, max(_LEAST_DROP * float(high - low), 1e-6))
    np.add.at(train, where, turn * drops**power)
    return train


def _kernel(found: TransferFunction, rate: float, estimated_at: float) -> NDArray[np.float64]:
    """Response to one sample, which is shorter at a higher rate."""
    return impulse_response(found, rate, round(_LENGTH * rate)) * (rate / estimated_at)
