"""Signals as sensors read them, with one effect of the measurement on."""

import numpy as np

from sim.effects import EFFECTS

RATE = 96e3


def read(signals, name, seed=0, **parameters):
    active = EFFECTS[name].active(parameters)
    return active.apply_sensors(signals, RATE, np.random.default_rng(seed))


def random_signals(seed=0, n=4000):
    rng = np.random.default_rng(seed)
    return {
        "torque": 8.0 + rng.standard_normal(n),
        "acceleration": 30.0 * rng.standard_normal(n),
        "pressure": rng.standard_normal(n),
        "angle": np.linspace(0.0, 1.0, n),
    }


def tone(frequency, seconds=0.5):
    return np.sin(2.0 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE)


def rms(signal):
    return np.sqrt(np.mean(signal**2))
