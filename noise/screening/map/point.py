"""One point of a map: simulated, and named by its physics.

What noise a condition makes is said by `noise.noise_definition`, the definition that the classifier
learns: it looks at motion and sound without room and microphone, and costs no more than the run. So
a screen judges designs by the same names as recordings are labelled with, and does not inherit the
classifier's errors. The rig runs from rest, and is judged once it has settled: after 0.6 s if the
vibration then neither grows nor dies, else after 1.5 s; some creaks set in that late. The solver's
steps are as long as regimes and spectra allow, rather than single events.

A bar on the road swings: it runs from one turning on, a whole cycle is heard, and names and regimes
are those of the two stretches in which it moves at half its peak speed or more, whichever is
livelier. Every turning sticks, which by itself is neither regime nor noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.levels import a_weighted, fast_levels
from models.radiation.impulse_responses import radiate
from models.radiation.rig_response import response
from models.rig import damping_at
from noise.noise_definition import Evidence, evidence_of
from noise.screening.map.stretches import stretches_of
from sim.analysis.regime import LEAST_OSCILLATION, Regime
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import at_temperature
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed, Oscillation

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from models.rig import Rig
    from sim.effects.effect import Effect
    from sim.motion import Motion
    from sim.shaft import ShaftMotion

__all__ = ["REGIMES", "Judged", "Sound", "judge", "point_sound"]

REGIMES = (Regime.STEADY_SLIDING, Regime.QUASI_HARMONIC, Regime.STICK_SLIP)
"""In the order of their codes."""

_RATE = 30e3
"""Of motion and sound [Hz]: creaks reach 15 kHz."""

_TOLERANCE = 1e-5

_SHORT = 0.6, 1.2
_LONG = 1.5, 2.1
"""When a run begins to be judged, and when it ends [s]."""

_SETTLED = 0.8
"""Least ratio of the vibration's strength, from one third of what is judged to the last."""

_DAMPING_STEP = 0.04
"""Relative, of the beams' damping between the structures that are made: 0.2 dB at a resonance."""


@dataclass(frozen=True)
class Judged:
    """What a simulated point came to.

    Parameters
    ----------
    regime : Regime
    label : str
        ``creak``, ``squawk``, ``squeal`` or ``none``.
    level : float
        L_AFmax of the sound [dB re 20 uPa]; NaN where it slides steadily.
    evidence : Evidence, optional
        What the label follows from; None where it slides steadily.
    """

    regime: Regime
    label: str
    level: float
    evidence: Evidence | None = None


@dataclass(frozen=True, eq=False)
class Sound:
    """Motion and sound of a point, the part that is judged.

    Parameters
    ----------
    motion : Motion
    pressure, pulse_pressure : ndarray, shape (n,)
        At the motion's rate [Pa].
    before : ndarray, shape (m,)
        Pressure from the start to the part that is judged, which a meter has heard as well [Pa].
    """

    motion: Motion
    pressure: NDArray[np.float64]
    pulse_pressure: NDArray[np.float64]
    before: NDArray[np.float64]


def judge(
    rig: Rig,
    shaft: float | Oscillation,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float = 23.0,
    library: Mapping[str, Effect] = EFFECTS,
    structure: tuple[Rig, float] | None = None,
) -> Judged:
    """Simulate a point, and say its regime, its noise and its level.

    Parameters
    ----------
    rig : Rig
    shaft : float or Oscillation
        Constant speed [rad/s], or how the shaft swings.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    temperature : float
        [degree Celsius]
    library : mapping of str to Effect
        Effects that the rig's can be found among.
    structure : tuple of Rig and float, optional
        Rig and support stiffness [Nm/rad] through whose clamp, beams and plate it is heard, where
        making those of each point would take too long; by default its own.

    Returns
    -------
    Judged

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> judge(rig, 10.0, interference=0.279e-3, support_stiffness=3745.0).label
    'squeal'
    """
    rig = replace(rig, friction=at_temperature(rig.friction, temperature))
    motion, start = _settled(rig, shaft, interference, support_stiffness, _RATE, library)
    stretches = stretches_of(motion.since(start), swings=isinstance(shaft, Oscillation))
    if all(_swing(stretch) <= 1.0 for stretch in stretches):
        return Judged(Regime.STEADY_SLIDING, "none", math.nan)
    heard_by, support = structure or (rig, support_stiffness)
    paths = _paths(heard_by, interference, support, motion.rate)
    sound = _sound(rig, motion, start, paths, library)
    found = _evidence(sound, stretches)
    regime = Regime.STICK_SLIP if found.stick > 1.0 else Regime.QUASI_HARMONIC
    label = found.name
    if isinstance(shaft, Oscillation) and label == "creak" and found.blows < 0.0:
        label = "squawk"  # lines that follow the speed, which no single spectrum shows
    return Judged(regime, label, _loudest(sound), found)


def point_sound(
    rig: Rig,
    shaft: float | Oscillation,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float = 23.0,
    rate: float = 48e3,
    library: Mapping[str, Effect] = EFFECTS,
) -> Sound:
    """Return motion and sound of a point as `judge` looks at them, at another rate [Hz]."""
    rig = replace(rig, friction=at_temperature(rig.friction, temperature))
    span = _LONG if not isinstance(shaft, Oscillation) else _swing_span(shaft)
    motion = _motion(rig, shaft, interference, support_stiffness, rate, library, span[1])
    paths = _paths(rig, interference, support_stiffness, rate)
    return _sound(rig, motion, round(span[0] * rate), paths, library)


def _settled(
    rig: Rig,
    shaft: float | Oscillation,
    interference: float,
    support_stiffness: float,
    rate: float,
    library: Mapping[str, Effect],
) -> tuple[Motion, int]:
    """Motion of a run, and the sample from which on it is judged."""
    span = _swing_span(shaft) if isinstance(shaft, Oscillation) else _SHORT
    motion = _motion(rig, shaft, interference, support_stiffness, rate, library, span[1])
    settled = isinstance(shaft, Oscillation) or _is_settled(motion.since(round(span[0] * rate)))
    if not settled:
        span = _LONG
        motion = _motion(rig, shaft, interference, support_stiffness, rate, library, span[1])
    return motion, round(span[0] * rate)


def _swing_span(shaft: Oscillation) -> tuple[float, float]:
    return 0.25 / shaft.frequency, 1.25 / shaft.frequency


def _is_settled(motion: Motion) -> bool:
    """Whether a vibration neither grows nor dies, or there is none."""
    first, _, last = (float(np.std(part)) for part in np.array_split(motion.torque, 3))
    least = LEAST_OSCILLATION * abs(float(np.mean(motion.torque)))
    if max(first, last) <= 0.1 * least:
        return True
    return _SETTLED * first <= last <= first / _SETTLED


def _motion(
    rig: Rig,
    shaft: float | Oscillation,
    interference: float,
    support_stiffness: float,
    rate: float,
    library: Mapping[str, Effect],
    seconds: float,
) -> Motion:
    turning: ShaftMotion = shaft if isinstance(shaft, Oscillation) else ConstantSpeed(float(shaft))
    return simulate_motion(
        rig,
        turning,
        interference=interference,
        support_stiffness=support_stiffness,
        seconds=seconds,
        rate=rate,
        effects=activated(rig.effects, library),
        tolerance=_TOLERANCE,
    )


def _swing(motion: Motion) -> float:
    mean = abs(float(np.mean(motion.torque)))
    return float(np.std(motion.torque)) / (LEAST_OSCILLATION * mean) if mean > 0.0 else math.inf


def _sound(
    rig: Rig,
    motion: Motion,
    start: int,
    paths: ImpulseResponses,
    library: Mapping[str, Effect],
) -> Sound:
    force = np.zeros_like(motion.torque)
    for active in activated(rig.effects, library):
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    _, pressure = radiate(paths, motion.torque)
    pulses = np.zeros_like(pressure)
    if np.any(force):
        _, pulses = radiate(paths, np.zeros_like(force), force)
    pressure += pulses
    return Sound(motion.since(start), pressure[start:], pulses[start:], pressure[:start])


def _loudest(sound: Sound) -> float:
    """L_AFmax [dB re 20 uPa]."""
    rate = sound.motion.rate
    heard = fast_levels(a_weighted(np.concatenate([sound.before, sound.pressure]), rate), rate)
    return float(heard[sound.before.size :].max())


def _paths(
    rig: Rig, interference: float, support_stiffness: float, rate: float
) -> ImpulseResponses:
    """Responses of the structure, the beams' damping rounded so that few are made."""
    damping = damping_at(rig.fit(interference), support_stiffness)
    of_beams = (1.0 - rig.elastomer_damping_share) * damping
    if of_beams > 0.0 and math.isfinite(support_stiffness):
        rounded = math.exp(round(math.log(of_beams) / _DAMPING_STEP) * _DAMPING_STEP)
        rig = replace(rig, elastomer_damping_share=1.0 - rounded / damping)
    return response(rig, interference, support_stiffness, rate)


def _evidence(sound: Sound, stretches: list[Motion]) -> Evidence:
    """Evidence of the liveliest stretch, with the sound of all."""
    found = [evidence_of(stretch, sound.pressure, sound.pulse_pressure) for stretch in stretches]
    return max(found, key=lambda evidence: evidence.audible)
