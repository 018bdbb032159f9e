"""Repeats of a run: a rig that is never quite the same twice, its motion and its recording.

A simulation that is to be compared with one recording is run as several replicates, each of a rig
drawn about the nominal one. A bushing is pressed in again, warms by a few kelvin, wears: between
two runs of one condition its stiffness, torques and damping come out a few per cent apart.

Nominal repeats are of the rig as its file has it. Their transfer functions are those of the
structure, applied to the simulated torque, so a repeat costs a few milliseconds. A rig file that
lists effects beyond friction and drive is run through impulse responses instead, as the models are
that a fit compares.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from models.condition import Condition, KnownCondition, known_condition
from models.recording import Channel, Recording
from models.rig import Fit, Rig
from models.sensors import Sensors
from models.transfer_functions.transfer_function import TransferFunction
from noise.base.arrays import Array
from noise.diagnosis.simulated.transfer_functions import (
    OUTPUTS,
    TransferFunctionCache,
    chain_of,
    shift_clamp_mode,
    torque_outputs,
)
from sim.acquisition import Acquisition, decimate_sensed, digitise
from sim.bushing import lumped_bushing
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect, activated
from sim.motion import Motion
from sim.plan import DIAGNOSIS, Plan
from sim.run import apply_sensor_effects, radiate_motion, run_motion, sensor_signals
from sim.shaft import ConstantSpeed
from sim.temperature import at_temperature

_RUNNING_OUT = 0.12
"""Simulated after a recording ends [s]."""


def nominal_repeats(
    template: Recording,
    rig: Rig,
    transfer_functions: TransferFunctionCache,
    seeds: Sequence[int],
    scatter: Scatter | None = None,
    library: Mapping[str, Effect] | None = None,
) -> list[Recording]:
    """Simulate repeats of a run of the rig as its file has it.

    Parameters
    ----------
    template : Recording
        At whose condition, rate and length.
    rig : Rig
    transfer_functions : TransferFunctionCache
        Of the rig.
    seeds : sequence of int
        One a repeat.
    scatter : Scatter, optional
    library : mapping of str to Effect, optional
        Definitions of the effects of the rig, by name.

    Returns
    -------
    list of Recording

    Raises
    ------
    ParameterError
        The rig cannot be simulated.
    """
    condition, rate = known_condition(template.condition), template.rate
    functions, scatter = transfer_functions.of(template), scatter or Scatter()
    effects = activated(rig.effects, library or EFFECTS)
    sensors = rig.sensors
    filters = {sensors.of(name).antialias for name in ("torque", *OUTPUTS)}
    if len(filters) > 1 or any(
        e.effect.force or e.effect.chain or e.effect.sensors for e in effects
    ):
        return [_with_effects(rig, template, effects, functions, seed, scatter) for seed in seeds]
    decimation = DIAGNOSIS.decimation(rate)
    before = round(DIAGNOSIS.settling * rate)
    recorded = slice(before, before + template.samples.shape[1])
    n = (recorded.stop + round(_RUNNING_OUT * rate)) * decimation
    at = (condition.interference, condition.support_stiffness)
    bushing = lumped_bushing(rig, *at)
    recordings = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        once, own = perturb_run(rig, condition, scatter, rng)
        plan = plan_repeat(once, own, effects, rate=DIAGNOSIS.rate(rate), seconds=template.duration)
        motion = repeat_motion(replace(plan, n_settling=0, n_recorded=n), rng)
        # What a sensor's filter does to a sound, it does to the torque that makes it.
        torque, angle = (
            decimate_sensed(x, decimation, plan.rate, sensors.of(name))
            for name, x in (("torque", motion.torque), ("angle", motion.shaft_angle))
        )
        outputs = torque_outputs(
            torque, torque[recorded].mean(), rate, functions, bushing, lumped_bushing(once, *at)
        )
        signals = {
            "torque": torque[recorded],
            **{name: outputs[name][recorded] for name in OUTPUTS},
            "angle": angle[recorded] - angle[before],
        }
        through = sensors.unfiltered()
        recordings.append(record(signals, rate, condition, rng, scatter, sensors=through))
    return recordings


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
    template: Recording,
    effects: Sequence[ActiveEffect],
    transfer_functions: Mapping[str, TransferFunction],
    seed: int,
    scatter: Scatter,
) -> Recording:
    """Simulate a repeat with effects beyond the contact, as models are that a fit compares."""
    condition, rate = known_condition(template.condition), template.rate
    rng, fine = np.random.default_rng(seed), DIAGNOSIS.rate(rate)
    once, own = perturb_run(rig, condition, scatter, rng)
    at = (condition.interference, condition.support_stiffness)
    bushing, lumped = lumped_bushing(rig, *at), lumped_bushing(once, *at)
    shifted = {name: shift_clamp_mode(h, bushing, lumped) for name, h in transfer_functions.items()}
    impacts = any(active.effect.force or active.effect.chain for active in effects)
    paths = chain_of(rig, *at, shifted, fine, impacts=impacts)
    one_structure = np.random.default_rng(0)  # for all runs
    paths = apply_chain_effects(paths, effects, one_structure)
    plan = plan_repeat(once, own, effects, rate=fine, seconds=template.duration)
    motion = repeat_motion(plan, rng)
    signals = sensor_signals(motion, radiate_motion(motion, paths, effects), plan.n_settling)
    signals = apply_sensor_effects(signals, effects, fine, rng)
    return record(
        signals, rate, condition, rng, scatter,
        decimation=DIAGNOSIS.decimation(rate), sensors=rig.sensors,
    )  # fmt: skip


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
    >>> plan.rate, plan.n_settling, plan.n_recorded
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
        n_recorded=round(seconds * rate),
    )


_DYING = 0.7
"""Ratio of the oscillation in the last quarter of a run to that in the first quarter below which a
sliding rig still rings from its start [-]; assumed."""

_SILENT = 1e-6
"""Oscillation over the mean torque that no sensor shows [-]; assumed."""

_LONGER = 1.5
"""Further settling of such a rig [s]; assumed."""


def repeat_motion(plan: Plan, rng: np.random.Generator, tolerance: float | None = None) -> Motion:
    """Simulate the motion of a run as exactly as a comparison needs.

    A lightly damped rig that slides rings long after its start. Recordings are of shafts that have
    turned for longer, so such a run is simulated again with more time to settle.

    Parameters
    ----------
    plan : Plan
    rng : numpy.random.Generator
        As of `run_motion`.
    tolerance : float, optional
        As of `run_motion`, by default that of `sim.plan.DIAGNOSIS` [-].
    """
    tolerance = tolerance or DIAGNOSIS.tolerance
    again = deepcopy(rng)
    motion = run_motion(plan, rng, tolerance=tolerance)
    if not _rings(motion):
        return motion
    longer = round(_LONGER * plan.rate)
    motion = run_motion(
        replace(plan, n_settling=plan.n_settling + longer), again, tolerance=tolerance
    )
    return motion.part(longer)


def _rings(motion: Motion) -> bool:
    """Return whether a rig slides, with an oscillation that dies out after settling."""
    first = round(DIAGNOSIS.settling * motion.rate)
    quarter = (motion.torque.size - first) // 4
    if quarter < 2 or motion.stuck[first:].any():
        return False
    early = float(motion.torque[first : first + quarter].std())
    late = float(motion.torque[-quarter:].std())
    return early > _SILENT * abs(float(motion.torque.mean())) and late < _DYING * early


def record(
    signals: Mapping[str, Array],
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
        stiffness *= float(np.exp(scatter.structure * rng.normal()))
    stiffening, kinetic, drop, damping, inertia = np.exp(scatter.bushing * rng.standard_normal(5))
    # the support's stiffness scatters too; what counts is the clamp's frequency, hence the root
    clamp = float(np.exp(math.sqrt(2.0) * scatter.structure * rng.standard_normal()))

    def drawn(fit: Fit) -> Fit:
        sliding = fit.kinetic_torque * float(kinetic)
        excess = (fit.critical_torque - fit.kinetic_torque) * float(drop)
        return replace(
            fit,
            elastomer_stiffness=fit.elastomer_stiffness * float(stiffening),
            kinetic_torque=sliding,
            critical_torque=sliding + excess,
            damping={support: c * float(damping) for support, c in fit.damping.items()},
        )

    once = replace(
        rig,
        fits=tuple(drawn(fit) for fit in rig.fits),
        elastomer_inertia=rig.elastomer_inertia * float(inertia),
        clamp_inertia=rig.clamp_inertia * clamp,
    )
    speed = condition.speed * float(np.exp(scatter.structure * rng.normal()))
    return once, replace(condition, speed=speed, support_stiffness=stiffness)
