"""Segments of a recording with one label each, from classified windows.

Features are classified page by page. Only the few that give the frequency of a segment are stored.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from features.prepared import ACOUSTIC_KINDS
from features.table import KINDS, WINDOW_FEATURES
from features.windows.table import HOP, LENGTH
from models.recording import REFERENCE_PRESSURE, Recording, RecordingBlocks
from models.show import short_repr
from noise.base.labels import LABELS
from noise.classifier import Classifier
from noise.labels.levels import CELL_RATE, cell_edges, rms_level, sound_levels, with_levels
from noise.labels.segmentation import change_points, labelled_stretches
from noise.labels.windows import (
    FEATURE_NAMES,
    WindowFeatures,
    columns_of,
    has_window_channel,
    tracks,
    window_features,
)


@short_repr
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
        The most probable of `noise.classifier.LABELS`, or ``unknown`` for a noise below the
        threshold of the classifier; thresholds are not used at a stated operating condition, where
        only a bushing is expected to sound.
    probabilities : mapping of str to float
        Probabilities of all labels [-], in the windows most like a noise
        (`noise.labels.segmentation.clearest`).
    frequency : float or None
        Slip frequency of a creak or squawk, strongest line of others [Hz]; ``None`` if there is
        none.
    level : float or None
        Sound pressure level [dB re 20 uPa]; ``None`` if not calibrated.
    level_dbfs : float or None
        Rms level relative to full scale 1.0 [dB]; ``None`` for digital zero.
    level_a, level_af_max : float or None
        A-weighted level, and its maximum with time weighting F [dB(A) re 20 uPa]; ``None`` if not
        calibrated.
    snr : float or None
        A-weighted level over the background [dB(A)], which is L_A90 of the recording without
        creaks, squawks, squeals and digital silence; ``None`` without such a part.

    Examples
    --------
    >>> Segment("all", 0.5, 2.0, "creak", {"creak": 0.9, "none": 0.1}, 152.0, 78.3, -12.0).label
    'creak'
    """

    channel: str
    start: float
    end: float
    label: str
    probabilities: Mapping[str, float]
    frequency: float | None
    level: float | None = None
    level_dbfs: float | None = None
    level_a: float | None = None
    level_af_max: float | None = None
    snr: float | None = None


def label_recording(
    recording: Recording | RecordingBlocks,
    classifier: Classifier,
    *,
    per_track: bool = False,
    surroundings: str | None = None,
) -> list[Segment]:
    """Return the labelled segments of a recording.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
        Long recordings are read in blocks, with the same result.
    classifier : Classifier
    per_track : bool
        Whether to label each channel separately, like the tracks of a plain sound file.
    surroundings : str, optional
        Place of the recording, of `noise.base.labels.SURROUNDINGS`; by default ``rig`` if an
        operating condition is stated, else ``any``.

    Returns
    -------
    list of Segment
        In order of time, without gaps, track by track.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.classifier import load_classifier
    >>> from sim.run import simulate
    >>> silent = simulate(load_material_rig("PDMS"), 5.0).recording
    >>> [segment.label for segment in label_recording(silent, load_classifier())]
    ['none']
    """
    described = tracks(RecordingBlocks.of(recording), per_track=per_track)
    return [
        segment
        for name, track in described
        for segment in with_levels(track, _label(track, classifier, name, surroundings))
    ]


def file_label(segments: list[Segment]) -> Segment:
    """Return the segment whose label names the file: the longest that is not ``none``.

    Parameters
    ----------
    segments : list of Segment
        One segment at least.

    Returns
    -------
    Segment

    Raises
    ------
    ValueError
        There are no segments.

    Examples
    --------
    >>> short = Segment("all", 0.0, 1.0, "creak", {}, None, None, None)
    >>> long = Segment("all", 1.0, 9.0, "none", {}, None, None, None)
    >>> file_label([short, long]).label
    'creak'
    """
    audible = [segment for segment in segments if segment.label != "none"]
    return max(audible or segments, key=lambda segment: segment.end - segment.start)


def _label(
    blocks: RecordingBlocks, classifier: Classifier, channel: str, surroundings: str | None
) -> list[Segment]:
    if not has_window_channel(blocks):
        certain = {label: float(label == "unknown") for label in LABELS}
        return [Segment(channel, 0.0, blocks.n_samples / blocks.rate, "unknown", certain, None)]
    at_rig = surroundings in (None, "rig") and at_a_condition(blocks)
    probabilities, of_frequency, described = classified(blocks, classifier, at_rig=at_rig)
    # At a stated condition only the bushing is expected to sound, so thresholds are not used.
    thresholds = None if at_rig else classifier.thresholds[surroundings or "any"]
    edges, names, clear = labelled_stretches(probabilities, thresholds, described.level)
    cells = np.round(change_points(described.frames, edges[1:-1] - 1) * CELL_RATE).astype(int)
    times = cell_edges(blocks.rate, blocks.n_samples) / blocks.rate
    last_cell = times.size - 1
    limits = [0, *np.clip(cells, 1, max(1, last_cell - 1)).tolist(), last_cell]
    parts = zip(pairwise(edges.tolist()), pairwise(limits), names.tolist(), clear, strict=True)
    segments = []
    for windows, (first, last), name, p in parts:
        if last <= first:
            continue
        start, end = times[[first, last]].tolist()
        frequency = segment_frequency(of_frequency[slice(*windows)], LABELS[name])
        by_label = dict(zip(LABELS, p.tolist(), strict=True))
        segments.append(Segment(channel, start, end, LABELS[name], by_label, frequency))
    return segments


_SILENT_LEVEL = 10.0
"""Level below which calibrated sound is silent, below the noise of microphones [dB re 20 uPa]."""

_SILENT_LEVEL_DBFS = -90.0
"""Level below which uncalibrated sound is silent, the last of 16 bits [dBFS]."""

_SURELY = 6.0
"""Level of the described band above silence from which a window is not checked [dB]."""

_STRANGERS = 0.3
"""Odds of `unknown` in recordings with a stated operating condition, relative to others [-];
assumed: a third of the training recordings are background sounds."""


def classified(
    blocks: RecordingBlocks, classifier: Classifier, *, at_rig: bool = False
) -> tuple[NDArray[np.float64], NDArray[np.float32], WindowFeatures]:
    """Describe and classify all windows of a recording.

    Parameters
    ----------
    blocks : RecordingBlocks
        As for `noise.labels.windows.window_features`.
    classifier : Classifier
    at_rig : bool
        Whether nothing but a bushing is expected to sound.

    Returns
    -------
    probabilities : ndarray, shape (n_windows, n_labels)
        Probabilities [-]; silent windows are ``none``.
    of_frequency : ndarray of float32, shape (n_windows, n_features)
        By `FREQUENCY_NAMES` [unit of each feature].
    windows : WindowFeatures
        Level and frames of all windows.
    """
    columns = columns_of(classifier)

    def spoken(features: NDArray[np.float32]) -> NDArray[np.float64]:
        p = classifier.predict_proba(features[:, columns])
        return np.concatenate([p, features[:, FREQUENCY_COLUMNS]], axis=1)

    windows = window_features(blocks, spoken)
    probabilities, of_frequency = np.split(windows.features, [len(LABELS)], axis=1)
    if at_rig:
        probabilities[:, LABELS.index("unknown")] *= _STRANGERS
        probabilities /= probabilities.sum(axis=1, keepdims=True)
    probabilities[_silent_windows(blocks, windows)] = np.eye(len(LABELS))[LABELS.index("none")]
    return probabilities, of_frequency.astype(np.float32), windows


def at_a_condition(blocks: RecordingBlocks) -> bool:
    """Whether an operating condition is stated, so that only a bushing is expected to sound."""
    at = blocks.condition
    stated = (at.speed, at.interference, at.support_stiffness)
    return any(value is not None for value in stated)


def _silent_windows(blocks: RecordingBlocks, windows: WindowFeatures) -> NDArray[np.bool_]:
    """Whether each window is silent."""
    edges, n = cell_edges(blocks.rate, blocks.n_samples), len(windows.level)
    row = blocks.first("pressure")
    full_scale = 1.0 if row is None else blocks.channels[row].full_scale
    silent = np.zeros(n, dtype=np.bool_)
    # The level of all frequencies is at least that of the described band.
    limit = _SILENT_LEVEL_DBFS + 20.0 * math.log10(full_scale)
    if blocks.calibrated:
        limit = _SILENT_LEVEL + 20.0 * math.log10(REFERENCE_PRESSURE)
    loud = (windows.level > limit + _SURELY) & (row is not None)
    main = next(row for row in map(blocks.first, KINDS) if row is not None)
    for window in np.flatnonzero(~loud).tolist():
        first = min(round(window * HOP * CELL_RATE), edges.size - 2)
        last = min(first + round(LENGTH * CELL_RATE), edges.size - 1)
        rms = rms_level(blocks, main, int(edges[first]), int(edges[last]))
        if rms is None or row is None:
            silent[window] = rms is None
            continue
        level, level_dbfs = sound_levels(rms, calibrated=blocks.calibrated, full_scale=full_scale)
        if level is not None:
            silent[window] = level < _SILENT_LEVEL
        else:
            silent[window] = level_dbfs is None or level_dbfs < _SILENT_LEVEL_DBFS
    return silent


_OF_FREQUENCY = (
    "high_period_strength", "high_period_rate", "period_strength", "period_rate", "high_blow_rate",
    "fundamental", "line_frequency", "line_count",
)  # fmt: skip

FREQUENCY_NAMES = (
    *(f"{kind}_{name}" for kind in ACOUSTIC_KINDS for name in _OF_FREQUENCY),
    "torque_fundamental", "torque_line_frequency",
)  # fmt: skip
"""Window features that give the frequency of a segment, a subset of `FEATURE_NAMES`."""

FREQUENCY_COLUMNS = [FEATURE_NAMES.index(name) for name in FREQUENCY_NAMES]
"""Columns of these features."""

_PERIODIC = 0.3
"""Minimum autocorrelation at which the period of an envelope is that of slips."""

_LEAST_BLOWS = math.log2(3.0 / 10.0)
"""Minimum rate of blows [octave re 10 Hz]."""

_COLUMN = {name: i for i, name in enumerate(FREQUENCY_NAMES)}
_DECLARED = {feature.name: feature for feature in WINDOW_FEATURES}


def segment_frequency(features: NDArray[np.float32], label: str) -> float | None:
    """Return the slip frequency of a creak or squawk, else the frequency of the strongest line.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the segment's windows, by `FREQUENCY_NAMES` [unit of each feature].
    label : str

    Returns
    -------
    float or None
        Frequency [Hz], of the torque if most windows have one; ``None`` for ``none``, and without
        a frequency in the windows.

    Examples
    --------
    >>> features = np.full((2, len(FREQUENCY_NAMES)), np.nan, dtype=np.float32)
    >>> features[:, FREQUENCY_NAMES.index("pressure_line_frequency")] = 1.0
    >>> features[:, FREQUENCY_NAMES.index("pressure_line_count")] = 1.0
    >>> segment_frequency(features, "squeal")
    2000.0
    """
    if label == "none":
        return None
    slips = label in ("creak", "squawk")
    torque = "torque_fundamental" if slips else "torque_line_frequency"
    known = np.isfinite(features[:, _COLUMN[torque]])
    if 2 * known.sum() > len(known):  # a frequency in few windows is by chance
        return _median(features, torque)
    for kind in ("pressure", "acceleration"):
        frequency = None
        if label == "creak":
            frequency = _blow_rate(features, kind)
        if slips and frequency is None:
            frequency = _frequency(features, kind, "fundamental")
        if frequency is None:
            counted = features[features[:, _COLUMN[f"{kind}_line_count"]] > 0]
            frequency = _frequency(counted, kind, "line_frequency")
        if frequency is not None:
            return frequency
    return None


def _blow_rate(features: NDArray[np.float32], kind: str) -> float | None:
    """Return the rate of blows of a creak [Hz], from their period if most windows have one."""
    for part in ("high_", ""):
        strength = features[:, _COLUMN[f"{kind}_{part}period_strength"]]
        periodic = features[strength > _PERIODIC]
        if 2 * len(periodic) > len(features):
            return _frequency(periodic, kind, f"{part}period_rate")
    rate = features[:, _COLUMN[f"{kind}_high_blow_rate"]]
    return _frequency(features[rate > _LEAST_BLOWS], kind, "high_blow_rate")


def _frequency(features: NDArray[np.float32], kind: str, name: str) -> float | None:
    """Return the median of a window feature in octaves, as a frequency [Hz]."""
    octave = _median(features, f"{kind}_{name}")
    return None if octave is None else _DECLARED[name].hertz(octave)


def _median(features: NDArray[np.float32], name: str) -> float | None:
    """Return the median of the finite values of a column, in the unit of the column."""
    values = features[:, _COLUMN[name]]
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else None
