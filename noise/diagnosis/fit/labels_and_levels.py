"""Label and level of a recording and of its simulations, as the user hears them."""

from __future__ import annotations

import math

from features.kernels.levels import a_weighted_level
from models.recording import Recording
from noise.classifier import load_classifier
from noise.diagnosis.findings import LabelsAndLevels
from noise.labels.segments import file_label, label_recording


def labels_and_levels(
    name: str, measured: Recording, before: Recording, after: Recording | None
) -> LabelsAndLevels:
    """Label three recordings of one condition, and give their A-weighted levels."""
    return LabelsAndLevels(
        recording=name,
        label_measured=_label(measured),
        label_before=_label(before),
        label_after=None if after is None else _label(after),
        level_measured=_level(measured),
        level_before=_level(before),
        level_after=None if after is None else _level(after),
    )


def _label(recording: Recording) -> str:
    return file_label(label_recording(recording, load_classifier())).label


def _level(recording: Recording) -> float:
    row = recording.first("pressure")
    if row is None:
        return math.nan
    return a_weighted_level(recording.samples[row], recording.rate)
