"""Paths from torque and blows to acceleration and sound, with one effect on."""

from __future__ import annotations

import numpy as np

from sim.chain import changed_chain
from sim.effects import EFFECTS

RATE = 96e3


def changed(paths, name, seed=0, **parameters):
    active = EFFECTS[name].active(parameters)
    return changed_chain(paths, [active], np.random.default_rng(seed))


def spectra(*signals, n=2**17):
    """Frequencies from 300 Hz to 18 kHz, and the spectrum of each signal there."""
    frequency = np.fft.rfftfreq(n, 1 / RATE)
    kept = (frequency > 300.0) & (frequency < 18e3)
    return frequency[kept], *(np.fft.rfft(signal, n)[kept] for signal in signals)
