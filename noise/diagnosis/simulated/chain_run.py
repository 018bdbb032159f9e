"""A run of the rig through ways that are given: with any effects, quickly, many times over.

`sim.run.simulate` makes the ways anew from the rig; the diagnosis runs one rig and its variations
hundreds of times, and has the ways measured. The order of events is the same.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import firwin, resample_poly

from models.radiation.impulse_responses import ImpulseResponses, radiate
from models.radiation.rig_response import response
from models.recording import Channel, Recording
from models.transfer_functions.impulse_response import impulse_response
from noise.diagnosis.gap.scatter import Scatter, scattered
from sim.acquisition import Acquisition
from sim.chain import changed_chain
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition
    from models.rig import Rig
    from models.transfer_functions.transfer_function import TransferFunction
    from sim.effects.effect import ActiveEffect
    from sim.motion import Motion

__all__ = [
    "CHANNELS", "SETTLING", "chain_of", "fine_rate", "found_by_run", "heard", "moving",
    "read_by_sensors", "recorded", "run_signals", "sampled_at",
    "sensed",
]  # fmt: skip

CHANNELS = ("torque", "acceleration", "pressure", "angle")

_LEAST_RATE = 75e3
"""Of motion and sound [Hz]."""

SETTLING = 0.35
"""How long the shaft has turned before the recording starts [s]."""

_LONGEST = 0.25
"""Impulse responses are followed so long [s]."""


def fine_rate(rate: float) -> float:
    """Rate of motion and sound for a sampling rate [Hz].

    Examples
    --------
    >>> fine_rate(30e3), fine_rate(48e3)
    (90000.0, 96000.0)
    """
    return math.ceil(_LEAST_RATE / rate) * rate


def chain_of(
    rig: Rig,
    interference: float,
    support_stiffness: float,
    ways: Mapping[str, TransferFunction],
    rate: float,
    *,
    blows: bool,
) -> ImpulseResponses:
    """Return ways as impulse responses; those of blows in the anchors are modelled if asked for."""
    n = int(_LONGEST * rate)
    torque_to = {name: impulse_response(way, rate, n) for name, way in ways.items()}
    struck = sounding = np.zeros(1)
    if blows:
        modelled = response(rig, interference, support_stiffness, rate)
        struck, sounding = modelled.pulse_to_acceleration, modelled.pulse_to_pressure
    return ImpulseResponses(
        rate, torque_to["acceleration"], torque_to["pressure"], struck, sounding
    )


def run_signals(
    rig: Rig,
    condition: Condition,
    effects: Sequence[ActiveEffect],
    chain: ImpulseResponses,
    seconds: float,
    rng: np.random.Generator,
    *,
    chain_seed: int = 0,
    scatter: Scatter | None = None,
) -> dict[str, NDArray[np.float64]]:
    """Run a rig as one of its runs finds it.

    Parameters
    ----------
    rig : Rig
    condition : Condition
        Speed, interference and support stiffness.
    effects : sequence of ActiveEffect
    chain : ImpulseResponses
        Ways without effects; its rate is that of the signals.
    seconds : float
        [s]
    rng : numpy.random.Generator
    chain_seed : int
        Of effects that change the chain by chance: one structure for all runs.
    scatter : Scatter, optional

    Returns
    -------
    dict of str to ndarray
        By `CHANNELS`, without noise.
    """
    scatter = scatter or Scatter()
    once, support, speed = found_by_run(rig, condition, scatter, rng)
    motion = moving(once, condition, support, speed, effects, seconds, chain.rate, rng)
    changed = changed_chain(chain, effects, np.random.default_rng(chain_seed))
    return read_by_sensors(heard(motion, effects, changed), effects, chain.rate, rng)


def found_by_run(
    rig: Rig, condition: Condition, scatter: Scatter, rng: np.random.Generator
) -> tuple[Rig, float, float]:
    """Draw a rig, its support's stiffness [Nm/rad] and the speed [rad/s] as one run finds them."""
    assert condition.speed is not None
    assert condition.support_stiffness is not None
    support = condition.support_stiffness
    if not math.isinf(support):
        support *= float(np.exp(scatter.structure * rng.normal()))
    once = scattered(rig, scatter, rng)
    return once, support, condition.speed * float(np.exp(scatter.structure * rng.normal()))


def moving(
    rig: Rig,
    condition: Condition,
    support: float,
    speed: float,
    effects: Sequence[ActiveEffect],
    seconds: float,
    rate: float,
    rng: np.random.Generator,
) -> Motion:
    """Move a rig from rest for the recording's length, and `SETTLING` before."""
    assert condition.interference is not None
    return simulate_motion(
        rig,
        ConstantSpeed(speed),
        interference=condition.interference,
        support_stiffness=support,
        seconds=(round(SETTLING * rate) + round(seconds * rate)) / rate,
        rate=rate,
        effects=effects,
        rng=rng,
    )


def heard(
    motion: Motion, effects: Sequence[ActiveEffect], changed: ImpulseResponses
) -> dict[str, NDArray[np.float64]]:
    """Send a motion along the chain; by `CHANNELS`, without what came before the recording."""
    force = np.zeros_like(motion.torque)
    for active in effects:
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    acceleration, pressure = radiate(changed, motion.torque, force)
    settling = round(SETTLING * motion.rate)
    return {
        "torque": motion.torque[settling:],
        "acceleration": acceleration[settling:],
        "pressure": pressure[settling:],
        "angle": motion.shaft_angle[settling:] - motion.shaft_angle[settling],
    }


def read_by_sensors(
    signals: dict[str, NDArray[np.float64]],
    effects: Sequence[ActiveEffect],
    rate: float,
    rng: np.random.Generator,
) -> dict[str, NDArray[np.float64]]:
    """Let the effects on sensors change signals, in their order."""
    for active in effects:
        if active.effect.sensors is not None:
            signals = active.effect.sensors(signals, rate, active.form, active.values, rng)
    return signals


def recorded(
    signals: Mapping[str, NDArray[np.float64]],
    fine: float,
    rate: float,
    condition: Condition,
    rng: np.random.Generator,
    scatter: Scatter | None = None,
) -> Recording:
    """Sample signals and read them by good instruments, as `sensed` does."""
    sampled = {name: sampled_at(signals[name], fine, rate) for name in CHANNELS}
    return sensed(sampled, rate, condition, rng, scatter)


def sampled_at(signal: NDArray[np.float64], fine: float, rate: float) -> NDArray[np.float64]:
    """Sample a signal at a rate that its own is a multiple of."""
    decimation = round(fine / rate)
    return np.asarray(
        resample_poly(signal, 1, decimation, padtype="line", window=_anti_alias(decimation))
    )


@lru_cache(maxsize=8)
def _anti_alias(decimation: int) -> NDArray[np.float64]:
    taps = firwin(20 * decimation + 1, 1.0 / decimation, window=("kaiser", 5.0))
    return np.asarray(taps, np.float64)


def sensed(
    signals: Mapping[str, NDArray[np.float64]],
    rate: float,
    condition: Condition,
    rng: np.random.Generator,
    scatter: Scatter | None = None,
) -> Recording:
    """Read samples as good instruments do: gains that scatter, a little white noise."""
    scatter = scatter or Scatter()
    levels = Acquisition().noise
    rows = []
    for name in CHANNELS:
        x = signals[name]
        gain = 1.0 if name == "angle" else 1.0 + scatter.gain * rng.normal()
        rows.append(gain * x + levels[name] * rng.standard_normal(x.size))
    return Recording(np.stack(rows), rate, tuple(Channel(name) for name in CHANNELS), condition)
