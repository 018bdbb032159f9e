"""The transfer functions from torque to acceleration and to sound, as the rig file has them.

What was measured is taken as measured, line by line; what was not measured is modelled. A torque is
sent through either whole, so a recording of a second costs a transform and no search for a causal
impulse response. Such a response would lack what only errors of the measurement explain, which at
low frequencies can be most of it. What effects change about the structure is added to it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from models.condition import known_condition
from models.radiation.impulse_responses import ImpulseResponses, radiate
from models.radiation.rig_response import impulse_responses
from models.recording import Recording
from models.rig import Rig
from models.transfer_functions.measured import (
    FINER,
    fill_between_lines,
    impulse_response,
    measured_with,
)
from models.transfer_functions.transfer_function import TransferFunction
from noise.base.arrays import Array
from noise.diagnosis.evidence.reconstruction import closed_length, closed_spectrum
from sim.bushing import LumpedBushing, lumped_bushing
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect, activated
from sim.motion import Motion
from sim.plan import Plan
from sim.run import Sound, pulse_force

_LONGEST = 0.25
"""Impulse responses are followed so long [s]."""

_MODEL_RATE = 96e3
"""Sampling rate at which modelled responses are computed [Hz]."""


def torque_transfer_functions(
    rig: Rig, interference: float, support_stiffness: float
) -> dict[str, TransferFunction]:
    """Return the transfer functions from the torque to ``acceleration`` and to ``pressure``.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`.

    Returns
    -------
    dict of str to TransferFunction
        From N m to m/s^2 and to Pa.

    Raises
    ------
    ParameterError
        The rig cannot be modelled with this support.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> functions = torque_transfer_functions(rig, 0.279e-3, 2214.0)
    >>> sorted(functions), bool(abs(functions["acceleration"].at(np.array([259.0]))[0]) > 1.0)
    (['acceleration', 'pressure'], True)
    """
    functions: dict[str, TransferFunction] = {}
    entry = measured_with(rig.measured, support_stiffness)
    if entry is not None:
        if entry.torque_to_acceleration is not None:
            functions["acceleration"] = fill_between_lines(entry.torque_to_acceleration)
        if entry.torque_to_pressure is not None:
            functions["pressure"] = fill_between_lines(entry.torque_to_pressure)
    if len(functions) < 2:
        modelled = impulse_responses(rig, interference, support_stiffness, _MODEL_RATE)
        for name, unit, impulse in (
            ("acceleration", "m/s^2", modelled.torque_to_acceleration),
            ("pressure", "Pa", modelled.torque_to_pressure),
        ):
            n = FINER * impulse.size
            lines = np.asarray(np.fft.rfftfreq(n, 1.0 / _MODEL_RATE), np.float64)
            functions.setdefault(
                name, TransferFunction(lines, rfft(impulse, n), None, "N m", unit, name)
            )
    return functions


class TransferFunctionCache:
    """Transfer functions of a rig, each looked up once.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect, optional
        Definitions of the effects of the rig, by name.
    """

    def __init__(self, rig: Rig, library: Mapping[str, Effect] | None = None) -> None:
        self._rig, self._library = rig, library or EFFECTS
        self._known: dict[tuple[float, float], dict[str, TransferFunction]] = {}
        self._whole: dict[tuple[float, float], dict[str, TransferFunction]] = {}

    def at(self, interference: float, support_stiffness: float) -> dict[str, TransferFunction]:
        """Return those at a condition; arguments as of `torque_transfer_functions`."""
        key = (interference, support_stiffness)
        if key not in self._known:
            self._known[key] = torque_transfer_functions(self._rig, *key)
        return self._known[key]

    def of(self, recording: Recording) -> dict[str, TransferFunction]:
        """Return those at the condition of a recording."""
        c = known_condition(recording.condition)
        return self.at(c.interference, c.support_stiffness)

    def whole(self, recording: Recording) -> dict[str, TransferFunction]:
        """Return those at the condition of a recording, with the rig's effects on the chain."""
        plain = self.of(recording)
        effects = [e for e in activated(self._rig.effects, self._library) if e.effect.chain]
        if not effects:
            return plain
        c = known_condition(recording.condition)
        key = (c.interference, c.support_stiffness)
        if key not in self._whole:
            paths = chain_of(self._rig, *key, plain, _MODEL_RATE, impacts=True)
            changed = apply_chain_effects(paths, effects, np.random.default_rng(0))
            self._whole[key] = {n: _with_change(h, n, paths, changed) for n, h in plain.items()}
        return self._whole[key]


def _with_change(
    transfer: TransferFunction, name: str, paths: ImpulseResponses, changed: ImpulseResponses
) -> TransferFunction:
    """Add to a transfer function what effects change about its way."""
    before, after = (getattr(one, f"torque_to_{name}") for one in (paths, changed))
    n = FINER * max(before.size, after.size)
    lines = np.asarray(np.fft.rfftfreq(n, 1.0 / _MODEL_RATE), np.float64)
    more = TransferFunction(lines, rfft(after, n) - rfft(before, n))
    return replace(transfer, response=transfer.response + more.at(transfer.frequencies))


def predict(torque: Array, rate: float, transfer: TransferFunction) -> Array:
    """Send a torque through a transfer function.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    rate : float
        Sampling rate [Hz].
    transfer : TransferFunction
        From N m.

    Returns
    -------
    ndarray, shape (n,)
        [output unit of `transfer`]; what rings on from before the recording is missing.

    Examples
    --------
    >>> double = TransferFunction(np.array([0.0, 4e3]), np.array([2.0 + 0j, 2.0 + 0j]))
    >>> tone = np.sin(2 * np.pi * 100.0 * np.arange(800) / 8e3)
    >>> bool(np.allclose(predict(tone, 8e3, double)[100:700], 2 * tone[100:700], atol=0.1))
    True
    """
    spectrum = closed_spectrum(torque - torque.mean(), rate)
    spectrum[0] = 0.0
    return predict_outputs(spectrum, torque.size, rate, {"": transfer})[""]


def predict_outputs(
    spectrum: NDArray[np.complex128],
    n: int,
    rate: float,
    transfer_functions: Mapping[str, TransferFunction],
    changes: Mapping[str, NDArray[np.complex128]] | None = None,
) -> dict[str, Array]:
    """Send a torque through several transfer functions, as `predict` does through one.

    Parameters
    ----------
    spectrum : ndarray of complex
        Of the torque, as `closed_spectrum` gives it [Nm].
    n : int
        Samples of the torque.
    rate : float
        Sampling rate [Hz].
    transfer_functions : mapping of str to TransferFunction
        From N m.
    changes : mapping of str to ndarray of complex, shape (n_lines,), optional
        What is added to some of them, at the lines of `spectrum` [output unit per N m].

    Returns
    -------
    dict of str to ndarray, shape (n,)
        [output unit of each]

    Examples
    --------
    >>> double = TransferFunction(np.array([0.0, 4e3]), np.array([2.0 + 0j, 2.0 + 0j]))
    >>> tone = np.sin(2 * np.pi * 100.0 * np.arange(800) / 8e3)
    >>> outputs = predict_outputs(closed_spectrum(tone, 8e3), 800, 8e3, {"pressure": double})
    >>> bool(np.allclose(outputs["pressure"], predict(tone, 8e3, double)))
    True
    """
    length, changes = closed_length(n, rate), changes or {}
    outputs = [
        spectrum * (_on_lines(transfer, length, rate) + changes.get(name, 0.0))
        for name, transfer in transfer_functions.items()
    ]
    rows = irfft(np.stack(outputs), length, axis=1)[:, :n] if outputs else ()
    return dict(zip(transfer_functions, rows, strict=True))


@lru_cache(maxsize=32)
def _on_lines(transfer: TransferFunction, length: int, rate: float) -> NDArray[np.complex128]:
    """Response at the lines of a transform; the same few are asked for again and again."""
    frequencies = np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64)
    return transfer.at(frequencies, falls_below=True)


def shift_clamp_mode(
    transfer: TransferFunction, nominal: LumpedBushing, scattered: LumpedBushing
) -> TransferFunction:
    """Move the clamp's torsional mode of a transfer function to where a scattered rig has it.

    A torque has little at the frequency at which the clamp gives way most, so a transfer function
    and a torque that disagree on it would make a resonance that neither has. Other modes stay.

    Parameters
    ----------
    transfer : TransferFunction
        From N m.
    nominal, scattered : LumpedBushing
        The rig of the transfer function, and the one of the torque.

    Returns
    -------
    TransferFunction
    """
    if nominal.clamp_is_fixed:
        return transfer
    shift = _clamp_shift(transfer.frequencies, nominal, scattered)
    return replace(transfer, response=transfer.response * shift)


def torque_outputs(
    torque: Array,
    mean: float,
    rate: float,
    transfer_functions: Mapping[str, TransferFunction],
    nominal: LumpedBushing,
    scattered: LumpedBushing,
    changes: Mapping[str, NDArray[np.complex128]] | None = None,
) -> dict[str, Array]:
    """Send the torque of a scattered rig through transfer functions of the nominal one.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        From before a recording to after it [Nm].
    mean : float
        Of the recording [Nm].
    rate : float
        Sampling rate [Hz].
    transfer_functions, changes
        As `predict_outputs` takes them.
    nominal, scattered : LumpedBushing
        The clamp's mode is moved as `shift_clamp_mode` does.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        [output unit of each]
    """
    torque = mean + faded(torque - mean, rate)
    spectrum = closed_spectrum(torque, rate)
    if not nominal.clamp_is_fixed:
        length = closed_length(torque.size, rate)
        lines = np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64)
        spectrum = spectrum * _clamp_shift(lines, nominal, scattered)
    return predict_outputs(spectrum, torque.size, rate, transfer_functions, changes)


def _clamp_shift(
    frequencies: Array, nominal: LumpedBushing, scattered: LumpedBushing
) -> NDArray[np.complex128]:
    s = 2j * np.pi * frequencies
    of_nominal, of_scattered = (
        b.support_stiffness + s * (b.support_damping + s * b.clamp_inertia)
        for b in (nominal, scattered)
    )
    return np.asarray(of_nominal / of_scattered)


def chain_of(
    rig: Rig,
    interference: float,
    support_stiffness: float,
    transfer_functions: Mapping[str, TransferFunction],
    rate: float,
    *,
    impacts: bool,
) -> ImpulseResponses:
    """Return the impulse responses of a rig.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`.
    transfer_functions : mapping of str to TransferFunction
        As `torque_transfer_functions` gives them.
    rate : float
        Sampling rate [Hz].
    impacts : bool
        Whether those of pulses in the anchors are asked for; otherwise they are 0.

    Returns
    -------
    ImpulseResponses
    """
    n = int(_LONGEST * rate)
    torque_to = {name: impulse_response(h, rate, n) for name, h in transfer_functions.items()}
    struck = sounding = np.zeros(1)
    if impacts:
        # What a torque makes is known, and costs much where it was measured.
        unmeasured = replace(rig, measured=())
        modelled = impulse_responses(unmeasured, interference, support_stiffness, rate)
        struck, sounding = modelled.pulse_to_acceleration, modelled.pulse_to_pressure
    return ImpulseResponses(
        rate, torque_to["acceleration"], torque_to["pressure"], struck, sounding
    )


OUTPUTS = ("acceleration", "pressure")
"""Channels that the structure makes of the torque."""

_FADE = 0.1
"""In which a torque fades in and out [s], outside of the recording."""

_GOING_ON = 0.12
"""For which a torque goes on after the recording, turned back in time [s]."""


def n_closed(plan: Plan) -> int:
    """Return how many samples the transforms of a plan's torque have."""
    n = plan.n_settling + plan.n_recorded + round(_GOING_ON * plan.rate)
    return closed_length(n, plan.rate)


def chain_changes(
    before: ImpulseResponses, after: ImpulseResponses, length: int
) -> dict[str, NDArray[np.complex128]]:
    """Return what effects change about the ways from the torque.

    Parameters
    ----------
    before, after : ImpulseResponses
        At the rate of the motion.
    length : int
        Of the transforms, as of `n_closed`.

    Returns
    -------
    dict of str to ndarray of complex, shape (length // 2 + 1,)
        Of ``acceleration`` and ``pressure``, where they change [output unit per N m].
    """
    changes = {}
    for name in OUTPUTS:
        one, other = (getattr(paths, f"torque_to_{name}") for paths in (before, after))
        if one is other:
            continue
        change = np.zeros(max(one.size, other.size))
        change[: other.size] += other
        change[: one.size] -= one
        changes[name] = np.asarray(rfft(change, length))
    return changes


def radiated_sound(
    motion: Motion,
    plan: Plan,
    rig: Rig,
    transfer_functions: Mapping[str, TransferFunction],
    changes: Mapping[str, NDArray[np.complex128]],
    paths: ImpulseResponses | None,
    effects: Sequence[ActiveEffect] = (),
) -> Sound:
    """Send the torque of a motion, and pulses, to the sensors.

    Parameters
    ----------
    motion : Motion
        As `plan` has it.
    plan : Plan
    rig : Rig
        Of the transfer functions; the clamp's mode is moved to where the plan's rig has it.
    transfer_functions : mapping of str to TransferFunction
        Of ``acceleration`` and ``pressure``, as `torque_transfer_functions` gives them.
    changes : mapping of str to ndarray of complex, shape (n_lines,)
        As of `chain_changes` [output unit per N m].
    paths : ImpulseResponses, optional
        Of pulses; asked for where an effect makes them.
    effects : sequence of ActiveEffect

    Returns
    -------
    Sound
        As long as the motion; right while the plan keeps it.
    """
    recorded = slice(plan.n_settling, plan.n_settling + plan.n_recorded)
    more = round(_GOING_ON * plan.rate)
    torque = motion.torque[: recorded.stop]
    torque = np.concatenate([torque, torque[-2 : -2 - more : -1]])
    at = (plan.interference, plan.support_stiffness)
    outputs = torque_outputs(
        torque, float(torque[recorded].mean()), plan.rate, transfer_functions,
        lumped_bushing(rig, *at), lumped_bushing(plan.rig, *at), changes,
    )  # fmt: skip
    acceleration, pressure = (outputs[name][: recorded.stop] for name in OUTPUTS)
    force, pulses = pulse_force(motion, effects), np.zeros_like(pressure)
    if paths is not None and np.any(force):
        struck, pulses = radiate(paths, force, "pulse")
        acceleration, pressure = acceleration + struck, pressure + pulses
    return Sound(acceleration, pressure, pulses)


def faded(signal: Array, rate: float) -> Array:
    """Fade in and out.

    Errors of a measured response have it ring before and after whatever is sudden, for as long as
    its lines are fine. What rings on from before a recording must be in it, but the start from rest
    and the end of the simulation must not.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of the signal]

    Examples
    --------
    >>> faded(np.ones(9), 40.0).round(2)
    array([0.  , 0.25, 0.75, 1.  , 1.  , 1.  , 0.75, 0.25, 0.  ])
    """
    n = round(_FADE * rate)
    slope = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, n))
    gain = np.ones(signal.size)
    gain[:n], gain[-n:] = slope, slope[::-1]
    return np.asarray(signal * gain)
