"""What a review is made of, small: recordings with sidecars, a label table."""

from __future__ import annotations

import numpy as np

from models.condition import Condition
from models.recording import Channel, Recording
from noise.base.tables import write_table
from noise.labels.table import COLUMNS
from noise.recordings import write_recording

RATE = 48_000
TONE = 997.0


def sound(kind, seconds=1.5):
    time = np.arange(round(seconds * RATE)) / RATE
    match kind:
        case "creak":
            return 0.5 * (2.0 * ((40.0 * time) % 1.0) - 1.0)
        case "squeal":
            return 0.2 * np.sin(2.0 * np.pi * TONE * time)
        case "hiss":
            return 0.3 * np.random.default_rng(3).normal(size=time.size)
    return np.zeros(time.size)


def recording(kind, speed=5.0, seconds=1.5, calibrated=True):
    condition = Condition(speed, 0.279e-3, 2214.0, "fluorocarbon", 23.0)
    samples = sound(kind, seconds)[np.newaxis]
    return Recording(samples, RATE, (Channel("pressure"),), condition, calibrated)


def row(file, label, start=0.0, end=1.5, **others):
    shares = {f"p_{name}": 0.1 for name in ("creak", "squawk", "squeal", "none", "unknown")}
    known = {
        "file": file, "channel": "all", "start_s": start, "end_s": end, "label": label,
        "level_db": 80.0, "calibrated": True, "speed_rad_s": 5.0, "speed_rad_s_source": "logged",
        "interference_mm": 0.279, "interference_mm_source": "logged",
        "support_stiffness_Nm_rad": 2214.0, "support_stiffness_Nm_rad_source": "logged",
        "material": "fluorocarbon", "material_source": "logged",
    }  # fmt: skip
    return dict.fromkeys(COLUMNS) | shares | known | others


def write_campaign(folder):
    """Three recordings and their label table."""
    runs = folder / "recordings"
    for kind, speed, seconds in (("creak", 1.0, 1.5), ("squeal", 10.0, 3.0), ("none", 5.0, 1.5)):
        write_recording(runs / f"{kind}.wav", recording(kind, speed, seconds))
    rows = [
        row("creak.wav", "creak", 0.0, 1.0, speed_rad_s=1.0),
        row("creak.wav", "none", 1.0, 1.5, speed_rad_s=1.0),
        row("squeal.wav", "squeal", 0.0, 3.0, speed_rad_s=10.0),
        row("none.wav", "none"),
    ]
    write_table(folder / "labels.csv", COLUMNS, rows)
    return folder
