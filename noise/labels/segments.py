"""Labels in time: windows are classified, and neighbours of one label make a segment."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from features.conditioning import ACOUSTIC_FROM
from features.harmonics import analyse_harmonics
from features.registry import KINDS, recording_features
from features.slip_pulses import acoustic_slips
from noise.classifier import LABELS
from noise.labels.levels import block_levels
from noise.recordings.blocks import RecordingBlocks

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

_AT_ONCE = 256
"""Windows that are classified, and cells that are averaged, together."""


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
    recording: Recording | RecordingBlocks, classifier: Classifier, *, per_track: bool = False
) -> list[Segment]:
    """Label a recording.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        What is too long to be in memory is read in blocks, with the same result.
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
    blocks = RecordingBlocks.of(recording)
    if per_track and len(blocks.channels) > 1:
        return [
            segment
            for row in range(len(blocks.channels))
            for segment in _label(blocks.track(row), classifier, str(row + 1))
        ]
    return _label(blocks, classifier, "all")


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


def _label(blocks: RecordingBlocks, classifier: Classifier, channel: str) -> list[Segment]:
    if blocks.rate < _LEAST_RATE or all(blocks.first(kind) is None for kind in KINDS):
        nothing_to_tell = np.eye(len(LABELS))[LABELS.index("unknown")]
        return [_segment(blocks, channel, 0, blocks.n_samples, nothing_to_tell)]
    starts = _window_starts(blocks)
    length = min(blocks.n_samples, round(WINDOW * blocks.rate))
    probabilities = _window_probabilities(blocks, starts, length, classifier)
    cells, cell_probabilities = _on_cells(starts, length, blocks, probabilities)
    silent = [_is_silent(blocks.cut(*edges)) for edges in pairwise(cells)]
    cell_probabilities[silent] = np.eye(len(LABELS))[LABELS.index("none")]
    labels = cell_probabilities.argmax(axis=1)
    edges = [0, *(np.flatnonzero(np.diff(labels)) + 1), len(labels)]
    return [
        _segment(
            blocks,
            channel,
            cells[first],
            cells[last],
            cell_probabilities[first:last].mean(axis=0),
        )
        for first, last in itertools.pairwise(edges)
    ]


def _window_starts(blocks: RecordingBlocks) -> list[int]:
    n = blocks.n_samples
    length, hop = round(WINDOW * blocks.rate), round(HOP * blocks.rate)
    if n <= length:
        return [0]
    starts = list(range(0, n - length + 1, hop))
    if n - length - starts[-1] > (1.0 - _SHORTEST_TAIL) * hop:
        starts.append(n - length)
    return starts


def _window_probabilities(
    blocks: RecordingBlocks, starts: list[int], length: int, classifier: Classifier
) -> NDArray[np.float64]:
    """Return the probabilities of all windows, `_AT_ONCE` at a time."""
    return np.concatenate(
        [
            _classified(
                [blocks.cut(start, start + length) for start in starts[first : first + _AT_ONCE]],
                classifier,
            )
            for first in range(0, len(starts), _AT_ONCE)
        ]
    )


def _classified(windows: list[Recording], classifier: Classifier) -> NDArray[np.float64]:
    silent = np.array([_is_silent(window) for window in windows])
    probabilities = np.zeros((len(windows), len(LABELS)))
    probabilities[silent, LABELS.index("none")] = 1.0
    if not silent.all():
        loud = [window for window, s in zip(windows, silent, strict=True) if not s]
        rows = [recording_features(w, names=classifier.feature_names) for w in loud]
        probabilities[~silent] = classifier.predict_proba(rows)
    return probabilities


def _is_silent(recording: Recording) -> bool:
    if recording.first("pressure") is None:
        return not any(np.ptp(signal) > 0.0 for signal in recording.samples)
    level, level_dbfs = block_levels(RecordingBlocks.of(recording), 0, recording.samples.shape[1])
    if level is not None:
        return level < _SILENT_LEVEL
    return level_dbfs is None or level_dbfs < _SILENT_LEVEL_DBFS


def _on_cells(
    starts: list[int], length: int, blocks: RecordingBlocks, probabilities: NDArray[np.float64]
) -> tuple[list[int], NDArray[np.float64]]:
    """Mean probabilities on cells one hop long, each of the windows about it."""
    n = blocks.n_samples
    hop = round(HOP * blocks.rate)
    edges = [*range(0, max(n - hop // 2, 1), hop), n]
    middles = 0.5 * (np.array(edges[:-1]) + np.array(edges[1:]))
    centres = np.array(starts) + 0.5 * length
    means = np.empty((middles.size, len(LABELS)))
    for first in range(0, middles.size, _AT_ONCE):
        some = middles[first : first + _AT_ONCE]
        # The nearest window to a cell is never farther than its own length.
        near = slice(*np.searchsorted(centres, (some[0] - length - hop, some[-1] + length + hop)))
        # A triangle: windows count the less the farther their middle is from the cell.
        distance = np.abs(some[:, None] - centres[None, near])
        nearest = distance.min(axis=1, keepdims=True)
        weight = np.maximum(0.0, 1.0 - (distance - nearest) / hop)
        weight /= weight.sum(axis=1, keepdims=True)
        means[first : first + _AT_ONCE] = weight @ probabilities[near]
    return edges, means


def _segment(
    blocks: RecordingBlocks,
    channel: str,
    first: int,
    last: int,
    probabilities: NDArray[np.float64],
) -> Segment:
    label = LABELS[int(probabilities.argmax())]
    level, level_dbfs = block_levels(blocks, first, last)
    return Segment(
        channel=channel,
        start=first / blocks.rate,
        end=last / blocks.rate,
        label=label,
        probabilities=dict(zip(LABELS, probabilities.tolist(), strict=True)),
        frequency=_frequency(blocks, first, last, label),
        level=level,
        level_dbfs=level_dbfs,
    )


def _frequency(blocks: RecordingBlocks, first: int, last: int, label: str) -> float | None:
    """Slip frequency of creak and squawk, else the strongest line: of the torque if it is there."""
    rows = [blocks.first(kind) for kind in ("torque", "pressure", "acceleration")]
    index = next((row for row in rows if row is not None), None)
    if label == "none" or index is None or blocks.rate < _LEAST_RATE:
        return None
    spare = max(0, last - first - round(_LONGEST_LOOK * blocks.rate)) // 2
    signal = blocks.read(first + spare, last - spare)[index]
    torque = index == rows[0]
    if label == "creak" and not torque:
        pulses = acoustic_slips(signal, blocks.rate).rate
        if pulses > 0.0:
            return float(pulses)
    harmonics = analyse_harmonics(signal, blocks.rate)
    if label in ("creak", "squawk") and np.isfinite(harmonics.fundamental):
        return float(harmonics.fundamental)
    # Below lies rumble, which may be louder than any tone.
    lines = harmonics.peaks.frequency[(harmonics.peaks.frequency >= ACOUSTIC_FROM) | torque]
    return float(lines[0]) if lines.size else None
