"""A folder of tones, each half as loud as the one before, and their label table."""

from __future__ import annotations

import numpy as np

from models.recording import Channel, Recording
from noise.base.tables import write_table
from noise.labels.table import COLUMNS
from noise.recordings.wav import write_recording
from tests.helpers.labelled_folder import made_row

RATE = 48000

NAMES = ("loudest.wav", "<img src=x onerror=alert(1)>.wav", "softer.wav", "softest.wav")
"""The loudest first."""


def tone(frequency, amplitude, seconds=1.0):
    samples = amplitude * np.sin(2 * np.pi * frequency * np.arange(round(RATE * seconds)) / RATE)
    return Recording(samples[None], RATE, (Channel("pressure"),), calibrated=True)


def write_tones(folder, names=NAMES):
    """Write tones of 1 kHz, of 1, 1/2, 1/4 ... Pa, of which the first squeals."""
    for number, name in enumerate(names):
        write_recording(folder / name, tone(1000.0, 0.5**number))
    rows = [made_row(name, "none" if at else "squeal", 0.0, 1.0) for at, name in enumerate(names)]
    write_table(folder / "labels.csv", COLUMNS, rows)
    return folder
