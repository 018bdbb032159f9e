"""Wrong benches: each made from the recordings of a right one by a single mistake."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

__all__ = ["WRONG_BENCHES"]

CHANNELS = ("torque", "acceleration", "pressure", "angle")


def _scaled(kind, factor):
    def change(recording, _rng):
        samples = np.array(recording.samples, dtype=np.float64)
        samples[recording.first(kind)] *= factor
        return replace(recording, samples=samples)

    return _each(change)


def _swapped(one, other):
    def change(recording, _rng):
        samples = np.array(recording.samples)
        rows = [recording.first(one), recording.first(other)]
        samples[rows] = samples[rows[::-1]]
        return replace(recording, samples=samples)

    return _each(change)


def _filled(kinds, value):
    def change(recording, _rng):
        samples = np.array(recording.samples)
        samples[[recording.first(kind) for kind in kinds]] = value
        return replace(recording, samples=samples)

    return _each(change)


def _stated_speed(factor):
    def change(recording, _rng):
        c = recording.condition
        return replace(recording, condition=replace(c, speed=c.speed * factor))

    return _each(change)


def _each(change):
    return lambda recordings, rng: [change(recording, rng) for recording in recordings]


def _noise(recording, rng):
    spread = recording.samples.std(axis=1, keepdims=True)
    return replace(recording, samples=spread * rng.standard_normal(recording.samples.shape))


def _sound(recording, rng, *, speech):
    """Four channels of a full-scale sound: notes, or bursts of voiced noise."""
    n, rate = recording.samples.shape[1], recording.rate
    time = np.arange(n) / rate
    if speech:
        pitch = 120.0 * (1.0 + 0.1 * np.sin(2 * math.pi * 2.0 * time))
        phase = 2 * math.pi * np.cumsum(pitch) / rate
        sound = sum(np.sin(k * phase) / k for k in range(1, 20))
        sound = sound * np.clip(np.sin(2 * math.pi * 3.0 * time), 0.0, None)
    else:
        notes = rng.choice([220.0, 262.0, 330.0, 392.0, 440.0], 1 + int(time[-1] / 0.125))
        f = notes[(time / 0.125).astype(int)]
        phase = 2 * math.pi * np.cumsum(f) / rate
        sound = sum(np.sin(k * phase) / k for k in range(1, 6))
    shifted = [np.roll(sound, int(rng.integers(n))) for _ in recording.channels]
    return replace(recording, samples=0.3 * np.stack(shifted))


def _shuffled(recordings, rng):
    """Give recordings each other's conditions, none of an equal one its own."""
    conditions = [recording.condition for recording in recordings]
    operating = [(c.speed, c.interference) for c in conditions]
    orders = [rng.permutation(len(conditions)) for _ in range(200)]
    moved = [sum(operating[i] != operating[j] for i, j in enumerate(order)) for order in orders]
    order = orders[int(np.argmax(moved))]
    return [
        replace(recording, condition=conditions[j])
        for recording, j in zip(recordings, order, strict=True)
    ]


WRONG_BENCHES = {
    "acceleration in g": (_scaled("acceleration", 1.0 / 9.80665), "acceleration looks like g"),
    "pressure in mPa": (_scaled("pressure", 1e3), "pressure looks like mPa"),
    "torque in N mm": (_scaled("torque", 1e3), "torque looks like N mm"),
    "angle in degrees": (_scaled("angle", 180.0 / math.pi), "angle looks like degrees"),
    "speed in rpm": (_stated_speed(30.0 / math.pi), "stated speed looks like rpm"),
    "speed three times too high": (_stated_speed(3.0), "stated speed is 3 times too large"),
    "torque turned": (_scaled("torque", -1.0), "torque has its sign turned"),
    "angle turned": (_scaled("angle", -1.0), "against the stated speed"),
    "acceleration and pressure swapped": (_swapped("acceleration", "pressure"), "swapped"),
    "torque and angle swapped": (_swapped("torque", "angle"), "torque and angle look swapped"),
    "torque and acceleration swapped": (_swapped("torque", "acceleration"), "swapped"),
    "a channel at zero": (_filled(["pressure"], 0.0), "pressure is dead"),
    "a channel constant": (_filled(["torque"], 3.0), "torque is dead"),
    "all zero": (_filled(CHANNELS, 0.0), "dead"),
    "all constant": (_filled(CHANNELS, 1.0), "dead"),
    "white noise": (_each(_noise), ""),
    "music": (_each(lambda r, rng: _sound(r, rng, speech=False)), ""),
    "speech": (_each(lambda r, rng: _sound(r, rng, speech=True)), ""),
    "conditions shuffled": (_shuffled, ""),
}  # fmt: skip
"""By name: what is done to the recordings of a case, and words of the finding."""
