"""Cases: recordings of simulated rigs with a known cause, made as a user would record them.

Whatever is not the case's cause is drawn alike for all causes: the rig, its conditions, its
structure, the scatter from run to run, gains, noise and drift. `SHARED` cases in a row are of one
rig: what the rig file predicts of it is then simulated once for all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, rfft

from models.recording import Channel, Recording
from noise.diagnosis.cases.rigs import OFFSETS, draw_setting, with_offsets
from noise.diagnosis.cases.strengths import drawn_effect
from noise.diagnosis.cases.structures import draw_structure
from noise.diagnosis.cases.truth import KINDS, Truth
from noise.diagnosis.cases.unknown_effects import UNKNOWN_EFFECTS, draw_unknown_effect
from noise.diagnosis.cases.variants import draw_variant
from noise.diagnosis.simulated.repeats import CHANNELS, Scatter, run_signals
from sim.acquisition import Acquisition, decimate
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.timing import DIAGNOSIS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from models.condition import KnownCondition
    from models.radiation.impulse_responses import ImpulseResponses
    from models.rig import Fit, Rig
    from noise.diagnosis.cases.rigs import Setting
    from sim.effects.effect import ActiveEffect

__all__ = [
    "NOISE_DRAWN", "SHARED", "DrawnCase", "active_effect", "draw_case", "draw_offsets",
    "unknown_effect",
]  # fmt: skip

SHARED = 4
"""Cases of one rig."""

WEAKEST = 0.02
"""Least strength of an effect that is drawn."""

NOISE_DRAWN = (0.7, 1.6)
"""Between which the noise of a case's sensors lies, times that of `sim.acquisition`."""

_VARIANTS = 0.65
"""Share of the effects that have none of the simulator's own forms."""


@dataclass(frozen=True, eq=False)
class DrawnCase:
    """A case.

    Parameters
    ----------
    rig : Rig
        As its file has it, responses measured.
    recordings : tuple of Recording
    truth : Truth
    """

    rig: Rig
    recordings: tuple[Recording, ...]
    truth: Truth


def draw_case(seed: int) -> DrawnCase:
    """Draw a case; the same seed gives the same case.

    Examples
    --------
    >>> case = draw_case(5)
    >>> 4 <= len(case.recordings) <= 9, case.recordings[0].channel_names
    (True, ('torque', 'acceleration', 'pressure', 'angle'))
    """
    setting, plain = _drawn_rig(seed // SHARED)
    rng = np.random.default_rng([1, seed])
    truth, effects = _draw_cause(setting.rig, rng)
    chain_seed = int(rng.integers(2**31))
    louder = {
        name: level * rng.uniform(*NOISE_DRAWN) for name, level in Acquisition().noise.items()
    }
    recordings = tuple(
        _record(
            setting, condition, effects, dict(truth.offsets), plain[condition.support_stiffness],
            chain_seed, louder, rng,
        )
        for condition in setting.conditions
    )  # fmt: skip
    return DrawnCase(setting.rig, recordings, truth)


@lru_cache(maxsize=1)
def _drawn_rig(number: int) -> tuple[Setting, dict[float, ImpulseResponses]]:
    """Draw a rig with measured responses, and the true ones at the rate of the simulation."""
    rng = np.random.default_rng([0, number])
    setting = draw_setting(rng)
    structures = {
        support: draw_structure(lumped_bushing(setting.rig, 0.279e-3, support), rng)
        for support in sorted({c.support_stiffness for c in setting.conditions})
    }
    measured = tuple(s.measured(support, rng) for support, s in structures.items())
    fine = DIAGNOSIS.rate(setting.rate)
    return (
        replace(setting, rig=replace(setting.rig, measured=measured)),
        {support: s.response(fine) for support, s in structures.items()},
    )


def _draw_cause(rig: Rig, rng: np.random.Generator) -> tuple[Truth, list[ActiveEffect]]:
    kind = str(rng.choice(list(KINDS), p=list(KINDS.values())))
    if kind == "parameters":
        return Truth(kind, offsets=draw_offsets(rng)), []
    if kind == "unknown":
        name, strength = str(rng.choice(list(UNKNOWN_EFFECTS))), _strength(rng)
        unknown = unknown_effect(name, strength, rig.fit(0.279e-3), rng)
        return Truth(kind, (name,), ("plain",), (strength,)), [unknown]
    count = {"one": 1, "pair": 2, "triple": 3}.get(kind, 0)
    names = rng.choice(sorted(EFFECTS), count, replace=False).tolist()
    strengths = tuple(_strength(rng) for _ in names)
    effects = [active_effect(name, a, rng) for name, a in zip(names, strengths, strict=True)]
    return Truth(kind, tuple(names), tuple(e.form for e in effects), strengths), effects


def draw_offsets(rng: np.random.Generator) -> tuple[tuple[str, float], ...]:
    """Draw one or two parameters that are off, and by what factor [-]."""
    sign = float(rng.choice([-1.0, 1.0]))
    names = rng.choice(OFFSETS, int(rng.integers(1, 3)), replace=False).tolist()
    return tuple((name, 1.0 + sign * float(rng.uniform(0.08, 0.2))) for name in names)


def unknown_effect(name: str, strength: float, fit: Fit, rng: np.random.Generator) -> ActiveEffect:
    """Draw an effect of `UNKNOWN_EFFECTS`, of a strength from 0 to 1 [-], on a rig's fit."""
    drawn = draw_unknown_effect(name, strength, fit.kinetic_torque, fit.elastomer_stiffness, rng)
    return drawn.active({})


def active_effect(name: str, strength: float, rng: np.random.Generator) -> ActiveEffect:
    """Draw an effect of the contract, of a strength from 0 to 1 [-], in any form."""
    spec = drawn_effect(name, strength, rng)
    if rng.random() < _VARIANTS:
        return draw_variant(name, strength, rng).active({})
    return EFFECTS[name].active(spec.parameters)


def _record(
    setting: Setting,
    condition: KnownCondition,
    effects: list[ActiveEffect],
    offsets: Mapping[str, float],
    plain: ImpulseResponses,
    chain_seed: int,
    noise: Mapping[str, float],
    rng: np.random.Generator,
) -> Recording:
    scatter, chance = Scatter(), np.random.default_rng(int(rng.integers(2**31)))
    signals = run_signals(
        with_offsets(setting.rig, offsets), condition, effects, plain, setting.seconds, chance,
        chain_seed=chain_seed,
    )  # fmt: skip
    decimation = DIAGNOSIS.decimation(setting.rate)
    samples = [
        _sampled(
            signals[name], decimation, noise[name], 0.0 if name == "angle" else scatter.gain, chance
        )
        for name in CHANNELS
    ]
    return Recording(
        np.stack(samples), setting.rate, tuple(Channel(name) for name in CHANNELS), condition
    )


def _sampled(
    signal: NDArray[np.float64],
    decimation: int,
    noise: float,
    gain: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Decimate, and add white noise, a coloured one and a drift."""
    x = decimate(signal, decimation)
    colour, ramp = _unsteady(x.size)
    slow = irfft(rfft(rng.standard_normal(x.size)) / colour, x.size, overwrite_x=True)
    drift = rng.standard_normal()
    slow *= rng.uniform(0.0, 3.0)
    slow += (drift * rng.uniform(0.0, 3.0)) * ramp
    loud = noise * float(np.exp(0.1 * rng.standard_normal()))
    sensitivity = 1.0 + gain * rng.standard_normal()
    slow += rng.standard_normal(x.size)
    slow *= loud
    slow += sensitivity * x
    return np.asarray(slow)


@lru_cache(maxsize=4)
def _unsteady(n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """By what white noise of `n` samples is divided to be coloured, and a drift [-]."""
    return np.sqrt(1.0 + np.fft.rfftfreq(n) / 1e-3), np.linspace(-1.0, 1.0, n)


def _strength(rng: np.random.Generator) -> float:
    return math.exp(rng.uniform(math.log(WEAKEST), 0.0))
