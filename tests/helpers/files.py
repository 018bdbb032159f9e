"""Small files that many tests write, and what they read of them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import soundfile

from models.errors import RecordingError
from models.recording import Channel, Recording
from noise.recordings import read_recording, write_recording

RATE = 48_000
HALF = np.full(480, 0.5)


def csv_rows(path):
    """Rows of a CSV table."""
    with Path(path).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def pressure_file(path, pressure, rate=RATE, *condition):
    """A recording of sound pressure [Pa] with its sidecar."""
    samples = np.atleast_2d(np.asarray(pressure, dtype=np.float64))
    return write_recording(path, Recording(samples, rate, (Channel("pressure"),), *condition))


def sound(path, samples=HALF, subtype="PCM_16", rate=RATE, comment="", **sidecar):
    """A sound file, with a sidecar where it says something."""
    samples = np.asarray(samples)
    tracks = 1 if samples.ndim == 1 else samples.shape[1]
    with soundfile.SoundFile(path, "w", rate, tracks, subtype) as file:
        if comment:
            file.comment = comment
        file.write(samples)
    if sidecar:
        path.with_suffix(".json").write_text(json.dumps(sidecar))
    return path


def named(*names, **more):
    """Channels of a sidecar."""
    return [{"name": name, "unit": Channel(name).unit, **more} for name in names]


def refusal(path):
    """The one line in which a recording is refused, or its sidecar."""
    with pytest.raises(RecordingError) as refused:
        read_recording(path)
    message = str(refused.value)
    assert message.startswith(str(path.with_suffix("")))
    assert "\n" not in message
    return message
