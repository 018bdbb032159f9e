"""Further resonances of the radiation: more modes of the plate, a guard, a panel.

Torque and acceleration do not change; the pressure p becomes p + a sum(s_r B_r p) with the
resonances

    B(s) = 2 zeta omega s / (s**2 + 2 zeta omega s + omega**2),

each with a peak of 1, so that amount a = 1 doubles the sound at an isolated resonance (6 dB):

- single: one resonance, as of a panel.
- even: equally spaced from the first one up to 16 kHz, with alternating signs; the mean modal
  density of a plate is constant over frequency (Cremer and Heckl, *Structure-Borne Sound*, 4.3).
- scattered: the same mean spacing, with exponentially distributed gaps and normally distributed
  strengths: a plate of which only the size is known.

Amount zero leaves them out.

>>> from models.radiation.impulse_responses import ImpulseResponses
>>> one = np.ones(1)
>>> values = {"amount": 1.0, "frequency": 1000.0, "damping_ratio": 0.015, "spacing": 400.0}
>>> plain = ImpulseResponses(96e3, one, one, one, one)
>>> rung = _chain(plain, "single", values, np.random.default_rng(0))
>>> tone = np.exp(-2j * np.pi * 1000.0 / 96e3 * np.arange(rung.torque_to_pressure.size))
>>> round(float(abs(rung.torque_to_pressure @ tone)), 3)
2.0
"""

import numpy as np
from numpy.typing import NDArray

from models.radiation.impulse_responses import ImpulseResponses
from sim.chain import HIGHEST_SHARE, filter_pressure, padded_sum, resonance
from sim.effects.effect import Effect, Parameter, Stage, Values

_HIGHEST = 16e3
"""Highest frequency [Hz], as for the plate's own modes."""


def _chain(
    paths: ImpulseResponses, form: str, values: Values, rng: np.random.Generator
) -> ImpulseResponses:
    frequencies, senses = _resonances(form, values, rng)
    taps = [np.ones(1)]
    for frequency, sense in zip(frequencies.tolist(), senses.tolist(), strict=True):
        if frequency > HIGHEST_SHARE * paths.rate:
            continue
        damping = values["damping_ratio"]
        ringing = resonance([0.0, 2.0 * damping, 0.0], frequency, damping, paths.rate)
        taps.append(values["amount"] * sense * ringing)
    return filter_pressure(paths, padded_sum(taps)) if len(taps) > 1 else paths


def _resonances(
    form: str, values: Values, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the frequency [Hz] and the signed strength of each resonance."""
    first, spacing = values["frequency"], values["spacing"]
    count = 1 if form == "single" else 1 + max(0, int((_HIGHEST - first) / spacing))
    steps = np.full(count, spacing)
    senses: NDArray[np.float64] = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
    if form == "scattered":
        steps = rng.exponential(spacing, count)
        senses = rng.standard_normal(count)
    steps[0] = 0.0
    return first + np.cumsum(steps), senses


EFFECT = Effect(
    name="plate_modes",
    stage=Stage.RADIATION,
    forms=("single", "even", "scattered"),
    parameters={
        "amount": Parameter(1.0, "", 0.0, 100.0, "height of each resonance over the direct sound"),
        "frequency": Parameter(700.0, "Hz", 50.0, 16e3, "frequency of the first resonance"),
        "damping_ratio": Parameter(0.015, "", 1e-3, 0.5, "damping ratio of each resonance"),
        "spacing": Parameter(400.0, "Hz", 50.0, 16e3, "mean spacing of the resonances"),
    },
    strength="amount",
    chain=_chain,
)
