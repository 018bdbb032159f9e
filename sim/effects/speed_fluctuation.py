"""Fluctuation of the shaft's speed about its set value.

The speed becomes Omega(t) (1 + d q(t)), where d is the depth and q has the rms of a sine of
amplitude one in every form; the degree of irregularity of a sine, (max - min) / mean, is 2 d. Since
it is relative, an oscillating shaft keeps its turning points, and depth zero leaves the speed
unchanged.

- sine: q = sin(phi + phi_0), as from an eccentric coupling or a belt. phi is `order` times the
  angle of the undisturbed motion, so it follows run-ups and reversals; with a `frequency` above
  zero, phi = 2 pi frequency t, as for a motor on the mains.
- harmonics: sum of sin(h phi + phi_h) / h over h = 1 ... 4, as from gears and poles.
- random: an Ornstein-Uhlenbeck process, dq = -q dt / tau + sqrt(1 / tau) dW with tau = 1 / (2 pi
  bandwidth), stationary from the start, as of a hunting controller (Uhlenbeck & Ornstein 1930;
  exact steps by Gillespie 1996, Phys. Rev. E 54, 2084). Its acceleration grows with the square root
  of the rate: 2 % of 5 rad/s at 10 Hz give 0.004 Nm rms on the elastomer's inertia at 90 kHz.

Phases are random, since a recording starts at any time. The fluctuation of the thesis's motor is
unknown; all values are assumed.

>>> even = np.full(90_000, 5.0)
>>> uneven = _drive(even, 90e3, "sine", {"depth": 0.1, "order": 1.0, "frequency": 10.0,
...                 "bandwidth": 10.0}, np.random.default_rng(0))
>>> round(float(uneven.min()), 3), round(float(uneven.max()), 3)
(4.5, 5.5)
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sim.effects.effect import Effect, Parameter, Stage, Values

_HARMONICS = 4


def _drive(
    speed: NDArray[np.float64], rate: float, form: str, values: Values, rng: np.random.Generator
) -> NDArray[np.float64]:
    if form == "random":
        course = _random(speed.size, values["bandwidth"] / rate, rng)
    else:
        if values["frequency"] > 0.0:
            step = 2.0 * math.pi * values["frequency"] / rate
            phase = np.arange(speed.size, dtype=float) * step
        else:
            phase = values["order"] / rate * np.cumsum(speed)
        course = _harmonics(phase, _HARMONICS if form == "harmonics" else 1, rng)
    return speed * (1.0 + values["depth"] * course)


def _harmonics(
    phase: NDArray[np.float64], count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return a sum of harmonics with the rms of a sine of amplitude one."""
    course = np.zeros_like(phase)
    for h in range(1, count + 1):
        course += np.sin(h * phase + rng.uniform(0.0, 2.0 * math.pi)) / h
    return course / math.sqrt(sum(h**-2 for h in range(1, count + 1)))


def _random(n: int, bandwidth: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return an Ornstein-Uhlenbeck process with the rms of a sine of amplitude one."""
    decay = math.exp(-2.0 * math.pi * bandwidth)
    increments = rng.standard_normal(n) * math.sqrt(1.0 - decay**2)
    increments[0] = rng.standard_normal()
    return np.asarray(lfilter([math.sqrt(0.5)], [1.0, -decay], increments))


EFFECT = Effect(
    name="speed_fluctuation",
    stage=Stage.DRIVE,
    forms=("sine", "harmonics", "random"),
    parameters={
        "depth": Parameter(0.02, "", 0.0, 0.3, "amplitude of a sine of equal rms, over speed"),
        "order": Parameter(1.0, "", 0.1, 200.0, "periods per turn; sine and harmonics only"),
        "frequency": Parameter(
            0.0, "Hz", 0.0, 500.0, "fixed frequency of sine and harmonics; 0: follow the order"
        ),
        "bandwidth": Parameter(10.0, "Hz", 0.05, 500.0, "3 dB corner; random only"),
    },
    strength="depth",
    drive=_drive,
    irregular=True,
)
