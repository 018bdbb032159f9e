"""Sound that reaches the microphone by reflections in the room.

The plain model has the direct sound only. A room adds reflections, which follow from its size, its
reverberation time T and the distance r of the microphone. Walls reflect 1 - alpha of the energy,
alpha = 1 - exp(-0.161 V / (T S)) (Eyring 1930, J. Acoust. Soc. Am. 1, 217), at all frequencies:

- floor: one reflection, a comb in the spectrum; the source stands 0.9 m above the floor and the
  microphone hangs straight above it.
- shoebox: all reflections of a rectangular room within 0.1 s, by image sources (Allen and Berkley
  1979, J. Acoust. Soc. Am. 65, 943).
- diffuse: a tail of noise that decays by 60 dB in T, after the mean time between reflections,
  4 V / (S c); 16 pi r**2 / A times the energy of the direct sound, A = 0.161 V / T (Kuttruff, *Room
  Acoustics*, chapter 5). The noise differs from seed to seed.

Levels are relative to the direct sound, independent of its directivity and of the microphone's
distance in the rig: `distance` belongs to the room. Amount zero is no room.

>>> from models.radiation.impulse_responses import ImpulseResponses
>>> one = np.ones(1)
>>> values = {name: parameter.default for name, parameter in EFFECT.parameters.items()}
>>> plain = ImpulseResponses(96e3, one, one, one, one)
>>> response = _chain(plain, "floor", values, np.random.default_rng(0))
>>> float(response.torque_to_pressure[0]), int(response.torque_to_pressure[1:].argmax()) + 1
(1.0, 503)
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rayleigh import SOUND_SPEED, cubic_weights
from sim.chain import filter_pressure
from sim.effects.effect import Effect, Parameter, Stage, Values

_SOURCE_HEIGHT = 0.9
"""Height of the rig on its bench above the floor [m]; assumed."""

_ALONG, _ACROSS = 0.42, 0.37
"""Place of the rig, as shares of length and width, away from the middle; assumed."""

_EARLY = 0.1
"""Latest reflection of the shoebox after the direct sound [s]."""


def _chain(
    paths: ImpulseResponses, form: str, values: Values, rng: np.random.Generator
) -> ImpulseResponses:
    if form == "diffuse":
        reflections = _tail(values, paths.rate, rng)
    else:
        length, gain = _floor(values) if form == "floor" else _images(values)
        reflections = _echoes(length - values["distance"], gain, paths.rate)
    reflections *= values["amount"]
    reflections[0] += 1.0
    return filter_pressure(paths, reflections)


def _surface(values: Values) -> tuple[float, float, float]:
    """Return the volume [m3], the surface [m2] and the walls' reflection factor of pressure [-]."""
    x, y, z = values["length"], values["width"], values["height"]
    volume, surface = x * y * z, 2.0 * (x * y + y * z + z * x)
    absorption = 0.161 * volume / (values["reverberation_time"] * surface)
    return volume, surface, math.exp(-0.5 * absorption)


def _floor(values: Values) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the path length of the reflection [m], and its gain over the direct sound."""
    way = values["distance"] + 2.0 * _SOURCE_HEIGHT
    return np.array([way]), np.array([_surface(values)[2] * values["distance"] / way])


def _images(values: Values) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the path length of each reflection in the shoebox [m], and its gain."""
    sides = np.array([values["length"], values["width"], values["height"]])
    source = np.array([_ALONG * sides[0], _ACROSS * sides[1], _SOURCE_HEIGHT])
    microphone = source + np.array([0.0, 0.0, values["distance"]])
    farthest = SOUND_SPEED * _EARLY + values["distance"]
    offsets, bounces = [], []
    for side, at, ear in zip(sides, source, microphone, strict=True):
        n = np.arange(-math.ceil(farthest / side) - 1, math.ceil(farthest / side) + 2)
        # Image n lies in the n-th room along this side, behind |n| walls.
        place = np.where(n % 2 == 0, n * side + at, (n + 1) * side - at)
        offsets.append((place - ear) ** 2)
        bounces.append(np.abs(n))
    way = np.sqrt(offsets[0][:, None, None] + offsets[1][:, None] + offsets[2]).ravel()
    walls = (bounces[0][:, None, None] + bounces[1][:, None] + bounces[2]).ravel()
    near = (walls > 0) & (way < farthest)
    return way[near], _surface(values)[2] ** walls[near] * values["distance"] / way[near]


def _echoes(
    detour: NDArray[np.float64], gain: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    """Return the taps of echoes by their detour [m], between samples by Lagrange's cubic."""
    time = detour * (rate / SOUND_SPEED)
    # The cubic needs a sample before; the direct sound stays the first tap.
    sample = np.maximum(np.floor(time).astype(np.int64), 2)
    f = np.maximum(time - sample, 0.0)
    taps = np.zeros(int(sample.max()) + 3)
    for offset, weight in enumerate(cubic_weights(f), start=-1):
        np.add.at(taps, sample + offset, gain * weight)
    return taps


def _tail(values: Values, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    volume, surface, _ = _surface(values)
    reverberation = values["reverberation_time"]
    energy = 16.0 * np.pi * values["distance"] ** 2 * reverberation / (0.161 * volume)
    start = max(1, round(4.0 * volume / (surface * SOUND_SPEED) * rate))
    decay = math.log(1e6) / (reverberation * rate)  # of energy, a sample
    time = np.arange(start, start + round(reverberation * rate))
    taps = np.zeros(time[-1] + 1)
    # The energy is that of a decay that begins with the direct sound.
    taps[time] = np.sqrt(energy * decay) * np.exp(-0.5 * decay * time)
    taps[time] *= rng.standard_normal(time.size)
    return taps


EFFECT = Effect(
    name="room_reflections",
    stage=Stage.RADIATION,
    forms=("floor", "shoebox", "diffuse"),
    parameters={
        "amount": Parameter(1.0, "", 0.0, 10.0, "factor on all reflected pressure"),
        "distance": Parameter(0.6, "m", 0.05, 1.2, "distance of the microphone from the source"),
        "length": Parameter(6.0, "m", 2.0, 50.0, "length of the room"),
        "width": Parameter(5.0, "m", 2.0, 50.0, "width of the room"),
        "height": Parameter(3.0, "m", 2.2, 20.0, "height of the room"),
        "reverberation_time": Parameter(0.4, "s", 0.05, 3.0, "time of a decay by 60 dB"),
    },
    strength="amount",
    chain=_chain,
)
