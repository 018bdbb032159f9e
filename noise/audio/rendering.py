"""Audio files of a set of recordings, whose gains belong together.

It takes two passes: first every sound is measured, then the gain is chosen that suits them all,
then each is written. What is kept between is a few numbers a sound, so that a set may be larger
than memory.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.audio.assessment import COLUMNS as LEVEL_COLUMNS, assess
from noise.audio.files import write_audio
from noise.audio.gain import (
    CEILING,
    matched_full_scale,
    true_peak,
)
from noise.audio.long_sound import AudibleSound
from noise.audio.loudness import LOUDNESS_BLOCK, LoudnessBlocks
from noise.audio.sequence import GAP, Part, back_to_back
from noise.audio.sound import FADE
from noise.recordings.sidecar import sidecar_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from models.recording import Recording
    from noise.audio.assessment import Assessment
    from noise.audio.long_sound import LongSound

__all__ = ["COLUMNS", "FullScale", "Rendered", "Survey", "render", "survey"]

COLUMNS = (
    *("part", "start_s", "end_s", "calibrated", "gain", "full_scale_Pa"),
    *("true_peak_dbtp", "loudness_lufs"),
    *LEVEL_COLUMNS,
)
"""Of the table of levels, one row a part of a file."""


@dataclass(frozen=True)
class Survey:
    """Peak, loudness and levels of a sound, measured before it is written.

    Parameters
    ----------
    name : str
    calibrated : bool
    true_peak : float
        [unit of the sound]
    loudness : float or None
        With the true peak at full scale [LUFS]; None where it was not asked for.
    blocks : LoudnessBlocks or None
        Of which the loudness at any gain follows; None of a sound too short for it.
    parts : tuple of Part
    assessments : tuple of Assessment
        One a part.
    untold : tuple of str
        Why the sound quality of a part is not told, though it was asked for.
    """

    name: str
    calibrated: bool
    true_peak: float
    loudness: float | None
    blocks: LoudnessBlocks | None
    parts: tuple[Part, ...]
    assessments: tuple[Assessment, ...]
    untold: tuple[str, ...]


@dataclass(frozen=True)
class FullScale:
    """A gain: value of a sample at full scale, how it was chosen, loudness aimed at [LUFS]."""

    value: float
    gain: str
    target: float | None = None


@dataclass(frozen=True)
class Rendered:
    """What was written: rows by `COLUMNS`, and a line about the file."""

    rows: list[dict[str, object]]
    summary: str


def survey(
    recordings: Sequence[Recording | AudibleSound],
    *,
    rate: int = 48000,
    gap: float = GAP,
    fade: float = FADE,
    quality: bool = False,
    loudness: bool = False,
) -> Survey:
    """Measure the sound that recordings make back to back.

    Parameters
    ----------
    recordings : sequence of Recording or AudibleSound
    rate, gap, fade
        As for `noise.audio.sequence.back_to_back`.
    quality : bool
        Whether its sound quality is told as well, where that can be.
    loudness : bool
        Whether it has to have a loudness.

    Raises
    ------
    ParameterError
        A recording has no sound, or with `loudness` none that can be matched.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> of = survey([Recording(tone, 48e3, (Channel("pressure"),), name="tone")])
    >>> of.calibrated, round(of.true_peak, 3)
    (True, 1.0)
    """
    takes = [AudibleSound.of(recording) for recording in recordings]
    joined = back_to_back(takes, rate, gap=gap, fade=fade)
    sound = joined.sound
    peak = true_peak(sound, rate)
    assessments, untold = [], []
    for take in takes:
        try:
            assessments.append(assess(take, quality=quality))
        except ParameterError as error:
            if not quality:
                raise
            assessments.append(assess(take))
            untold.append(f"{take.about.name}: {error}")
    first = takes[0].about
    blocks = LoudnessBlocks.of(sound) if sound.n_samples >= LOUDNESS_BLOCK * rate else None
    reached = None
    if loudness:
        reached = _loudness_at_full_scale(first.name, sound, blocks, peak)
    return Survey(
        first.name, first.calibrated, peak, reached, blocks, joined.parts, tuple(assessments),
        tuple(untold),
    )  # fmt: skip


def render(
    path: Path,
    recordings: Sequence[Recording | AudibleSound],
    of: Survey,
    full_scale: FullScale,
    *,
    rate: int = 48000,
    gap: float = GAP,
    fade: float = FADE,
    bits: int = 24,
    seed: int | Sequence[int] = 0,
    note: str | None = None,
) -> Rendered:
    """Write one file of a set.

    Parameters
    ----------
    path : Path
    recordings : sequence of Recording or AudibleSound
    of : Survey
        Of these recordings.
    full_scale : FullScale
    rate, gap, fade
        As in the survey.
    bits : int
        One of `noise.audio.wav.BITS`; 16 is dithered.
    seed : int or sequence of int
        Of the dither.
    note : str, optional
        For the sidecar: what the listener should know of the gain.

    Raises
    ------
    ParameterError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from models.recording import Channel, Recording
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> runs = [Recording(tone, 48e3, (Channel("pressure"),), name="tone")]
    >>> of = survey(runs)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     target = Path(folder) / "tone.wav"
    ...     render(target, runs, of, FullScale(2.0, "calibrated")).summary
    'true peak -6.0 dBTP, loudness -9.0 LUFS'
    """
    takes = [AudibleSound.of(recording) for recording in recordings]
    joined = back_to_back(takes, rate, gap=gap, fade=fade)
    value = full_scale.value
    if full_scale.target is not None and of.blocks is not None:
        # The gate of the loudness has moved with the gain.
        value = matched_full_scale(of.blocks, rate, full_scale.target, start=value)
        value = max(value, of.true_peak / CEILING)
    file: dict[str, object] = {
        "gain": full_scale.gain,
        "full_scale_Pa": value if of.calibrated else None,
        "true_peak_dbtp": _level(of.true_peak / value),
        "loudness_lufs": _loudness(of.blocks, value),
    }
    dithered = bits == 16
    entries = [
        {
            "name": part.name,
            "start_s": part.start,
            "end_s": part.end,
            "conditions": json.loads(sidecar_text(take.about))["conditions"],
            **({"notes": list(take.about.notes)} if take.about.notes else {}),
            **assessment.entry(value),
        }
        for part, take, assessment in zip(of.parts, takes, of.assessments, strict=True)
    ]
    made = {**file, "dither": "triangular" if dithered else None} | ({"note": note} if note else {})
    write_audio(
        path,
        joined.sound,
        rate,
        full_scale=value,
        bits=bits,
        recording=joined.recording,
        dither=np.random.default_rng(seed) if dithered else None,
        about={"render": made, "parts": entries},
    )
    rows = [
        {
            "part": part.name,
            "start_s": part.start,
            "end_s": part.end,
            "calibrated": of.calibrated,
            **file,
            **assessment.row(value),
        }
        for part, assessment in zip(of.parts, of.assessments, strict=True)
    ]
    return Rendered(rows, _summary(file))


def _loudness_at_full_scale(
    name: str, sound: LongSound, blocks: LoudnessBlocks | None, peak: float
) -> float:
    try:
        if peak == 0.0:
            raise ParameterError("a silent sound has no loudness to be matched")
        return (blocks or LoudnessBlocks.of(sound)).at(peak)  # which refuses what is too short
    except ParameterError as error:
        raise ParameterError(f"{name}: {error}") from None


def _loudness(blocks: LoudnessBlocks | None, full_scale: float) -> float | None:
    if blocks is None:
        return None
    reached = blocks.at(full_scale)
    return round(reached, 2) if math.isfinite(reached) else None


def _level(fraction: float) -> float | None:
    return round(20.0 * math.log10(fraction), 2) if fraction > 0.0 else None


def _summary(file: Mapping[str, object]) -> str:
    peak, reached = file["true_peak_dbtp"], file["loudness_lufs"]
    words = ["silent" if peak is None else f"true peak {peak:.1f} dBTP"]
    if reached is not None:
        words.append(f"loudness {reached:.1f} LUFS")
    return ", ".join(words)
