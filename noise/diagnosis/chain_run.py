"""A run of the rig through ways that are given: with any effects, quickly, many times over.

`sim.run.simulate` makes the ways anew from the rig; the diagnosis runs one rig and its variations
hundreds of times, and has the ways measured. The order of events is the same.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft
from scipy.signal import resample_poly

from models.radiation import response
from models.recording import Channel, Recording
from models.response import Response, radiate
from noise.diagnosis.scatter import Scatter, scattered
from sim.acquisition import Acquisition
from sim.chain import changed_chain
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition
    from models.rig import Rig
    from noise.diagnosis.paths import Way
    from sim.effects.effect import ActiveEffect

__all__ = ["CHANNELS", "chain_of", "fine_rate", "recorded", "run_signals", "sensed"]

CHANNELS = ("torque", "acceleration", "pressure", "angle")

_LEAST_RATE = 75e3
"""Of motion and sound [Hz]."""

_SETTLING = 0.35
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
    ways: Mapping[str, Way],
    rate: float,
    *,
    blows: bool,
) -> Response:
    """Return ways as impulse responses; those of blows in the anchors are modelled if asked for."""
    n = int(_LONGEST * rate)
    frequency = np.asarray(np.fft.rfftfreq(2 * n, 1.0 / rate), np.float64)
    x = np.clip((frequency - 0.4 * rate) / (0.05 * rate), 0.0, 1.0)
    taper = 0.5 + 0.5 * np.cos(np.pi * x)
    torque_to = {
        name: np.asarray(irfft(way.at(frequency) * taper, 2 * n)[:n]) for name, way in ways.items()
    }
    struck = heard = np.zeros(1)
    if blows:
        modelled = response(rig, interference, support_stiffness, rate)
        struck, heard = modelled.pulse_to_acceleration, modelled.pulse_to_pressure
    return Response(rate, torque_to["acceleration"], torque_to["pressure"], struck, heard)


def run_signals(
    rig: Rig,
    condition: Condition,
    effects: Sequence[ActiveEffect],
    chain: Response,
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
    chain : Response
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
    assert condition.speed is not None
    assert condition.interference is not None
    assert condition.support_stiffness is not None
    scatter = scatter or Scatter()
    rate, settling = chain.rate, round(_SETTLING * chain.rate)
    support = condition.support_stiffness
    if not math.isinf(support):
        support *= float(np.exp(scatter.structure * rng.normal()))
    motion = simulate_motion(
        scattered(rig, scatter, rng),
        ConstantSpeed(condition.speed * float(np.exp(scatter.structure * rng.normal()))),
        interference=condition.interference,
        support_stiffness=support,
        seconds=(settling + round(seconds * rate)) / rate,
        rate=rate,
        effects=effects,
        rng=rng,
    )
    force = np.zeros_like(motion.torque)
    for active in effects:
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    changed = changed_chain(chain, effects, np.random.default_rng(chain_seed))
    acceleration, pressure = radiate(changed, motion.torque, force)
    signals = {
        "torque": motion.torque[settling:],
        "acceleration": acceleration[settling:],
        "pressure": pressure[settling:],
        "angle": motion.shaft_angle[settling:] - motion.shaft_angle[settling],
    }
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
    decimation = round(fine / rate)
    sampled = {
        name: resample_poly(signals[name], 1, decimation, padtype="line") for name in CHANNELS
    }
    return sensed(sampled, rate, condition, rng, scatter)


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
