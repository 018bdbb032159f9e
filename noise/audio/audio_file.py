"""WAV files for listening with a sidecar, written atomically."""

import json
import math
import zlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.recording import Recording
from noise.audio.gain import least_full_scale
from noise.audio.sound import pressure_channel
from noise.base.files import atomic
from noise.recordings.sidecar import sidecar_text
from noise.recordings.wav import largest_sample, wav_bytes, with_full_scale

_BITS = 24


def write_audio(
    path: str | Path,
    samples: NDArray[np.float64],
    rate: int,
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
    rate : int
        Sampling rate [Hz].
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
    ...     path = write_audio(Path(folder) / "tone", run["pressure"], 48000, full_scale=2.0,
    ...                        recording=run)
    ...     float(read_recording(path)["pressure"].max())
    0.25
    """
    target = audio_path(Path(path))
    if not 0.0 < full_scale < math.inf:
        raise ParameterError(f"{target}: full scale is {full_scale!r}, expected a positive number")
    if not np.abs(samples).max(initial=0.0) <= full_scale * largest_sample(_BITS):
        raise ParameterError(
            f"{target}: full scale {full_scale:g} would clip; the smallest that does not is "
            f"{least_full_scale(samples, _BITS):g}"
        )
    channel = replace(pressure_channel(recording), name="pressure")
    content = json.loads(
        sidecar_text(replace(recording, samples=np.empty((1, 0)), channels=(channel,)))
    )
    if recording.calibrated:
        content["channels"][0]["scale"] = full_scale
    description = with_full_scale(full_scale) if recording.calibrated else ""
    data = wav_bytes(samples / full_scale, rate, _BITS, description=description)
    content["wav_crc32"] = f"{zlib.crc32(data):08x}"
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
