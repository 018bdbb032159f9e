"""Repeats of a run: a rig that is never quite the same twice, its motion and its recording.

A bushing is pressed in again, warms by a few kelvin, wears: between two runs of one condition its
stiffness, torques and damping come out a few per cent apart, and nobody's fault. A simulation that
is to be compared with one recording is therefore run as several replicates, each of a rig drawn
about the nominal one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition, KnownCondition
from models.radiation.impulse_responses import ImpulseResponses
from models.recording import Channel, Recording
from models.rig import Fit, Rig
from models.sensors import Sensors
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.simulated.heard import chain_changes, heard_of, n_closed
from sim.acquisition import Acquisition, decimate_sensed, digitise
from sim.chain import changed_chain
from sim.effects.effect import ActiveEffect, activated
from sim.motion import Motion
from sim.run import (
    DIAGNOSIS,
    Plan,
    apply_sensor_effects,
    radiate_motion,
    run_motion,
    sensor_signals,
)
from sim.shaft import ConstantSpeed
from sim.temperature import at_temperature


@dataclass(frozen=True)
class Scatter:
    """Relative standard deviations from run to run.

    Parameters
    ----------
    bushing : float
        Of the elastomer's stiffness, damping and inertia, the kinetic torque, and what the
        critical torque exceeds it by, each on its own; assumed [-].
    structure : float
        Of the clamp's inertia, the support's stiffness and the speed; assumed [-].
    gain : float
        Of the sensors' sensitivities; assumed [-].
    noise : float
        Of the sensors' noise, where it is known; assumed [-].
    """

    bushing: float = 0.02
    structure: float = 0.004
    gain: float = 0.01
    noise: float = 0.1

    def structure_factor(self, rng: np.random.Generator) -> float:
        """Draw by what a value of the structure differs in one run [-]."""
        return float(np.exp(self.structure * rng.normal()))


def perturb_run(
    rig: Rig,
    condition: KnownCondition,
    scatter: Scatter,
    rng: np.random.Generator,
    *,
    support: bool = False,
) -> tuple[Rig, KnownCondition]:
    """Draw a rig and its condition as one of its runs finds them.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    scatter : Scatter
    rng : numpy.random.Generator
    support : bool
        Whether the support's stiffness scatters as well, where the clamp is not bolted down.

    Returns
    -------
    Rig, KnownCondition

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.rig_file import load_material_rig
    >>> rig, at = load_material_rig("PDMS"), KnownCondition(5.0, 0.279e-3, 2214.0)
    >>> once = perturb_run(rig, at, Scatter(), np.random.default_rng(1))[1]
    >>> once.speed != 5.0, once.support_stiffness
    (True, 2214.0)
    """
    stiffness = condition.support_stiffness
    if support and not math.isinf(stiffness):
        stiffness *= scatter.structure_factor(rng)
    once = perturb_rig(rig, scatter, rng)
    speed = condition.speed * scatter.structure_factor(rng)
    return once, replace(condition, speed=speed, support_stiffness=stiffness)


def perturb_rig(rig: Rig, scatter: Scatter, rng: np.random.Generator) -> Rig:
    """Draw a rig as one of its runs finds it.

    Parameters
    ----------
    rig : Rig
    scatter : Scatter
    rng : numpy.random.Generator

    Returns
    -------
    Rig

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> once = perturb_rig(rig, Scatter(), np.random.default_rng(1))
    >>> 0.9 < once.elastomer_inertia / rig.elastomer_inertia < 1.1
    True
    """
    stiffness, kinetic, drop, damping, inertia = np.exp(scatter.bushing * rng.standard_normal(5))
    # the support's stiffness scatters too; what counts is the clamp's frequency, hence the root
    clamp = float(np.exp(math.sqrt(2.0) * scatter.structure * rng.standard_normal()))

    def drawn(fit: Fit) -> Fit:
        sliding = fit.kinetic_torque * float(kinetic)
        excess = (fit.critical_torque - fit.kinetic_torque) * float(drop)
        return replace(
            fit,
            elastomer_stiffness=fit.elastomer_stiffness * float(stiffness),
            kinetic_torque=sliding,
            critical_torque=sliding + excess,
            damping={support: c * float(damping) for support, c in fit.damping.items()},
        )

    return replace(
        rig,
        fits=tuple(drawn(fit) for fit in rig.fits),
        elastomer_inertia=rig.elastomer_inertia * float(inertia),
        clamp_inertia=rig.clamp_inertia * clamp,
    )


CHANNELS = ("torque", "acceleration", "pressure", "angle")


def plan_repeat(
    rig: Rig,
    condition: KnownCondition,
    effects: Sequence[ActiveEffect],
    *,
    rate: float,
    seconds: float,
) -> Plan:
    """Plan a run at a condition.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    effects : sequence of ActiveEffect
    rate : float
        Of motion and sound [Hz].
    seconds : float
        Of the recording [s].

    Returns
    -------
    Plan

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.rig_file import load_material_rig
    >>> at = KnownCondition(5.0, 0.279e-3, 2214.0)
    >>> plan = plan_repeat(load_material_rig("PDMS"), at, (), rate=DIAGNOSIS.rate(30e3), seconds=1)
    >>> plan.rate, plan.n_settling, plan.n_kept
    (90000.0, 22500, 90000)
    """
    ambient = at_temperature(rig, condition.temperature)
    return Plan(
        rig=ambient,
        shaft=ConstantSpeed(condition.speed),
        interference=condition.interference,
        support_stiffness=condition.support_stiffness,
        effects=(*effects, *activated(ambient.effects[len(rig.effects) :], {})),
        rate=rate,
        n_settling=round(DIAGNOSIS.settling * rate),
        n_kept=round(seconds * rate),
    )


def repeat_motion(plan: Plan, rng: np.random.Generator, tolerance: float | None = None) -> Motion:
    """Simulate the motion of a run as exactly as a comparison needs.

    Parameters
    ----------
    plan : Plan
    rng : numpy.random.Generator
        As of `run_motion`.
    tolerance : float, optional
        As of `run_motion`, by default that of `sim.run.DIAGNOSIS` [-].
    """
    return run_motion(plan, rng, tolerance=tolerance or DIAGNOSIS.tolerance)


def run_signals(
    rig: Rig,
    condition: KnownCondition,
    effects: Sequence[ActiveEffect],
    chain: ImpulseResponses,
    seconds: float,
    rng: np.random.Generator,
    *,
    chain_seed: int = 0,
    scatter: Scatter | None = None,
    transfer_functions: Mapping[str, TransferFunction] | None = None,
) -> dict[str, NDArray[np.float64]]:
    """Run a rig as one of its runs finds it.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    effects : sequence of ActiveEffect
    chain : ImpulseResponses
        Responses without effects; their rate is that of the signals.
    seconds : float
        [s]
    rng : numpy.random.Generator
    chain_seed : int
        Of effects that change the chain by chance: one structure for all runs.
    scatter : Scatter, optional
    transfer_functions : mapping of str to TransferFunction, optional
        What the responses of `chain` were made of; where given the torque goes through these.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        By `CHANNELS`, without noise [unit of the channel].

    Raises
    ------
    ParameterError
        The rig cannot be simulated.
    """
    once, at = perturb_run(rig, condition, scatter or Scatter(), rng, support=True)
    plan = plan_repeat(once, at, effects, rate=chain.rate, seconds=seconds)
    motion = repeat_motion(plan, rng)
    changed = changed_chain(chain, effects, np.random.default_rng(chain_seed))
    if transfer_functions is None:
        sound = radiate_motion(motion, changed, effects)
    else:
        changes = chain_changes(chain, changed, n_closed(plan))
        sound = heard_of(motion, plan, rig, transfer_functions, changes, changed, effects)
    signals = sensor_signals(motion, sound, plan.n_settling)
    return apply_sensor_effects(signals, effects, chain.rate, rng)


def record(
    signals: Mapping[str, NDArray[np.float64]],
    rate: float,
    condition: Condition,
    rng: np.random.Generator,
    scatter: Scatter | None = None,
    *,
    decimation: int = 1,
    sensors: Sensors | None = None,
) -> Recording:
    """Sample signals by good instruments: gains that scatter, a little white noise.

    Parameters
    ----------
    signals : mapping of str to ndarray, shape (n,)
        By `CHANNELS`, at `decimation` times the sampling rate.
    rate : float
        Sampling rate [Hz].
    condition : Condition
    rng : numpy.random.Generator
        Of gains and noise.
    scatter : Scatter, optional
        Of the gains.
    decimation : int
    sensors : Sensors, optional
        That a rig file states: its gains scatter before they clip and round.

    Returns
    -------
    Recording
    """
    scatter = scatter or Scatter()
    acquisition = Acquisition(rate=rate).over(_scattered(sensors or Sensors(), scatter, rng))
    rows = []
    for name in CHANNELS:
        sensor = acquisition.sensors.of(name)
        x = decimate_sensed(signals[name], decimation, decimation * rate, sensor)
        gain = 1.0 if name == "angle" else 1.0 + scatter.gain * rng.normal()
        rows.append(digitise(gain * x, name, acquisition, rng))
    return Recording(np.stack(rows), rate, tuple(Channel(name) for name in CHANNELS), condition)


def _scattered(sensors: Sensors, scatter: Scatter, rng: np.random.Generator) -> Sensors:
    """Return sensors as noisy as one run finds them."""
    factors = np.exp(scatter.noise * rng.spawn(1)[0].standard_normal(len(CHANNELS))).tolist()
    factor = dict(zip(CHANNELS, factors, strict=True))
    by_kind = {
        kind: replace(sensor, noise=sensor.noise * factor.get(kind, 1.0))
        if sensor.noise
        else sensor
        for kind, sensor in sensors.by_kind.items()
    }
    return replace(sensors, by_kind=by_kind)
