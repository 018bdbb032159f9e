"""Labels in time: windows are classified, and neighbours of one label make a segment."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from features.conditioning import ACOUSTIC_FROM
from features.harmonics import analyse_harmonics
from features.registry import KINDS, recording_features
from features.slip_pulses import acoustic_slips
from models.recording import REFERENCE_PRESSURE
from noise.classifier import LABELS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from models.recording import Recording
    from noise.classifier import Classifier

__all__ = ["Segment", "file_label", "label_recording"]

WINDOW = 0.5
"""Length of what is classified at once [s]."""

HOP = 0.125
"""Time from one window to the next [s]; segments begin and end on it."""

_SHORTEST_TAIL = 0.5
"""A last window is one if at least this share of it lies in the recording."""

_SILENT_LEVEL = 10.0
"""Calibrated sound below it is silence [dB re 20 uPa]: below any microphone's own noise."""

_SILENT_LEVEL_DBFS = -90.0
"""Uncalibrated sound below it is silence [dBFS]: the last bit of 16."""

_LEAST_RATE = 1000.0
"""A recording sampled more slowly shows nothing of a noise [Hz]."""

_LONGEST_LOOK = 4.0
"""The frequency of a longer segment is that of so much of its middle [s]."""


@dataclass(frozen=True)
class Segment:
    """A stretch of a recording with one label.

    Parameters
    ----------
    channel : str
        ``all``, or the track of a plain sound file with several.
    start, end : float
        [s]
    label : str
        The most probable of `noise.classifier.LABELS`.
    probabilities : mapping of str to float
        Of all labels; mean over the segment's windows.
    frequency : float or None
        Slip frequency of a creak or squawk, strongest line of others [Hz]; ``None`` where there
        is none.
    level : float or None
        Sound pressure level [dB re 20 uPa]; ``None`` where not calibrated.
    level_dbfs : float or None
        Root mean square of the samples relative to full scale 1.0 [dB]; ``None`` for digital zero.
    """

    channel: str
    start: float
    end: float
    label: str
    probabilities: Mapping[str, float]
    frequency: float | None
    level: float | None
    level_dbfs: float | None


def label_recording(
    recording: Recording, classifier: Classifier, *, per_track: bool = False
) -> list[Segment]:
    """Label a recording.

    Parameters
    ----------
    recording : Recording
    classifier : Classifier
    per_track : bool
        Whether each channel is labelled on its own, as the tracks of a plain sound file are.

    Returns
    -------
    list of Segment
        In order of time, without gaps; track by track.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.classifier import load_classifier
    >>> from sim.run import simulate
    >>> silent = simulate(load_material_rig("PDMS"), 5.0).recording
    >>> [segment.label for segment in label_recording(silent, load_classifier())]
    ['none']
    """
    if per_track and len(recording.channels) > 1:
        return [
            segment
            for i, channel in enumerate(recording.channels)
            for segment in _label(
                replace(
                    recording,
                    samples=recording.samples[i : i + 1],
                    channels=(replace(channel, name=channel.kind),),
                ),
                classifier,
                str(i + 1),
            )
        ]
    return _label(recording, classifier, "all")


def file_label(segments: list[Segment]) -> Segment:
    """Return the segment that names a file: the longest that is not ``none``.

    Examples
    --------
    >>> short = Segment("all", 0.0, 1.0, "creak", {}, None, None, None)
    >>> long = Segment("all", 1.0, 9.0, "none", {}, None, None, None)
    >>> file_label([short, long]).label
    'creak'
    """
    audible = [segment for segment in segments if segment.label != "none"]
    return max(audible or segments, key=lambda segment: segment.end - segment.start)


def _label(recording: Recording, classifier: Classifier, channel: str) -> list[Segment]:
    if recording.rate < _LEAST_RATE or all(recording.first(kind) is None for kind in KINDS):
        nothing_to_tell = np.eye(len(LABELS))[LABELS.index("unknown")]
        return [_segment(recording, channel, 0, recording.samples.shape[1], nothing_to_tell)]
    starts = _window_starts(recording)
    length = min(recording.samples.shape[1], round(WINDOW * recording.rate))
    windows = [_cut(recording, start, start + length) for start in starts]
    probabilities = _window_probabilities(windows, classifier)
    cells, cell_probabilities = _on_cells(starts, length, recording, probabilities)
    silent = [_is_silent(_cut(recording, *edges)) for edges in pairwise(cells)]
    cell_probabilities[silent] = np.eye(len(LABELS))[LABELS.index("none")]
    labels = cell_probabilities.argmax(axis=1)
    edges = [0, *(np.flatnonzero(np.diff(labels)) + 1), len(labels)]
    return [
        _segment(
            recording,
            channel,
            cells[first],
            cells[last],
            cell_probabilities[first:last].mean(axis=0),
        )
        for first, last in itertools.pairwise(edges)
    ]


def _window_starts(recording: Recording) -> list[int]:
    n = recording.samples.shape[1]
    length, hop = round(WINDOW * recording.rate), round(HOP * recording.rate)
    if n <= length:
        return [0]
    starts = list(range(0, n - length + 1, hop))
    if n - length - starts[-1] > (1.0 - _SHORTEST_TAIL) * hop:
        starts.append(n - length)
    return starts


def _cut(recording: Recording, first: int, last: int) -> Recording:
    return replace(recording, samples=recording.samples[:, first:last])


def _window_probabilities(windows: list[Recording], classifier: Classifier) -> NDArray[np.float64]:
    silent = np.array([_is_silent(window) for window in windows])
    probabilities = np.zeros((len(windows), len(LABELS)))
    probabilities[silent, LABELS.index("none")] = 1.0
    if not silent.all():
        rows = [recording_features(w) for w, s in zip(windows, silent, strict=True) if not s]
        probabilities[~silent] = classifier.predict_proba(rows)
    return probabilities


def _is_silent(recording: Recording) -> bool:
    if recording.first("pressure") is None:
        return not any(np.ptp(signal) > 0.0 for signal in recording.samples)
    level, level_dbfs = _levels(recording)
    if level is not None:
        return level < _SILENT_LEVEL
    return level_dbfs is None or level_dbfs < _SILENT_LEVEL_DBFS


def _on_cells(
    starts: list[int], length: int, recording: Recording, probabilities: NDArray[np.float64]
) -> tuple[list[int], NDArray[np.float64]]:
    """Mean probabilities on cells one hop long, each of the windows about it."""
    n = recording.samples.shape[1]
    hop = round(HOP * recording.rate)
    edges = [*range(0, max(n - hop // 2, 1), hop), n]
    middles = 0.5 * (np.array(edges[:-1]) + np.array(edges[1:]))
    centres = np.array(starts) + 0.5 * length
    # A triangle: windows count the less the farther their middle is from the cell.
    distance = np.abs(middles[:, None] - centres[None, :])
    nearest = distance.min(axis=1, keepdims=True)
    weight = np.maximum(0.0, 1.0 - (distance - nearest) / hop)
    weight /= weight.sum(axis=1, keepdims=True)
    return edges, weight @ probabilities


def _segment(
    recording: Recording, channel: str, first: int, last: int, probabilities: NDArray[np.float64]
) -> Segment:
    part = _cut(recording, first, last)
    label = LABELS[int(probabilities.argmax())]
    level, level_dbfs = _levels(part)
    return Segment(
        channel=channel,
        start=first / recording.rate,
        end=last / recording.rate,
        label=label,
        probabilities=dict(zip(LABELS, probabilities.tolist(), strict=True)),
        frequency=_frequency(part, label),
        level=level,
        level_dbfs=level_dbfs,
    )


def _levels(recording: Recording) -> tuple[float | None, float | None]:
    """Level of the first pressure channel: dB re 20 uPa and dBFS."""
    row = recording.first("pressure")
    if row is None:
        return None, None
    signal = recording.samples[row]
    signal = signal - signal.mean()
    peak = float(np.abs(signal).max())
    if not peak > 0.0:
        return None, None
    # Scaled by the peak, whose square may overflow.
    rms_db = 20.0 * float(np.log10(peak) + np.log10(np.sqrt(np.mean((signal / peak) ** 2))))
    full_scale = recording.channels[row].full_scale if recording.calibrated else 1.0
    level_dbfs = rms_db - 20.0 * float(np.log10(full_scale))
    if not recording.calibrated:
        return None, level_dbfs
    return rms_db - 20.0 * float(np.log10(REFERENCE_PRESSURE)), level_dbfs


def _frequency(recording: Recording, label: str) -> float | None:
    """Slip frequency of creak and squawk, else the strongest line: of the torque if it is there."""
    rows = [recording.first(kind) for kind in ("torque", "pressure", "acceleration")]
    index = next((row for row in rows if row is not None), None)
    if label == "none" or index is None or recording.rate < _LEAST_RATE:
        return None
    signal = recording.samples[index]
    spare = max(0, signal.size - round(_LONGEST_LOOK * recording.rate)) // 2
    signal = signal[spare : signal.size - spare]
    torque = index == rows[0]
    if label == "creak" and not torque:
        pulses = acoustic_slips(signal, recording.rate).rate
        if pulses > 0.0:
            return float(pulses)
    harmonics = analyse_harmonics(signal, recording.rate)
    if label in ("creak", "squawk") and np.isfinite(harmonics.fundamental):
        return float(harmonics.fundamental)
    # Below lies rumble, which may be louder than any tone.
    lines = harmonics.peaks.frequency[(harmonics.peaks.frequency >= ACOUSTIC_FROM) | torque]
    return float(lines[0]) if lines.size else None
