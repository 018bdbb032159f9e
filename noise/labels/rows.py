"""Rows of the label table: segments with the operating condition of the recording.

Logged conditions are used as they are. Conditions that are not logged, except the material, are
inferred from noises, with an interval of 90 %. The intervals hold for a fluorocarbon bushing like
the shipped one, so recordings of other materials, and sounds without a sign of a rig, have none.

Segments drawn by a person are measured as those of the classifier.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.recording import Recording, RecordingBlocks
from noise.base.labels import NAMED
from noise.inference import Inference, Interval
from noise.labels.levels import with_levels
from noise.labels.segments import FREQUENCY_COLUMNS, Segment, segment_frequency
from noise.labels.summary import ASSUMED, assumes_material
from noise.labels.table import COLUMNS, CONDITIONS, HUMAN
from noise.labels.windows import has_window_channel, tracks, window_features
from noise.recordings.files import names_channels, open_blocks
from noise.recordings.rotation import agrees, as_logged

_SHORTEST = 0.1
"""Duration up to which the label of a segment is not reliable [s]: a segment is up to 0.02 s longer
than its sound, and squeals of the rig are labelled correctly from 0.1 s on."""

_DIGITS = 4
"""Significant digits of inferred values, more than their precision."""


def labelled_tracks(path: Path, n_channels: int) -> list[str]:
    """Return the tracks of a recording that are labelled separately, by the column ``channel``.

    Examples
    --------
    >>> from pathlib import Path
    >>> labelled_tracks(Path("stereo.wav"), 2), labelled_tracks(Path("mono.wav"), 1)
    (['1', '2'], ['all'])
    """
    several = n_channels > 1 and not names_channels(path)
    return [str(number + 1) for number in range(n_channels)] if several else ["all"]


def label_rows(
    name: str,
    recording: Recording | RecordingBlocks,
    segments: list[Segment],
    inference: Inference | None = None,
) -> list[dict[str, object]]:
    """Return one row of the label table per segment.

    Parameters
    ----------
    name : str
        File name, relative to the named folder.
    recording : Recording or RecordingBlocks
        If the speed of the shaft was recorded, each segment has its mean speed.
    segments : list of Segment
    inference : Inference, optional
        Model that infers conditions; by default the shipped one.

    Returns
    -------
    list of dict
        By `COLUMNS`; the source of a condition is ``logged``, ``inferred`` or ``missing``, and an
        inferred condition has bounds. An inferred speed is a magnitude. The support stiffness of
        the bolted clamp is ``inf``.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.base.labels import LABELS
    >>> turning = Recording(np.array([[0.0, 1.0, 2.0, 3.0]]), 2.0, (Channel("angle"),))
    >>> part = Segment("all", 0.0, 2.0, "none", dict.fromkeys(LABELS, 0.2), None, None, None)
    >>> row, = label_rows("run07.wav", turning, [part])
    >>> row["speed_rad_s"], row["speed_rad_s_source"], row["material_source"]
    (2.0, 'logged', 'missing')
    """
    blocks = RecordingBlocks.of(recording)
    return [_row(name, blocks, segment, inference) for segment in segments]


def _row(
    name: str, blocks: RecordingBlocks, segment: Segment, inference: Inference | None
) -> dict[str, object]:
    speed = segment_speed(blocks, segment.start, segment.end)
    condition = replace(blocks.condition, speed=speed)
    row: dict[str, object] = {
        **dict.fromkeys(COLUMNS),
        "file": name,
        "channel": segment.channel,
        "start_s": round(segment.start, 6),
        "end_s": round(segment.end, 6),
        "label": segment.label,
        **{f"p_{label}": round(p, 6) for label, p in segment.probabilities.items()},
        "frequency_hz": _rounded(segment.frequency, 2),
        "level_db": _rounded(segment.level, 2),
        "level_dba": _rounded(segment.level_a, 2),
        "l_afmax_dba": _rounded(segment.level_af_max, 2),
        "snr_dba": _rounded(segment.snr, 2),
        "level_dbfs": _rounded(segment.level_dbfs, 2),
        "calibrated": blocks.calibrated,
        "material": condition.material,
        "material_source": "logged" if condition.material else "missing",
        "label_source": "classifier",
    }
    inferred = _inferred(blocks, segment, condition, inference)
    for column, field in CONDITIONS.items():
        value = _in_unit(column, getattr(condition, field))
        row[column] = value
        row[f"{column}_source"] = "missing" if value is None else "logged"
        if value is None and field in inferred:
            interval = inferred[field]
            row[column] = _inferred_in_unit(column, interval.value)
            row[f"{column}_low"] = _inferred_in_unit(column, interval.low)
            row[f"{column}_high"] = _inferred_in_unit(column, interval.high)
            row[f"{column}_source"] = "inferred"
    assumed = f"conditions inferred {ASSUMED}" if assumes_material(row) else ""
    short = (
        f"no longer than {_SHORTEST:g} s: its name is not to be trusted"
        if segment.label in NAMED and round(segment.end - segment.start, 3) <= _SHORTEST
        else ""
    )
    remarks = [text for text in (speed_remark(blocks, speed), assumed, short) if text]
    row["note"] = "; ".join(remarks) or None
    return row


def _inferred(
    blocks: RecordingBlocks, segment: Segment, logged: Condition, inference: Inference | None
) -> dict[str, Interval]:
    """Return inferred conditions of a noise that are not logged."""
    unknown = any(getattr(logged, field) is None for field in CONDITIONS.values())
    if not unknown or segment.label not in NAMED:
        return {}
    # A named model states the rig of the recordings.
    if inference is None and not _is_of_a_rig(blocks):
        return {}
    from noise.inference import infer_stretch, load_inference

    if segment.channel != "all":
        blocks = blocks.track(int(segment.channel) - 1)
    first = round(segment.start * blocks.rate)
    last = min(round(segment.end * blocks.rate), blocks.n_samples)
    return infer_stretch(blocks, first, last, logged, inference or load_inference())


def _is_of_a_rig(blocks: RecordingBlocks) -> bool:
    """Whether a recording is of a rig: it has another channel than pressure, or a condition.

    A calibration is no sign of a rig.
    """
    at = blocks.condition
    stated = (at.material, at.speed, at.interference, at.support_stiffness)
    others = any(channel.kind != "pressure" for channel in blocks.channels)
    return others or any(value is not None for value in stated)


def _in_unit(column: str, value: float | None) -> float | None:
    """Return a value in the unit of its column."""
    return _rounded(1e3 * value if value is not None and column.endswith("_mm") else value, 6)


def _inferred_in_unit(column: str, value: float) -> float | None:
    """Return an inferred value in the unit of its column, rounded: 3745, not 3744.9998."""
    number = _in_unit(column, value)
    return None if number is None else float(f"{number:.{_DIGITS}g}")


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None or math.isnan(value) else round(value, digits)


_SPEED_BLOCK = 0.02
"""Duration of the means of the angle whose differences give the speed [s]."""

_BLOCKS_AT_ONCE = 500
"""Means per block of samples that is read."""


def segment_speed(blocks: RecordingBlocks, start: float, end: float) -> float | None:
    """Return the mean speed of the shaft in a segment, measured or else as logged.

    For an oscillating shaft, the mean magnitude.

    Parameters
    ----------
    blocks : RecordingBlocks
    start, end : float
        Times of the segment [s].

    Returns
    -------
    float or None
        [rad/s]

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> from models.recording import RecordingBlocks
    >>> angle = 4.999989 * np.arange(2000)[None] / 1e3
    >>> run = Recording(angle, 1e3, (Channel("angle"),), Condition(speed=5.0))
    >>> segment_speed(RecordingBlocks.of(run), 0.0, 2.0)
    5.0
    """
    logged, measured = blocks.condition.speed, _measured_speed(blocks, start, end)
    return logged if measured is None else as_logged(measured, logged)


def speed_remark(blocks: RecordingBlocks, speed: float | None) -> str:
    """Return a remark if the speed of a segment differs from the logged speed, else an empty text.

    Parameters
    ----------
    blocks : RecordingBlocks
    speed : float or None
        From `segment_speed` [rad/s].

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> from models.recording import RecordingBlocks
    >>> run = Recording(np.zeros((1, 9)), 1e3, (Channel("angle"),), Condition(speed=5.0))
    >>> speed_remark(RecordingBlocks.of(run), 10.0)
    'speed 10 rad/s is that of the channel angle; 5 was logged'
    """
    logged = blocks.condition.speed
    if logged is None or speed is None or agrees(speed, logged):
        return ""
    channel = "angle" if blocks.first("speed") is None else "speed"
    return f"speed {speed:g} rad/s is that of the channel {channel}; {logged:g} was logged"


def _measured_speed(blocks: RecordingBlocks, start: float, end: float) -> float | None:
    """Return the mean speed from the channels [rad/s]; None without a suitable channel."""
    first = round(start * blocks.rate)
    last = min(round(end * blocks.rate), blocks.n_samples)
    block = max(1, round(_SPEED_BLOCK * blocks.rate))
    pieces = blocks.pieces(first, last, _BLOCKS_AT_ONCE * block)
    speed, angle = blocks.first("speed"), blocks.first("angle")
    if not blocks.calibrated:
        return None
    if speed is not None:
        return _mean_speed(piece.samples[speed] for piece in pieces)
    if angle is None or last - first <= block:
        return None
    if last - first < 3 * block:
        time = np.arange(last - first) / blocks.rate
        return float(np.polyfit(time, blocks.read(first, last)[angle], 1)[0])
    # Differences of means, because differences of samples would be dominated by noise.
    means = [_block_means(piece.samples[angle], block) for piece in pieces]
    return _mean_speed([np.diff(np.concatenate(means)) * blocks.rate / block])


def _block_means(signal: NDArray[np.float64], block: int) -> NDArray[np.float64]:
    whole = signal[: signal.size // block * block].reshape(-1, block)
    return np.asarray(whole.mean(axis=1))


def _mean_speed(pieces: Iterable[NDArray[np.float64]]) -> float:
    n, total, travelled = 0, 0.0, 0.0
    for speed in pieces:
        n += speed.size
        total += float(np.sum(speed))
        travelled += float(np.sum(np.abs(speed)))
    mean, magnitude = total / n, travelled / n
    return mean if abs(mean) > 0.9 * magnitude else magnitude


LONGEST_MEASURED = 120.0
"""Maximum duration to be measured at once [s]; in longer recordings, only new segments are."""


def human_rows(
    path: Path,
    name: str,
    segments: Sequence[tuple[str, float, float, str]],
    full_scale: float | None = None,
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
    full_scale : float, optional
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
