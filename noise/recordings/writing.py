"""Writing recordings as 32-bit float WAV with a sidecar, whole ones and those that grow by blocks.

A run too long for memory comes block by block. The header says at once how long the file will be,
so what arrives must be just as much; until it has, nothing stands under the file's own name.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.base.files import atomic
from noise.recordings.files import MIN_SAMPLES
from noise.recordings.formats import formats
from noise.recordings.sidecar import sidecar_text
from noise.recordings.wav import wav_header

_BLOCK = 1 << 16  # samples a channel


def write_recording(path: str | os.PathLike[str], recording: Recording) -> Path:
    """Write a recording as 32-bit float WAV with its sidecar, both whole or not at all.

    Parameters
    ----------
    path : path-like
        ``run07`` and ``run07.wav`` are the same; parent folders are made.
    recording : Recording
        Its samples are written as they are, so full scale of the file written is one unit.

    Returns
    -------
    Path
        The WAV file.

    Raises
    ------
    ParameterError
        The recording cannot be written there, or could not be read back.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> silence = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = write_recording(Path(folder) / "runs" / "none", silence)
    ...     sorted(file.name for file in Path(folder).glob("runs/*"))
    ['none.json', 'none.wav']
    """
    samples = recording.samples
    n_samples = samples.shape[1]
    blocks = (samples[:, at : at + _BLOCK] for at in range(0, n_samples, _BLOCK))
    return _write(_wav_path(Path(path)), recording, blocks, n_samples)


def write_blocks(
    path: str | os.PathLike[str],
    blocks: Iterable[NDArray[np.float64]],
    *,
    n_samples: int,
    rate: float,
    channels: tuple[Channel, ...],
    condition: Condition,
    notes: tuple[str, ...] = (),
    found: Callable[[], tuple[str, ...]] = tuple,
) -> Path:
    """Write blocks as one 32-bit float WAV with its sidecar, both whole or not at all.

    Parameters
    ----------
    path : path-like
        ``run07`` and ``run07.wav`` are the same; parent folders are made.
    blocks : iterable of ndarray, shape (n_channels, n)
        [units of the channels]
    n_samples : int
        Of all blocks together.
    rate : float
        Sampling rate, a whole number [Hz].
    channels : tuple of Channel
    condition : Condition
    notes : tuple of str
        For the sidecar.
    found : callable, optional
        Gives further ones, when all blocks have been written.

    Returns
    -------
    Path
        The WAV file.

    Raises
    ------
    ParameterError
        The recording cannot be written there or could not be read back, or the blocks hold
        another number of samples.

    Examples
    --------
    >>> import tempfile
    >>> from models.condition import Condition
    >>> from models.recording import Channel
    >>> from noise.recordings import read_recording
    >>> halves = (np.full((1, 400), value) for value in (20.0, 30.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_blocks(
    ...         Path(folder) / "run07", halves, n_samples=800, rate=30e3,
    ...         channels=(Channel("torque"),), condition=Condition(speed=5.0),
    ...     )
    ...     float(read_recording(path)["torque"].mean())
    25.0
    """
    target = _wav_path(Path(path))
    empty = np.zeros((len(channels), 0))
    about = Recording(empty, rate, channels, condition, name=target.name, notes=notes)
    return _write(target, about, blocks, n_samples, found)


def _write(
    target: Path,
    about: Recording,
    blocks: Iterable[NDArray[np.float64]],
    n_samples: int,
    found: Callable[[], tuple[str, ...]] = tuple,
) -> Path:
    """Write blocks of samples; of `about` all else counts."""
    rate = about.rate
    if n_samples < MIN_SAMPLES:
        raise ParameterError(f"{target}: {n_samples} samples, expected at least {MIN_SAMPLES}")
    if not (1 <= rate < 1 << 31 and float(rate).is_integer()):
        raise ParameterError(
            f"{target}: the sampling rate is {rate!r} Hz, but WAV holds whole hertz only"
        )
    sidecar_text(about)  # refuses what could not be read back
    try:
        header = wav_header(n_samples, int(rate), 32, n_channels=len(about.channels))
    except ParameterError as error:
        raise ParameterError(f"{target}: {error}") from error
    # The sidecar is moved into place first: samples are never seen without what they mean. Its
    # checksum tells that it belongs to others, should the call end between the two.
    with atomic(target) as wav, atomic(target.with_suffix(".json")) as sidecar:
        with wav.open("wb") as file:
            file.write(header)
            checksum, written = zlib.crc32(header), 0
            for block in blocks:
                data = _frames(target, block, about.channels).tobytes()
                file.write(data)
                checksum = zlib.crc32(data, checksum)
                written += block.shape[1]
        if written != n_samples:
            raise ParameterError(f"{target}: {written} samples arrived, expected {n_samples}")
        about = replace(about, notes=(*about.notes, *found()))
        sidecar.write_text(sidecar_text(about, f"{checksum:08x}"), encoding="utf-8")
    return target


def _frames(
    target: Path, block: NDArray[np.float64], channels: tuple[Channel, ...]
) -> NDArray[np.float32]:
    if block.ndim != 2 or block.shape[0] != len(channels):
        raise ParameterError(
            f"{target}: a block has shape {block.shape}, expected ({len(channels)}, n_samples)"
        )
    with np.errstate(over="ignore"):
        frames = block.T.astype("<f4")
    finite = np.isfinite(frames).all(axis=0)
    if not finite.all():
        name = channels[int(np.argmin(finite))].name
        raise ParameterError(
            f"{target}: channel {name!r} holds samples that are not finite in 32 bits"
        )
    return frames


def _wav_path(path: Path) -> Path:
    ending = path.suffix.lower()
    if not path.name:
        raise ParameterError(f"{str(path)!r} names no file to write a recording to")
    if ending == ".wav":
        return path
    if ending in formats() or ending == ".json":
        raise ParameterError(f"{path}: recordings are written as WAV; end the name in .wav")
    return path.with_name(path.name + ".wav")
