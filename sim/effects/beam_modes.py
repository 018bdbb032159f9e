"""Further modes of clamp, beams and anchors, from the torque to the acceleration.

The model has the modes in which clamp and beams turn. A real structure has more: sideways motion,
twisting beams, ringing anchors. Each adds r q'' to the acceleration, where

    q'' + 2 zeta omega q' + omega**2 q = T

and r is its modal constant. Its anchors push on the plate with the force m r omega**2 q, where m is
the ratio of the anchor force to the acceleration at the accelerometer; so each mode radiates too:

- single: one mode.
- pair: a second one a third higher in frequency, with the opposite sign; the thesis measured 4500
  and 6000 Hz with 12.3 cm (5.2.2).
- ladder: the bending modes of a beam clamped at both ends, omega rising as (2 n + 1)**2, up to
  20 kHz, with alternating signs and r falling as 1 / n.

Amount zero leaves them out. The torque does not change: there is no feedback to the contact. With
the clamp bolted to the baseplate there are no beams, and nothing changes. The defaults of r and m
are assumed: a third of the first torsional mode's constant, half of a beam's mass.

>>> from models.radiation.impulse_responses import ImpulseResponses
>>> none, one = np.zeros(1), np.ones(1)
>>> values = {"amount": 1.0, "frequency": 4500.0, "damping_ratio": 0.01, "constant": 2.0,
...           "anchor_mass": 0.04}
>>> plain = ImpulseResponses(96e3, none, none, one, one)
>>> rung = _chain(plain, "single", values, np.random.default_rng(0))
>>> tone = np.exp(-2j * np.pi * 4500.0 / 96e3 * np.arange(rung.torque_to_acceleration.size))
>>> round(float(abs(rung.torque_to_acceleration @ tone)), 1)  # constant / (2 zeta)
100.0
"""

from dataclasses import replace

import numpy as np
from scipy.signal import fftconvolve

from models.radiation.impulse_responses import ImpulseResponses
from sim.chain import HIGHEST_SHARE, padded_sum, resonance
from sim.effects.effect import Effect, Parameter, Stage, Values

_SECOND = 4.0 / 3.0
"""Frequency of the second mode of a pair over the first: 6000 / 4500 Hz."""

_HIGHEST = 20e3
"""Highest frequency of a ladder [Hz]."""

_LONGEST_LADDER = 12


def _chain(
    paths: ImpulseResponses, form: str, values: Values, _rng: np.random.Generator
) -> ImpulseResponses:
    if not np.any(paths.pulse_to_acceleration):
        return paths  # the clamp is bolted down
    accelerations, forces = [paths.torque_to_acceleration], []
    for frequency, sense in _modes(form, values["frequency"]):
        if frequency > HIGHEST_SHARE * paths.rate:
            continue
        constant = values["amount"] * values["constant"] * sense
        mode = frequency, values["damping_ratio"], paths.rate
        accelerations.append(constant * resonance([1.0, 0.0, 0.0], *mode))
        forces.append(values["anchor_mass"] * constant * resonance([0.0, 0.0, 1.0], *mode))
    if not forces:
        return paths
    radiated = fftconvolve(padded_sum(forces), paths.pulse_to_pressure)
    return replace(
        paths,
        torque_to_acceleration=padded_sum(accelerations),
        torque_to_pressure=padded_sum([paths.torque_to_pressure, radiated]),
    )


def _modes(form: str, first: float) -> list[tuple[float, float]]:
    """Return the frequency [Hz] and the signed weight of each mode."""
    if form == "single":
        return [(first, 1.0)]
    if form == "pair":
        return [(first, 1.0), (_SECOND * first, -1.0)]
    ladder = [(first * ((2 * n + 1) / 3) ** 2, n) for n in range(1, _LONGEST_LADDER + 1)]
    return [(f, -((-1.0) ** n) / n) for f, n in ladder if f <= max(_HIGHEST, first)]


EFFECT = Effect(
    name="beam_modes",
    stage=Stage.STRUCTURE,
    forms=("single", "pair", "ladder"),
    parameters={
        "amount": Parameter(1.0, "", 0.0, 100.0, "factor on the modal constants"),
        "frequency": Parameter(4500.0, "Hz", 50.0, 20e3, "frequency of the first further mode"),
        "damping_ratio": Parameter(0.01, "", 1e-3, 0.5, "damping ratio of each further mode"),
        "constant": Parameter(
            5.0, "m/s2 per Nm", 0.0, 1e3, "modal constant at the accelerometer for the torque"
        ),
        "anchor_mass": Parameter(
            0.04, "kg", 0.0, 10.0, "force on an anchor over acceleration at the accelerometer"
        ),
    },
    strength="amount",
    chain=_chain,
)
