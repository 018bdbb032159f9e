"""Rendering of recordings as a set of audible WAV files with related gains.

It takes two passes: first every sound is measured, then the gain is chosen that suits them all,
then each is written. What is kept between is a few numbers a sound, so that a set may be larger
than memory. Recordings that are joined into one file, as A and B of a comparison, have one gain;
each is faded by itself, and there is silence between them.

What full scale is worth stands in the sidecar and in the file's own description, so that the WAV
stays calibrated when the sidecar is lost. (Floating-point samples have no other place for it, since
a sidecar's ``scale`` is for integers.)
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError
from models.recording import Recording
from noise.audio.assessment import COLUMNS as LEVEL_COLUMNS, Assessment, assess
from noise.audio.gain import (
    CEILING,
    LOUDNESS_BLOCK,
    QUIETEST_FULL_SCALE,
    common_full_scale,
    full_scale_without_clipping,
    loudness,
    matched_full_scale,
    matched_loudness,
    true_peak,
)
from noise.audio.sound import GAP, RATE, joined, pressure_channel, refuse_mixed
from noise.base.files import atomic
from noise.recordings.sidecar import sidecar_text
from noise.recordings.wav import largest_sample, wav_bytes, with_full_scale

COLUMNS = (
    *("part", "start_s", "end_s", "calibrated", "gain", "full_scale_Pa"),
    *("true_peak_dbtp", "loudness_lufs"),
    *LEVEL_COLUMNS,
)
"""Of the table of levels, one row per part of a file."""


@dataclass(frozen=True, eq=False)
class Part:
    """Recording within a sound file.

    Parameters
    ----------
    start, end : float
        [s]
    about : Recording
        What is known of it, without samples.
    assessment : Assessment
    """

    start: float
    end: float
    about: Recording
    assessment: Assessment


@dataclass(frozen=True, eq=False)
class Measured:
    """Peak, loudness and levels of a sound before writing.

    Parameters
    ----------
    parts : tuple of Part
    true_peak : float
        [unit of the sound]
    loudness : float or None
        With the true peak at full scale [LUFS]; None where it was not asked for.
    """

    parts: tuple[Part, ...]
    true_peak: float
    loudness: float | None

    @property
    def name(self) -> str:
        """Name of its first recording."""
        return self.parts[0].about.name

    @property
    def calibrated(self) -> bool:
        """Whether its samples are in pascals."""
        return self.parts[0].about.calibrated


@dataclass(frozen=True)
class FullScale:
    """Gain: value of a full-scale sample, method, and target loudness [LUFS]."""

    value: float
    gain: str
    target: float | None = None


def measure(recordings: Sequence[Recording], *, gap: float = GAP, match: bool = False) -> Measured:
    """Measure the concatenated sound of recordings.

    Parameters
    ----------
    recordings : sequence of Recording
    gap : float
        As for `joined`.
    match : bool
        Whether it has to have a loudness.

    Raises
    ------
    ParameterError
        A recording has no sound, or with `match` no loudness.

    Examples
    --------
    >>> from models.recording import Channel
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> of = measure([Recording(tone, 48e3, (Channel("pressure"),), name="tone")])
    >>> of.calibrated, round(of.true_peak, 3)
    (True, 1.0)
    """
    samples, times = joined(recordings, gap=gap)
    peak = true_peak(samples, RATE)
    parts = [
        Part(start, end, replace(recording, samples=np.empty((1, 0))), assess(recording))
        for recording, (start, end) in zip(recordings, times, strict=True)
    ]
    reached = None
    if match:
        try:
            if peak == 0.0:
                raise ParameterError("a silent sound has no loudness to be matched")
            reached = loudness(samples / peak, RATE)
        except ParameterError as error:
            raise ParameterError(f"{recordings[0].name}: {error}") from None
    return Measured(tuple(parts), peak, reached)


def full_scales(
    sounds: Mapping[str, Measured], *, pascal: float | None = None, matched: bool = False
) -> dict[str, FullScale]:
    """Choose the gain of the sounds of a set.

    Parameters
    ----------
    sounds : mapping of str to Measured
    pascal : float, optional
        Sound pressure at full scale [Pa] for all of them.
    matched : bool
        Whether all get the same loudness. Without either they have one full scale in common.

    Raises
    ------
    ParameterError
        A sound would clip at `pascal` or is not calibrated, or a common gain would mean nothing.

    Examples
    --------
    >>> full_scales({}, matched=True)
    {}
    """
    if not sounds:
        return {}
    if matched:
        loudest = {name: of.loudness for name, of in sounds.items() if of.loudness is not None}
        target = matched_loudness(list(loudest.values()))
        return {
            name: FullScale(
                sounds[name].true_peak * 10.0 ** ((value - target) / 20.0), "matched", target
            )
            for name, value in loudest.items()
        }
    known = {of.calibrated: of.name for of in sounds.values()}
    if pascal is not None:
        if False in known:
            raise ParameterError(
                f"--pascal-per-full-scale needs a calibrated input, and {known[False]} is not; "
                "--full-scale or --calibrator gives its calibration"
            )
        loud = max(sounds.values(), key=lambda of: of.true_peak)
        if loud.true_peak > CEILING * pascal:
            raise ParameterError(
                f"--pascal-per-full-scale {pascal:g} would clip {loud.name}; the smallest that "
                f"does not is {full_scale_without_clipping(loud.true_peak):g}"
            )
        return dict.fromkeys(sounds, FullScale(pascal, "calibrated"))
    refuse_mixed(known, "--full-scale gives a calibration, --match-loudness needs none")
    value = common_full_scale([np.array([of.true_peak]) for of in sounds.values()])
    if True in known:  # so that silence is not made loud
        value = max(value, QUIETEST_FULL_SCALE)
    return dict.fromkeys(sounds, FullScale(value, "common"))


def render(
    path: Path,
    recordings: Sequence[Recording],
    of: Measured,
    full_scale: FullScale,
    *,
    gap: float = GAP,
) -> tuple[list[dict[str, object]], str]:
    """Write one file of a set.

    Parameters
    ----------
    path : Path
    recordings : sequence of Recording
        Of one channel each, as `heard` returns them.
    of : Measured
        Of these recordings.
    full_scale : FullScale
    gap : float
        Silence between two recordings [s].

    Returns
    -------
    rows : list of dict
        By `COLUMNS`, one a part.
    summary : str
        A line about the file.

    Raises
    ------
    ParameterError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> runs = [Recording(tone, 48e3, (Channel("pressure"),), name="tone")]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     target = Path(folder) / "tone.wav"
    ...     render(target, runs, measure(runs), FullScale(2.0, "calibrated"))[1]
    'true peak -6.0 dBTP, loudness -9.0 LUFS'
    """
    samples, _ = joined(recordings, gap=gap)
    value = full_scale.value
    if full_scale.target is not None:
        # The gate of the loudness moves with the gain.
        value = matched_full_scale(samples, RATE, full_scale.target)
        value = max(value, of.true_peak / CEILING)
    long_enough = samples.size >= LOUDNESS_BLOCK * RATE
    reached = loudness(samples / value, RATE) if long_enough else -math.inf
    peak = of.true_peak / value
    file: dict[str, object] = {
        "gain": full_scale.gain,
        "full_scale_Pa": value if of.calibrated else None,
        "true_peak_dbtp": round(20.0 * math.log10(peak), 2) if peak > 0.0 else None,
        "loudness_lufs": round(reached, 2) if math.isfinite(reached) else None,
    }
    write_audio(
        path,
        samples,
        full_scale=value,
        recording=_common([part.about for part in of.parts]),
        about={"render": file, "parts": [_entry(part, value) for part in of.parts]},
    )
    rows = [
        {"part": part.about.name, "start_s": part.start, "end_s": part.end,
         "calibrated": of.calibrated, **file, **part.assessment.row(value)}
        for part in of.parts
    ]  # fmt: skip
    summary = "silent" if peak == 0.0 else f"true peak {20.0 * math.log10(peak):.1f} dBTP"
    if math.isfinite(reached):
        summary += f", loudness {reached:.1f} LUFS"
    return rows, summary


def _entry(part: Part, full_scale: float) -> dict[str, object]:
    """Return the sidecar entry of a part."""
    about = part.about
    return {
        "name": about.name,
        "start_s": part.start,
        "end_s": part.end,
        "conditions": json.loads(sidecar_text(about))["conditions"],
        **({"notes": list(about.notes)} if about.notes else {}),
        **part.assessment.entry(full_scale),
    }


def _common(recordings: Sequence[Recording]) -> Recording:
    """Return the common metadata of recordings, without samples."""
    conditions = [recording.condition for recording in recordings]
    values = {one.name: {getattr(c, one.name) for c in conditions} for one in fields(Condition)}
    shared: dict[str, Any] = {name: of.pop() for name, of in values.items() if len(of) == 1}
    return replace(recordings[0], condition=Condition(**shared), notes=())


_BITS = 24


def write_audio(
    path: str | Path,
    samples: NDArray[np.float64],
    *,
    full_scale: float,
    recording: Recording,
    about: Mapping[str, object] | None = None,
) -> Path:
    """Write a WAV file for listening and its sidecar, atomically.

    Parameters
    ----------
    path : path-like
        ``squeal`` and ``squeal.wav`` are the same; parent folders are made.
    samples : ndarray, shape (n_samples,)
        As `noise.audio.sound.audible` gives them.
    full_scale : float
        Value of a full-scale sample, in the unit of `samples`.
    recording : Recording
        Where the sound comes from: its condition, microphone and calibration go into the sidecar.
    about : mapping of str to object, optional
        What else the sidecar says, as JSON has it.

    Returns
    -------
    Path
        The WAV file. `noise.recordings.read_recording` reads it back calibrated, if the recording
        was.

    Raises
    ------
    ParameterError
        A sample would clip, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel
    >>> from noise.recordings import read_recording
    >>> run = Recording(np.full((1, 480), 0.25), 48e3, (Channel("pressure"),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_audio(Path(folder) / "tone", run["pressure"], full_scale=2.0,
    ...                        recording=run)
    ...     float(read_recording(path)["pressure"].max())
    0.25
    """
    target = audio_path(Path(path))
    if not 0.0 < full_scale < math.inf:
        raise ParameterError(f"{target}: full scale is {full_scale!r}, expected a positive number")
    if not np.abs(samples).max(initial=0.0) <= full_scale * largest_sample(_BITS):
        raise ParameterError(f"{target}: a sample would clip at full scale {full_scale:g}")
    channel = replace(pressure_channel(recording), name="pressure")
    content = json.loads(
        sidecar_text(replace(recording, samples=np.empty((1, 0)), channels=(channel,)))
    )
    if recording.calibrated:
        content["channels"][0]["scale"] = full_scale
    description = with_full_scale(full_scale) if recording.calibrated else ""
    data = wav_bytes(samples / full_scale, RATE, _BITS, description=description)
    text = json.dumps(content | dict(about or {}), indent=1) + "\n"
    with atomic(target) as wav, atomic(target.with_suffix(".json")) as sidecar:
        wav.write_bytes(data)
        sidecar.write_text(text, encoding="utf-8")
    return target


def audio_path(path: Path) -> Path:
    """Return the path with the ending ``.wav``, added where it is missing.

    Examples
    --------
    >>> audio_path(Path("run0.5")).name, audio_path(Path("run.WAV")).name
    ('run0.5.wav', 'run.WAV')
    """
    return path if path.suffix.lower() == ".wav" else path.with_name(path.name + ".wav")
