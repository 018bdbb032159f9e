"""Recordings on disk: samples in one file and, where more is known, a sidecar of the same stem.

What the samples of a file mean is decided in `noise.recordings.meaning`, once for all formats.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError, RecordingError
from models.recording import Recording
from noise.base.atomic import atomic
from noise.recordings.formats.float_wav import write_float_wav
from noise.recordings.meaning import check_finite, chosen_rows, describe
from noise.recordings.readers import READERS, read_raw
from noise.recordings.sidecar import sidecar_text

if TYPE_CHECKING:
    from collections.abc import Iterable


__all__ = [
    "MIN_SAMPLES",
    "find_recordings",
    "read_recording",
    "write_recording",
]

MIN_SAMPLES = 16
"""Fewer samples than this are no recording."""


def read_recording(path: str | os.PathLike[str], *, full_scale: float | None = None) -> Recording:
    """Read a recording and what its sidecar, or the file itself, says about it.

    Parameters
    ----------
    path : path-like
        File with one of the endings of `noise.recordings.readers.READERS`. A sidecar is the file
        of the same stem with the ending ``.json``. Without one each track is a pressure channel (an
        acceleration channel where a meter says so).
    full_scale : float, optional
        Pressure of a full-scale sample [Pa]; wins over all that file and sidecar say.

    Returns
    -------
    Recording
        Samples of shape (n_channels, n_samples), in the unit of each channel where `calibrated`,
        otherwise in fractions of full scale.

    Raises
    ------
    RecordingError
        The file or its sidecar cannot be read, or they contradict each other.
    ParameterError
        `full_scale` is not a positive number.

    Examples
    --------
    >>> import tempfile
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> samples, channels = np.full((1, 480), 30.0), (Channel("torque"),)
    >>> torque = Recording(samples, 48e3, channels, Condition(speed=5.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = read_recording(write_recording(Path(folder) / "run07", torque))
    >>> run.name, float(run["torque"].max()), run.condition.speed
    ('run07.wav', 30.0, 5.0)
    """
    path = Path(path)
    raw = chosen_rows(path, read_raw(path))
    channels, condition, calibrated = describe(path, raw, full_scale)
    n_samples = raw.samples.shape[1]
    if n_samples < MIN_SAMPLES:
        raise RecordingError(f"{path}: holds {n_samples} samples, expected at least {MIN_SAMPLES}")
    with np.errstate(over="ignore", invalid="ignore"):  # found and refused below
        for channel, row in zip(channels, raw.samples, strict=True):
            row *= channel.full_scale
    check_finite(path, raw.samples, raw.rate, channels)
    return Recording(raw.samples, raw.rate, channels, condition, calibrated, path.name)


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
    target = _wav_path(Path(path))
    _check_writable(target, recording)
    text = sidecar_text(recording)
    # The sidecar is moved into place first: samples are never seen without what they mean.
    with atomic(target) as wav, atomic(target.with_suffix(".json")) as sidecar:
        try:
            write_float_wav(wav, recording.samples, int(recording.rate))
        except ParameterError as error:
            raise ParameterError(f"{target}: {error}") from error
        sidecar.write_text(text, encoding="utf-8")
    return target


def find_recordings(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
) -> list[tuple[Path, str]]:
    """Find recordings: files as named, and those in folders at any depth.

    Parameters
    ----------
    paths : path-like or iterable of path-like
        A file stands for itself, whatever its ending. In a folder hidden files and folders and
        unknown endings are passed over.

    Returns
    -------
    list of (Path, str)
        Each file with its name relative to the folder named, with forward slashes; the bare name
        where the file itself was named. Paths in the order given, sorted within a folder.

    Raises
    ------
    ParameterError
        A path does not exist.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (Path(folder) / "day1").mkdir()
    ...     (Path(folder) / "day1" / "run07.wav").touch()
    ...     (Path(folder) / "day1" / "run07.json").touch()
    ...     [name for _, name in find_recordings(folder)]
    ['day1/run07.wav']
    """
    named = [paths] if isinstance(paths, str | os.PathLike) else paths
    found: list[tuple[Path, str]] = []
    for path in map(Path, named):
        try:
            if path.is_dir():
                found += sorted(_inside(path), key=lambda entry: entry[1])
            elif path.exists():
                found.append((path, path.name))
            else:
                raise ParameterError(f"{path}: there is no such file or folder")
        except OSError as error:
            raise ParameterError(f"{path}: cannot be read ({error.strerror or error})") from error
    return found


def _inside(folder: Path) -> Iterable[tuple[Path, str]]:
    for path in folder.rglob("*"):
        relative = path.relative_to(folder)
        hidden = any(part.startswith(".") for part in relative.parts)
        if not hidden and path.suffix.lower() in READERS and path.is_file():
            yield path, relative.as_posix()


def _wav_path(path: Path) -> Path:
    ending = path.suffix.lower()
    if not path.name:
        raise ParameterError(f"{str(path)!r} names no file to write a recording to")
    if ending == ".wav":
        return path
    if ending in READERS or ending == ".json":
        raise ParameterError(f"{path}: recordings are written as WAV; end the name in .wav")
    return path.with_name(path.name + ".wav")


def _check_writable(target: Path, recording: Recording) -> None:
    shape, rate = recording.samples.shape, recording.rate
    if shape[1] < MIN_SAMPLES:
        raise ParameterError(f"{target}: {shape[1]} samples, expected at least {MIN_SAMPLES}")
    if not (1 <= rate < 1 << 31 and float(rate).is_integer()):
        raise ParameterError(
            f"{target}: the sampling rate is {rate!r} Hz, but WAV holds whole hertz only"
        )
    largest = float(np.finfo(np.float32).max)
    for channel, row in zip(recording.channels, recording.samples, strict=True):
        if not (row.min() >= -largest and row.max() <= largest):  # so that NaN is caught as well
            raise ParameterError(
                f"{target}: channel {channel.name!r} holds samples that are not finite in 32 bits"
            )
