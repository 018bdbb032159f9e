"""Segments of a recording with one label each, from classified windows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from models.blocks import RecordingBlocks
from models.recording import Recording
from models.show import short_repr
from noise.base.labels import LABELS
from noise.classifier import Classifier
from noise.labels.classified import at_a_condition, classified, segment_frequency
from noise.labels.levels import CELL_RATE, cell_edges, with_levels
from noise.labels.segmentation import change_points, labelled_stretches
from noise.labels.windows import has_window_channel, tracks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame


_MOST_SHOWN = 4
"""Maximum number of segments in the printed form."""


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


class Segments(list[Segment]):
    """List of the labelled segments of a recording, in order of time, track by track.

    Examples
    --------
    >>> segments = Segments([Segment("all", 0.0, 1.0, "creak", {"creak": 0.9}, 152.0, 78.0, None)])
    >>> segments
    Segments(1: creak 0 to 1 s)
    """

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the labels over time, one row per track.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There are no segments.
        """
        from noise.labels.table import draw_tracks

        tracks: dict[str, list[tuple[float, float, str]]] = {}
        for one in self:
            tracks.setdefault(one.channel, []).append((one.start, one.end, one.label))
        return draw_tracks(tracks, ax)

    def to_pandas(self) -> DataFrame:
        """Return a pandas data frame with one row per segment, in the columns of a label table.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        ParameterError
            pandas is not installed.
        """
        from models.show import data_frame
        from noise.labels.rows import segment_cells
        from noise.labels.table import SEGMENT_COLUMNS

        return data_frame(SEGMENT_COLUMNS, map(segment_cells, self))

    def __repr__(self) -> str:
        shown = [f"{one.label} {one.start:.4g} to {one.end:.4g} s" for one in self[:_MOST_SHOWN]]
        more = ["..."] * (len(self) > _MOST_SHOWN)
        return f"Segments({len(self)}: {', '.join(shown + more)})"


def label_recording(
    recording: Recording | RecordingBlocks,
    classifier: Classifier,
    *,
    per_track: bool = False,
    surroundings: str | None = None,
) -> Segments:
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
    Segments
        List of `Segment`, in order of time, without gaps, track by track.

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
    return Segments(
        segment
        for name, track in described
        for segment in with_levels(track, _label(track, classifier, name, surroundings))
    )


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
