"""Loudness N5 of the segments of a recording, by the library that the field keeps for it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from features.sound_quality import SHORTEST, SOUND_QUALITY_RATE, loudness_n5
from noise.audio.sound import resampled
from noise.labels.segments import Segments

if TYPE_CHECKING:
    from collections.abc import Sequence

    from noise.labels.segments import Segment
    from noise.recordings.blocks import RecordingBlocks

__all__ = ["with_loudness"]

_LONGEST = 600.0
"""Longest segment that is analysed [s]: a second of sound takes a second."""


def with_loudness(blocks: RecordingBlocks, segments: Sequence[Segment]) -> Segments:
    """Add the loudness of segments, as `noise.audio.assessment.assess` tells it of such a sound.

    Parameters
    ----------
    blocks : RecordingBlocks
        The whole recording; where it is not calibrated or has no sound, nothing is added.
    segments : sequence of Segment

    Returns
    -------
    Segments

    Raises
    ------
    ParameterError
        The extra ``sound-quality`` is not installed.
    """
    return Segments(_with_loudness(blocks, segment) for segment in segments)


def _with_loudness(blocks: RecordingBlocks, segment: Segment) -> Segment:
    track = blocks if segment.channel == "all" else blocks.track(int(segment.channel) - 1)
    row = track.first("pressure")
    first = round(segment.start * track.rate)
    last = min(round(segment.end * track.rate), track.n_samples)
    seconds = (last - first) / track.rate
    if row is None or not track.calibrated or not SHORTEST <= seconds <= _LONGEST:
        return segment
    sound = track.read(first, last)[row]
    at_rate = resampled(sound - sound.mean(), track.rate, SOUND_QUALITY_RATE)
    return replace(segment, loudness_n5=loudness_n5(at_rate, SOUND_QUALITY_RATE))
