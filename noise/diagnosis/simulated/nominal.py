"""Nominal repeats: a condition simulated quickly and often, with the rig as its file has it.

The transfer functions are those of the structure, applied to the simulated
torque, so a repeat costs a few milliseconds. A rig file that lists effects beyond friction and
drive is run through impulse responses instead, as the models are that a fit compares.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.condition import KnownCondition, known_condition
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensor
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.evidence.reconstruction import closed_spectrum
from noise.diagnosis.simulated.heard import faded
from noise.diagnosis.simulated.repeats import (
    CHANNELS,
    Scatter,
    perturb_run,
    plan_repeat,
    record,
    repeat_motion,
)
from noise.diagnosis.simulated.transfer_functions import (
    TransferFunctionCache,
    chain_of,
    predict_outputs,
    shift_clamp_mode,
    with_clamp_shifted,
)
from sim.acquisition import decimate_sensed
from sim.bushing import lumped_bushing
from sim.chain import changed_chain
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect, activated
from sim.run import DIAGNOSIS, apply_sensor_effects, radiate_motion, sensor_signals

_RUNNING_OUT = 0.12
"""Simulated after a recording ends [s]."""

_OUTPUTS = ("acceleration", "pressure")


def nominal_recordings(
    rig: Rig,
    condition: KnownCondition,
    transfer_functions: Mapping[str, TransferFunction],
    *,
    rate: float,
    seconds: float,
    seeds: Sequence[int],
    scatter: Scatter | None = None,
    library: Mapping[str, Effect] | None = None,
) -> list[Recording]:
    """Simulate repeats of a run of the rig as its file has it.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    transfer_functions : mapping of str to TransferFunction
        As `torque_transfer_functions` gives them for this condition.
    rate, seconds : float
        [Hz], [s]
    seeds : sequence of int
        One a repeat.
    scatter : Scatter, optional
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among.

    Returns
    -------
    list of Recording

    Raises
    ------
    ParameterError
        The rig cannot be simulated.
    """
    scatter = scatter or Scatter()
    effects = activated(rig.effects, library or EFFECTS)
    if any(e.effect.force or e.effect.chain or e.effect.sensors for e in effects):
        return [
            _with_effects(rig, condition, effects, transfer_functions, rate, seconds, seed, scatter)
            for seed in seeds
        ]
    decimation = DIAGNOSIS.decimation(rate)
    before = round(DIAGNOSIS.settling * rate)
    kept = slice(before, before + round(seconds * rate))
    n = (kept.stop + round(_RUNNING_OUT * rate)) * decimation
    at = (condition.interference, condition.support_stiffness)
    bushing = lumped_bushing(rig, *at)
    corners = {name: rig.sensors.of(name).antialias for name in CHANNELS}
    recordings = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        once, found = perturb_run(rig, condition, scatter, rng)
        plan = plan_repeat(once, found, effects, rate=DIAGNOSIS.rate(rate), seconds=seconds)
        motion = repeat_motion(replace(plan, n_settling=0, n_kept=n), rng)
        # What a sensor's filter does to a sound, it does to the torque that makes it.
        by_filter = {
            corner: decimate_sensed(motion.torque, decimation, plan.rate, Sensor(antialias=corner))
            for corner in {corners[name] for name in ("torque", *_OUTPUTS)}
        }
        angle = decimate_sensed(motion.shaft_angle, decimation, plan.rate, rig.sensors.of("angle"))
        lumped = lumped_bushing(once, *at)
        outputs: dict[str, NDArray[np.float64]] = {}
        for corner in {corners[name] for name in _OUTPUTS}:
            paths = {n: transfer_functions[n] for n in _OUTPUTS if corners[n] == corner}
            torque = _steadied(by_filter[corner], kept, rate)
            spectrum = with_clamp_shifted(
                closed_spectrum(torque, rate), torque.size, rate, bushing, lumped
            )
            outputs |= predict_outputs(spectrum, torque.size, rate, paths)
        signals = {
            "torque": by_filter[corners["torque"]][kept],
            **{name: outputs[name][kept] for name in _OUTPUTS},
            "angle": angle[kept] - angle[before],
        }
        through = rig.sensors.unfiltered()
        recordings.append(record(signals, rate, condition, rng, scatter, sensors=through))
    return recordings


def nominal_repeats(
    template: Recording,
    rig: Rig,
    transfer_functions: TransferFunctionCache,
    seeds: Sequence[int],
    scatter: Scatter | None = None,
    library: Mapping[str, Effect] | None = None,
) -> list[Recording]:
    """Simulate repeats at the condition, rate and length of a recording.

    Parameters
    ----------
    template : Recording
    rig : Rig
    transfer_functions : TransferFunctionCache
        Of the rig.
    seeds, scatter, library
        As of `nominal_recordings`.

    Returns
    -------
    list of Recording
    """
    return nominal_recordings(
        rig, known_condition(template.condition), transfer_functions.of(template),
        rate=template.rate, seconds=template.duration, seeds=seeds, scatter=scatter,
        library=library,
    )  # fmt: skip


def condition_key(recording: Recording) -> tuple[float, ...]:
    """Return what recordings that can be repeats of each other have in common.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    tuple of float
        Speed [rad/s], interference [m], support stiffness [Nm/rad], sampling rate [Hz] and length
        [s].
    """
    c = known_condition(recording.condition)
    return (c.speed, c.interference, c.support_stiffness, recording.rate, recording.duration)


def _with_effects(
    rig: Rig,
    condition: KnownCondition,
    effects: Sequence[ActiveEffect],
    transfer_functions: Mapping[str, TransferFunction],
    rate: float,
    seconds: float,
    seed: int,
    scatter: Scatter,
) -> Recording:
    """Simulate a repeat with effects beyond the contact, as models are that a fit compares."""
    rng, fine = np.random.default_rng(seed), DIAGNOSIS.rate(rate)
    once, found = perturb_run(rig, condition, scatter, rng)
    at = (condition.interference, condition.support_stiffness)
    bushing, lumped = lumped_bushing(rig, *at), lumped_bushing(once, *at)
    shifted = {name: shift_clamp_mode(h, bushing, lumped) for name, h in transfer_functions.items()}
    impacts = any(active.effect.force or active.effect.chain for active in effects)
    paths = chain_of(rig, *at, shifted, fine, impacts=impacts)
    paths = changed_chain(paths, effects, np.random.default_rng(0))  # one structure for all runs
    plan = plan_repeat(once, found, effects, rate=fine, seconds=seconds)
    motion = repeat_motion(plan, rng)
    signals = sensor_signals(motion, radiate_motion(motion, paths, effects), plan.n_settling)
    signals = apply_sensor_effects(signals, effects, fine, rng)
    return record(
        signals, rate, condition, rng, scatter,
        decimation=DIAGNOSIS.decimation(rate), sensors=rig.sensors,
    )  # fmt: skip


def _steadied(torque: NDArray[np.float64], kept: slice, rate: float) -> NDArray[np.float64]:
    mean = torque[kept].mean()
    return np.asarray(mean + faded(torque - mean, rate))
