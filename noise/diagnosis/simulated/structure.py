"""Acceleration and sound that a simulated torque makes, by the structure's transfer functions.

A measured response is taken line by line, as it is where recordings are compared with what their
torque should make of them: a causal impulse response of it would lack what only errors of the
measurement explain, which at low frequencies can be most of it. What effects change about the
structure is added to it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from models.radiation.impulse_responses import ImpulseResponses, radiate
from models.rig import Rig
from models.transfer_functions.transfer_function import TransferFunction
from noise.base.arrays import Array
from noise.diagnosis.evidence.reconstruction import closed_length, closed_spectrum
from noise.diagnosis.simulated.transfer_functions import predict_outputs, with_clamp_shifted
from sim.bushing import lumped_bushing
from sim.effects.effect import ActiveEffect
from sim.motion import Motion
from sim.plan import Plan
from sim.run import Sound, pulse_force

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
    mean = float(torque[recorded].mean())
    torque = mean + faded(torque - mean, plan.rate)
    at = (plan.interference, plan.support_stiffness)
    bushing, scattered = lumped_bushing(rig, *at), lumped_bushing(plan.rig, *at)
    spectrum = with_clamp_shifted(
        closed_spectrum(torque, plan.rate), torque.size, plan.rate, bushing, scattered
    )
    outputs = predict_outputs(spectrum, torque.size, plan.rate, transfer_functions, changes)
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
