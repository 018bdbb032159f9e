"""Rows of the label table for segments drawn by a person, measured as by `label`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from models.blocks import RecordingBlocks
from noise.labels.classified import FREQUENCY_COLUMNS, segment_frequency
from noise.labels.levels import with_levels
from noise.labels.rows import label_rows
from noise.labels.segments import Segment
from noise.labels.table import HUMAN
from noise.labels.windows import has_window_channel, tracks, window_features
from noise.recordings.files import names_channels, open_blocks
from noise.recordings.interpretation import PascalPerFullScale

LONGEST_MEASURED = 120.0
"""Maximum duration to be measured at once [s]; in longer recordings, only new segments are."""


def human_rows(
    path: Path,
    name: str,
    segments: Sequence[tuple[str, float, float, str]],
    full_scale: PascalPerFullScale | None = None,
    new: Sequence[tuple[str, float, float, str]] | None = None,
) -> list[dict[str, object]]:
    """Return the rows of the label table for segments drawn by a person.

    Parameters
    ----------
    path : Path
    name : str
        File as the table names it.
    segments : sequence of (str, float, float, str)
        Channel, start [s], end [s] and label of all segments.
    full_scale : float or tuple of float, optional
        Sound pressure of a full-scale sample [Pa], for sound files without a calibration.
    new : sequence of (str, float, float, str), optional
        Segments [s], as in `segments`, to be measured if the recording is longer than
        `LONGEST_MEASURED`, the shortest up to that total; by default all segments.

    Returns
    -------
    list of dict
        By `noise.labels.table.COLUMNS`, without probabilities. Segments that are not measured, of
        a missing channel or beyond the end are left out. Unless all are measured, none has a level
        over the background, which is that of the whole recording.

    Raises
    ------
    RecordingError
        The recording cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> tone = np.sin(2.0 * np.pi * 800.0 * np.arange(32_000) / 16_000.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = Recording(tone[None], 16_000.0, (Channel("pressure"),))
    ...     path = write_recording(Path(folder) / "run07", run)
    ...     (row,) = human_rows(path, "run07.wav", [("all", 0.5, 1.5, "squeal")])
    >>> round(row["frequency_hz"], -1), row["level_db"], row["label_source"], row["p_squeal"]
    (800.0, 90.97, 'human', None)
    """
    with open_blocks(path, full_scale=full_scale) as recording:
        whole = recording.n_samples <= LONGEST_MEASURED * recording.rate
        if not whole:
            segments = _as_many_as_fit(segments if new is None else new)
        measured = [
            segment
            for channel, track in tracks(recording, per_track=not names_channels(path))
            for segment in with_levels(track, _measured(track, channel, segments))
        ]
        if not whole:
            measured = [replace(segment, snr=None) for segment in measured]
        rows = label_rows(name, recording, measured)
        return [row | {"label_source": HUMAN} for row in rows]


def _as_many_as_fit(
    segments: Sequence[tuple[str, float, float, str]],
) -> list[tuple[str, float, float, str]]:
    """Return the shortest segments, up to `LONGEST_MEASURED` in total, in order of time."""
    fit, left = [], LONGEST_MEASURED
    for segment in sorted(segments, key=lambda one: one[2] - one[1]):
        left -= segment[2] - segment[1]
        if left >= 0.0:
            fit.append(segment)
    return sorted(fit)


def _measured(
    track: RecordingBlocks, channel: str, segments: Sequence[tuple[str, float, float, str]]
) -> list[Segment]:
    measured = []
    for at, start, end, label in segments:
        first, last = round(start * track.rate), min(round(end * track.rate), track.n_samples)
        if at != channel or last - first < 2:
            continue
        blocks = RecordingBlocks.of(track.cut(first, last))
        frequency = None
        if has_window_channel(blocks):
            features = window_features(blocks).features
            frequency = segment_frequency(features[:, FREQUENCY_COLUMNS], label)
        measured.append(Segment(channel, start, end, label, {}, frequency))
    return measured
