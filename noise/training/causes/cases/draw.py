"""Training cases: recordings of simulated rigs with a known cause.

All else has the same distribution for all causes: the rig, its conditions, its structure, the
scatter from run to run, gains, noise and drift. `SHARED` consecutive cases have the same rig, so
that the repeats of the rig file are simulated once for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.fft import irfft, rfft

from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rig_response import impulse_responses
from models.recording import Channel, Recording
from models.rig import Rig
from models.sensors import Sensors
from noise.base.arrays import Array, Rng
from noise.diagnosis.cases.draws import drawn_effect
from noise.diagnosis.simulated.model_runs import OFFSETS, with_offsets
from noise.diagnosis.simulated.repeats import (
    CHANNELS,
    Scatter,
    perturb_run,
    plan_repeat,
    repeat_motion,
)
from noise.training.causes.cases.rigs import NOISE_DRAWN, TABLE, Setting, draw_setting, draw_start
from noise.training.causes.cases.structures import TRADES, draw_structure
from noise.training.causes.cases.unknown_effects import UNKNOWN_EFFECTS, draw_unknown_effect
from noise.training.causes.cases.variants import draw_variant
from noise.training.draws import picked
from sim.acquisition import Acquisition, decimate, digitise
from sim.bushing import lumped_bushing
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS, irregular_effects
from sim.effects.effect import ActiveEffect, activated
from sim.plan import LEARNING
from sim.run import apply_sensor_effects, radiate_motion, sensor_signals

KINDS: Mapping[str, float] = TABLE["kinds"]
"""Share of each class of cases."""


@dataclass(frozen=True)
class Truth:
    """True cause of a case.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    effects : tuple of str
        Names of the effects that the rig file lacks; for an unknown effect, of `UNKNOWN_EFFECTS`.
    forms : tuple of str
    strengths : tuple of float
        From 0.01, which is invisible, to 1, which is strong [-].
    offsets : tuple of (str, float)
        Parameters that are wrong in all recordings, and by what factor [-].
    channels : tuple of tuple of str
        Channels in which each effect acts; empty if unknown.
    """

    kind: str
    effects: tuple[str, ...] = ()
    forms: tuple[str, ...] = ()
    strengths: tuple[float, ...] = ()
    offsets: tuple[tuple[str, float], ...] = ()
    channels: tuple[tuple[str, ...], ...] = ()


def visible_through(
    truth: Truth, acting: Sequence[Collection[str]], channels: Collection[str]
) -> Truth:
    """Return the cause without effects that act in none of the recorded channels.

    Parameters
    ----------
    truth : Truth
    acting : sequence of collection of str
        Channels in which each effect acts.
    channels : collection of str
        Recorded channels.

    Examples
    --------
    >>> noisy = Truth("pair", ("room_reflections", "clipping"), ("a", "b"), (1.0, 0.5))
    >>> visible_through(noisy, [("pressure",), ("torque", "pressure")], ("torque", "angle"))
    Truth(kind='one', effects=('clipping',), forms=('b',), strengths=(0.5,), offsets=(), \
channels=(('pressure', 'torque'),))
    """
    visible = [i for i, of_effect in enumerate(acting) if set(of_effect) & set(channels)]
    kind = truth.kind
    if len(visible) < len(truth.effects):
        kind = {0: "none", 1: "one", 2: "pair"}[len(visible)]
    return replace(
        truth,
        kind=kind,
        effects=tuple(truth.effects[i] for i in visible),
        forms=tuple(truth.forms[i] for i in visible),
        strengths=tuple(truth.strengths[i] for i in visible),
        channels=tuple(tuple(sorted(acting[i])) for i in visible),
    )


SHARED = 4
"""Cases per rig."""

WEAKEST = 0.02
"""Least strength of a drawn effect [-]."""

_SLOW = 3.0
"""Largest coloured noise and drift over the white noise of a good sensor [-]."""


@dataclass(frozen=True, eq=False)
class DrawnCase:
    """Drawn case.

    Parameters
    ----------
    rig : Rig
        Content of the rig file, with measured responses.
    recordings : tuple of Recording
        With the stated conditions.
    truth : Truth
    departures : tuple of str
        Departures of the bench from a quiet one.
    """

    rig: Rig
    recordings: tuple[Recording, ...]
    truth: Truth
    departures: tuple[str, ...] = ()


def draw_case(seed: int) -> DrawnCase:
    """Draw a case; the same seed gives the same case.

    Raises
    ------
    ParameterError
        If it cannot be simulated.

    Examples
    --------
    >>> case = draw_case(5)
    >>> 2 <= len(case.recordings) <= 9, case.recordings[0].channel_names
    (True, ('torque', 'acceleration', 'pressure', 'angle'))
    """
    drawn = _drawn_rig(seed // SHARED)
    setting = drawn.setting
    rng = np.random.default_rng([1, seed])
    truth, effects = _draw_cause(setting.rig, rng)
    chain_seed = int(rng.integers(2**31))
    acting: list[set[str]] = [set() for _ in effects]
    recordings = tuple(
        _record(drawn, place, effects, truth, chain_seed, acting, rng)
        for place in range(len(setting.conditions))
    )
    return DrawnCase(
        setting.rig, recordings, visible_through(truth, acting, recordings[0].channel_names),
        setting.bench.departures,
    )  # fmt: skip


class _DrawnRig(NamedTuple):
    """Rig with measured responses, and its true responses, speeds and temperature."""

    setting: Setting
    plain: Mapping[float, ImpulseResponses]
    speeds: tuple[float, ...]
    warmer: Rig


@lru_cache(maxsize=1)
def _drawn_rig(number: int) -> _DrawnRig:
    rng = np.random.default_rng([0, number])
    setting = draw_setting(rng)
    rig, bench = setting.rig, setting.bench
    shares = {name: row["share"] for name, row in TRADES.items()}
    trade = picked(shares, rng) if bench.departures else "thesis"
    supports = sorted({c.support_stiffness for c in setting.conditions})
    middle = rig.fits[len(rig.fits) // 2].interference
    structures = {
        support: draw_structure(lumped_bushing(rig, middle, support), rng, trade)
        for support in supports
    }
    poor = bench.responses == "poor"
    measured = tuple(s.measured(support, rng, poor=poor) for support, s in structures.items())
    known = replace(rig, measured=measured)
    fine = LEARNING.rate(bench.rate)
    plain = {support: s.response(fine) for support, s in structures.items()}
    listed = activated(rig.effects, EFFECTS)
    if any(one.effect.force or one.effect.chain for one in listed):
        # Listed effects, and the responses to impacts in the anchors, are as in the rig file.
        for support, response in plain.items():
            modelled = impulse_responses(rig, middle, support, response.rate)
            struck = replace(
                response,
                pulse_to_acceleration=modelled.pulse_to_acceleration,
                pulse_to_pressure=modelled.pulse_to_pressure,
            )
            plain[support] = apply_chain_effects(struck, listed, np.random.default_rng(0))
    wrong = {c: 1.0 + bench.wrong_speed * float(rng.uniform(-1.0, 1.0)) for c in setting.conditions}
    if rng.random() < 0.5:  # a wrong tachometer rather than wrong readings
        wrong = dict.fromkeys(wrong, next(iter(wrong.values())))
    speeds = tuple(wrong[c] * c.speed for c in setting.conditions)
    return _DrawnRig(replace(setting, rig=known), plain, speeds, _warmer(known, bench.warmer))


def _warmer(rig: Rig, warmer: float) -> Rig:
    """Return a rig that is warmer than stated [K]; unchanged if the file has a temperature law."""
    if rig.temperature is not None:
        return rig
    torque, stiffness = 1.0 - 0.005 * warmer, 1.0 - 0.003 * warmer
    return with_offsets(
        rig,
        {"elastomer_stiffness": stiffness, "critical_torque": torque, "kinetic_torque": torque},
    )


def _draw_cause(rig: Rig, rng: Rng) -> tuple[Truth, list[ActiveEffect]]:
    kind = str(rng.choice(list(KINDS), p=list(KINDS.values())))
    if kind == "parameters":
        return Truth(kind, offsets=draw_offsets(rng)), []
    if kind == "unknown":
        name, strength = str(rng.choice(list(UNKNOWN_EFFECTS))), _strength(rng)
        fit = rig.fit(0.279e-3)
        unknown = draw_unknown_effect(
            name, strength, fit.kinetic_torque, fit.elastomer_stiffness, rng
        )
        return Truth(kind, (name,), ("plain",), (strength,)), [unknown.active({})]
    # A listed effect is no cause, except for an irregularity, which may be larger than listed.
    more = [spec.name for spec in irregular_effects(rig)]
    listed = {spec.name for spec in rig.effects} - set(more)
    offered = sorted(set(EFFECTS) - listed - _without_effect(rig))
    count = {"one": 1, "pair": 2, "triple": 3}.get(kind, 0)
    names = rng.choice(offered, count, replace=False).tolist()
    if names and more and not set(more) & set(names) and rng.random() < 0.25:
        names[0] = str(rng.choice(more))
    strengths = tuple(_strength(rng) for _ in names)
    effects = [active_effect(name, a, rng) for name, a in zip(names, strengths, strict=True)]
    return Truth(kind, tuple(names), tuple(e.form for e in effects), strengths), effects


def _without_effect(rig: Rig) -> set[str]:
    """Return the effects that change nothing with the friction law of a rig."""
    nothing = set()
    if rig.friction.name != "coulomb":
        nothing.add("partial_slip")  # other laws creep anyway
    if all(fit.critical_torque <= fit.kinetic_torque for fit in rig.fits):
        nothing |= {"critical_torque_scatter", "static_ageing"}  # no drop of torque
    return nothing


def draw_offsets(rng: Rng) -> tuple[tuple[str, float], ...]:
    """Draw one or two wrong parameters, and the factor of each [-]."""
    sign = float(rng.choice([-1.0, 1.0]))
    names = rng.choice(OFFSETS, int(rng.integers(1, 3)), replace=False).tolist()
    return tuple((name, 1.0 + sign * float(rng.uniform(0.08, 0.2))) for name in names)


def active_effect(name: str, strength: float, rng: Rng) -> ActiveEffect:
    """Draw an effect of `sim.effects` in any form, of a strength from 0 to 1 [-]."""
    spec = drawn_effect(name, strength, rng)
    if rng.random() < 0.65:
        return draw_variant(name, strength, rng).active({})
    return EFFECTS[name].active(spec.parameters)


def _record(
    drawn: _DrawnRig,
    place: int,
    effects: Sequence[ActiveEffect],
    truth: Truth,
    chain_seed: int,
    acting: Sequence[set[str]],
    rng: Rng,
) -> Recording:
    """Simulate and record a condition; add the channels in which each effect acts to `acting`."""
    chance = np.random.default_rng(int(rng.integers(2**31)))
    setting, bench = drawn.setting, drawn.setting.bench
    stated = setting.conditions[place]
    true = replace(stated, speed=drawn.speeds[place], temperature=23.0 + bench.warmer)
    fine = LEARNING.rate(bench.rate)
    listed = activated(setting.rig.effects, EFFECTS)
    rig = with_offsets(drawn.warmer, dict(truth.offsets))
    once, at = perturb_run(rig, true, Scatter(), chance, support=True)
    plan = plan_repeat(once, at, (*listed, *effects), rate=fine, seconds=bench.seconds)
    if bench.start:
        shaft, before = draw_start(bench.start, at.speed, bench.seconds, LEARNING.settling, chance)
        plan = replace(plan, shaft=shaft, n_settling=round(before * fine))
    motion = repeat_motion(plan, chance)
    paths, stream = drawn.plain[stated.support_stiffness], np.random.default_rng(chain_seed)
    for channels, effect in zip(acting, effects, strict=True):
        changed = apply_chain_effects(paths, [effect], stream)
        channels |= _channels_of(effect, paths, changed)
        paths = changed
    sound = radiate_motion(motion, paths, plan.effects)
    signals = sensor_signals(motion, sound, plan.n_settling)
    signals = apply_sensor_effects(signals, listed, fine, chance)
    for channels, effect in zip(acting, effects, strict=True):
        read = apply_sensor_effects(signals, [effect], fine, chance)
        channels |= {k for k, x in read.items() if not np.array_equal(x, signals[k])}
        signals = read
    kinds = ("torque", "angle") if bench.responses == "none" else CHANNELS
    decimation = LEARNING.decimation(bench.rate)
    samples = [_sampled(signals[k], decimation, k, setting.sensors, chance) for k in kinds]
    return Recording(np.stack(samples), bench.rate, tuple(map(Channel, kinds)), stated)


def _channels_of(
    effect: ActiveEffect, before: ImpulseResponses, after: ImpulseResponses
) -> set[str]:
    """Return the channels in which an effect on motion, force or chain acts."""
    acts = effect.effect
    if acts.contact is not None or acts.drive is not None:
        return set(CHANNELS)
    if acts.force is not None:
        return {"acceleration", "pressure"}
    return {
        channel
        for channel in ("acceleration", "pressure")
        for path in (f"torque_to_{channel}", f"pulse_to_{channel}")
        if not np.array_equal(getattr(before, path), getattr(after, path))
    }


def _sampled(signal: Array, decimation: int, kind: str, sensors: Sensors, rng: Rng) -> Array:
    """Decimate, add white noise, coloured noise and drift, and digitise."""
    x = decimate(signal, decimation)
    sensor = sensors.of(kind)
    colour, ramp = _unsteady(x.size)
    slow = irfft(rfft(rng.standard_normal(x.size)) / colour, x.size, overwrite_x=True)
    drift = rng.standard_normal()
    slow *= rng.uniform(0.0, _SLOW)
    slow += (drift * rng.uniform(0.0, _SLOW)) * ramp
    white = (sensor.noise or 0.0) * float(np.exp(0.1 * rng.standard_normal()))
    # Amplifiers with more white noise do not drift more.
    slow *= min(white, NOISE_DRAWN[1] * Acquisition().noise[kind])
    gain = 0.0 if kind == "angle" else Scatter().gain
    slow += (1.0 + gain * rng.standard_normal()) * x
    slow += white * rng.standard_normal(x.size)
    through = Sensors({kind: replace(sensor, noise=0.0)})
    return digitise(slow, kind, Acquisition(sensors=through), rng)


@lru_cache(maxsize=4)
def _unsteady(n: int) -> tuple[Array, Array]:
    """Return the divisor of the spectrum of coloured noise, and a linear drift [-]."""
    return np.sqrt(1.0 + np.fft.rfftfreq(n) / 1e-3), np.linspace(-1.0, 1.0, n)


def _strength(rng: Rng) -> float:
    return math.exp(rng.uniform(math.log(WEAKEST), 0.0))
