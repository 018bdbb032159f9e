"""Forms of linear effects, estimated: what is heard, felt or read too much of what was expected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.transfer_functions.filtering import filter_signal, impulse_response
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.fit.forms.form import Form, amount_form
from noise.diagnosis.fit.forms.wiener import Noise, wiener_estimate
from sim.chain import filter_pressure, padded_sum
from sim.effects.effect import Signals, Values

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses
    from noise.diagnosis.fit.forms.form import Compared


_NOISE = {"acceleration": 0.03, "pressure": 1e-3}
"""White noise of a channel over a change of one, rms in its unit; assumed."""

_OF_TORQUE = 0.005
"""White noise of an acceleration over a mode's constant, rms [Nm]; assumed."""

_FREE = 0.06
"""How long beams ring [s]; assumed."""


def radiation_forms(name: str, compared: Sequence[Compared], length: float) -> list[Form]:
    """Estimate what the sound has too much of the expected one.

    Parameters
    ----------
    name : str
        ``plate_modes`` or ``room_reflections``.
    compared : sequence of Compared
    length : float
        Of the impulse response [s].
    """
    found = _relative(compared, "pressure", length, 0.0)
    if found is None:
        return []

    def chain(
        paths: ImpulseResponses, _form: str, values: Values, _rng: np.random.Generator
    ) -> ImpulseResponses:
        taps = values["amount"] * impulse_response(found, paths.rate, round(length * paths.rate))
        taps[0] += 1.0
        return filter_pressure(paths, taps)

    return [amount_form(name, f"estimated {1e3 * length:.0f} ms", chain=chain)]


def sensor_forms(
    name: str, compared: Sequence[Compared], length: float, before: float = 0.0
) -> list[Form]:
    """Estimate what each channel reads too much; of the torque, what would make the others' of it.

    Parameters
    ----------
    name : str
        ``mount_resonance``, ``gain_error`` or ``channel_delay``.
    compared : sequence of Compared
    length, before : float
        Of the impulse response, after and before the impulse [s].
    """
    transfers = {
        kind: found
        for kind in ("acceleration", "pressure")
        if (found := _relative(compared, kind, length, before)) is not None
    }
    if len(transfers) == 2:
        both = sum(1.0 + found.response for found in transfers.values()) / 2.0
        size = np.maximum(np.abs(both), 0.2)
        frequency = next(iter(transfers.values())).frequencies
        inverse = np.conj(both) / size**2 - 1.0
        transfers["torque"] = TransferFunction(frequency, np.asarray(inverse))
    forms = [_sensor_form(name, {kind: found}) for kind, found in transfers.items()]
    if "torque" in transfers:
        forms.append(_sensor_form(name, {k: transfers[k] for k in ("acceleration", "pressure")}))
    return forms


def _sensor_form(name: str, transfers: Mapping[str, TransferFunction]) -> Form:
    def sensors(
        signals: Signals, rate: float, _form: str, values: Values, _rng: np.random.Generator
    ) -> Signals:
        more = {k: filter_signal(signals[k], rate, t) for k, t in transfers.items()}
        return signals | {k: signals[k] + values["amount"] * x for k, x in more.items()}

    of = " and ".join(transfers)
    return amount_form(name, f"estimated of {of}", sensors=sensors)


def beam_forms(compared: Sequence[Compared]) -> list[Form]:
    """Estimate what torque makes of acceleration and sound beside what was expected."""
    having = [c for c in compared if "acceleration" in c.expected]
    free = [c for c in having if c.free]
    forms = [_beam_form(free, "on beams")] if free else []
    if len(free) < len(having):
        forms.append(_beam_form(having, "however the clamp stands"))
    return forms


def _beam_form(having: Sequence[Compared], where: str) -> Form:
    only_free = all(c.free for c in having)
    kinds = [k for k in ("acceleration", "pressure") if all(k in c.expected for c in having)]
    found = {
        kind: wiener_estimate(
            [(c.measured["torque"], c.measured[kind] - c.expected[kind]) for c in having],
            having[0].rate, _FREE, noise=[Noise(_OF_TORQUE) for _ in having],
        )
        for kind in kinds
    }  # fmt: skip

    def chain(
        paths: ImpulseResponses, _form: str, values: Values, _rng: np.random.Generator
    ) -> ImpulseResponses:
        if only_free and not np.any(paths.pulse_to_acceleration):
            return paths  # the clamp is bolted down
        n = round(_FREE * paths.rate)
        more = {k: values["amount"] * impulse_response(t, paths.rate, n) for k, t in found.items()}
        nothing = np.zeros(1)
        return replace(
            paths,
            torque_to_acceleration=padded_sum(
                [paths.torque_to_acceleration, more.get("acceleration", nothing)]
            ),
            torque_to_pressure=padded_sum(
                [paths.torque_to_pressure, more.get("pressure", nothing)]
            ),
        )

    return amount_form("beam_modes", f"estimated {where}", chain=chain)


def _relative(
    compared: Sequence[Compared], kind: str, length: float, before: float
) -> TransferFunction | None:
    """Estimate what a channel has too much of what was expected of it."""
    having = [c for c in compared if kind in c.expected]
    if not having:
        return None
    pairs = [(c.expected[kind], c.measured[kind] - c.expected[kind]) for c in having]
    noise = [Noise(_NOISE[kind], c.transfer_functions[kind]) for c in having]
    return wiener_estimate(pairs, having[0].rate, length, before, noise=noise)
