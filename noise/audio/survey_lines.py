"""A survey as JSON can hold it, so that a set that was measured need not be measured again."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np

from features.kernels.levels import SoundLevels
from features.sound_quality import SoundQuality
from noise.audio.assessment import Assessment
from noise.audio.loudness import LoudnessBlocks
from noise.audio.rendering import Survey
from noise.audio.sequence import Part

__all__ = ["survey_line", "survey_of_line"]


def survey_line(of: Survey) -> dict[str, Any]:
    """Return what is known of a sound as JSON can hold it.

    Examples
    --------
    >>> of = Survey("a", True, 0.5, None, LoudnessBlocks(np.ones(2)), (Part("a", 0, 1),), (), ())
    >>> survey_of_line(survey_line(of)).parts
    (Part(name='a', start=0, end=1),)
    """
    blocks = None if of.blocks is None else of.blocks.powers.tolist()
    return {**asdict(replace(of, blocks=None)), "blocks": blocks}


def survey_of_line(line: dict[str, Any]) -> Survey:
    """Return the survey of a line."""
    return Survey(
        **line
        | {
            "blocks": None if line["blocks"] is None else LoudnessBlocks(np.array(line["blocks"])),
            "parts": tuple(Part(**one) for one in line["parts"]),
            "assessments": tuple(map(_assessment, line["assessments"])),
            "untold": tuple(line["untold"]),
        }
    )


def _assessment(line: dict[str, Any]) -> Assessment:
    quality = line["quality"]
    return Assessment(
        SoundLevels(**line["levels"]),
        line["calibrated"],
        None if quality is None else SoundQuality(**quality),
    )
