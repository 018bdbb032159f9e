"""Sound files (WAV, FLAC, AIFF, OGG, MP3) as raw samples.

The sound library stops quietly where a file breaks off. A measurement cut short is not the
measurement, so the samples announced are counted against the samples found. Samples are copied
block by block into the one array that is returned, so that reading takes the memory of the result
and no more; but for MP3, which the library does not join without a click between two blocks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import soundfile

from models.errors import RecordingError
from noise.recordings.formats.bext import bext_description, missing_bytes
from noise.recordings.readers import RawSamples

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["read_sound_file"]

_BLOCK = 1 << 16  # samples a channel
_DENSEST = 8192  # samples a byte; FLAC holds silence in about 10 bytes a block of 65535 samples


def read_sound_file(path: Path) -> RawSamples:
    """Read all samples of a sound file.

    Parameters
    ----------
    path : Path
        An existing file.

    Returns
    -------
    RawSamples

    Raises
    ------
    RecordingError
        The file is no sound file, is damaged, or ends before its header says.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "tone.flac"
    ...     soundfile.write(path, np.full(480, 0.5), 48000)
    ...     raw = read_sound_file(path)
    >>> raw.samples.shape, raw.rate, raw.fractional, float(raw.samples[0, 0])
    ((1, 480), 48000.0, True, 0.5)
    """
    if missing := missing_bytes(path):
        raise RecordingError(
            f"{path}: is truncated; its header announces {missing} bytes of samples more than "
            f"there are"
        )
    try:
        with soundfile.SoundFile(path) as sound:
            return RawSamples(
                samples=_samples(path, sound),
                rate=float(sound.samplerate),
                fractional=sound.subtype not in ("FLOAT", "DOUBLE"),
                description=bext_description(path),
                comment=sound.comment,
            )
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{path}: is damaged or no sound file ({reason})") from error


def _samples(path: Path, sound: Any) -> NDArray[np.float64]:
    announced = int(sound.frames)
    if announced > _DENSEST * path.stat().st_size:
        raise RecordingError(
            f"{path}: its header announces {announced} samples, more than a file of this size holds"
        )
    samples = np.empty((int(sound.channels), announced))
    size = announced if sound.format == "MP3" else _BLOCK
    read = 0
    while len(block := sound.read(size, dtype="float64", always_2d=True)):
        samples[:, read : read + len(block)] = block.T
        read += len(block)
    if read < announced:
        raise RecordingError(
            f"{path}: is truncated; its header announces {announced} samples, {read} can be read"
        )
    return samples
