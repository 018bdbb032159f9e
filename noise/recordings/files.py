"""Recordings on disk: samples in one file and, where more is known, a sidecar of the same stem.

What a sample of 1.0 is worth is decided per channel by the first of these that says something:

1. the caller's `full_scale` (pressure channels only),
2. the sidecar: its ``scale``, or, for floating-point samples, that it names the channel, since
   such samples are then in the channel's unit; ``"calibrated": false`` silences 2 to 4,
3. the file's description, then its name, as sound level meters write them,
4. the file's comment.

Unless every channel has its value the recording is not calibrated: its samples stay fractions of
full scale, and levels can be told in dBFS alone. Half a calibration would only invite comparing
what cannot be compared.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from noise.atomic import atomic
from noise.recordings.float_wav import write_float_wav
from noise.recordings.full_scale import stated_full_scale
from noise.recordings.readers import READERS, read_raw
from noise.recordings.sidecar import Sidecar, find_sidecar, read_sidecar, sidecar_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from noise.recordings.readers import RawSamples

__all__ = ["MIN_SAMPLES", "find_recordings", "read_recording", "write_recording"]

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
    >>> samples, channels = np.full((1, 480), 30.0), (Channel("torque"),)
    >>> torque = Recording(samples, 48e3, channels, Condition(speed=5.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = read_recording(write_recording(Path(folder) / "run07", torque))
    >>> run.name, float(run["torque"].max()), run.condition.speed
    ('run07.wav', 30.0, 5.0)
    """
    path = Path(path)
    if full_scale is not None and not 0 < full_scale < math.inf:
        raise ParameterError(f"full scale is {full_scale!r} Pa, expected a positive number")
    raw = read_raw(path)
    sidecar_path = find_sidecar(path)
    sidecar = Sidecar() if sidecar_path is None else read_sidecar(sidecar_path)
    n_channels, n_samples = raw.samples.shape
    if n_samples < MIN_SAMPLES:
        raise RecordingError(f"{path}: holds {n_samples} samples, expected at least {MIN_SAMPLES}")
    if sidecar.channels is not None and len(sidecar.channels) != n_channels:
        raise RecordingError(
            f"{sidecar_path}: names {len(sidecar.channels)} channels, {path.name} has {n_channels}"
        )
    if not raw.fractional and any(scale is not None for scale in sidecar.scales):
        raise RecordingError(
            f"{sidecar_path}: gives a scale, but {path.name} holds floating-point samples, which "
            f"are in the channel's unit; remove the scale"
        )
    channels, calibrated = _interpret(path, raw, sidecar, full_scale)
    with np.errstate(over="ignore", invalid="ignore"):  # found and refused below
        for channel, row in zip(channels, raw.samples, strict=True):
            row *= channel.full_scale
    _check_finite(path, raw, channels)
    return Recording(raw.samples, raw.rate, channels, sidecar.condition, calibrated, path.name)


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


def _interpret(
    path: Path, raw: RawSamples, sidecar: Sidecar, full_scale: float | None
) -> tuple[tuple[Channel, ...], bool]:
    """Channels with the value of their full scale, and whether all of them have one."""
    texts = (raw.description, path.name, raw.comment)
    stated = next((found for text in texts if (found := stated_full_scale(text))), None)
    channels = sidecar.channels or raw.channels
    if channels is None:
        kind = "pressure" if stated is None or full_scale is not None else stated.kind
        numbers = range(1, len(raw.samples) + 1)
        channels = tuple(Channel(kind if i == 1 else f"{kind}_{i}") for i in numbers)
    named = sidecar.channels is not None or raw.channels is not None
    in_units = not raw.fractional and (named or sidecar.calibrated is True)
    values: list[float] = []
    for channel, scale in zip(channels, sidecar.scales or (None,) * len(channels), strict=True):
        opinions = [full_scale if channel.kind == "pressure" else None]
        if sidecar.calibrated is not False:
            opinions += [scale, 1.0 if in_units else None]
            opinions += [stated.value if stated and stated.kind == channel.kind else None]
        values += [value for value in opinions if value is not None][:1]
    if len(values) < len(channels):
        return channels, False
    pairs = zip(channels, values, strict=True)
    return tuple(replace(channel, full_scale=value) for channel, value in pairs), True


def _check_finite(path: Path, raw: RawSamples, channels: tuple[Channel, ...]) -> None:
    for channel, row in zip(channels, raw.samples, strict=True):
        finite = np.isfinite(row)
        if not finite.all():
            first = int(np.argmin(finite))
            raise RecordingError(
                f"{path}: channel {channel.name!r} is {row[first]} at sample {first} "
                f"({first / raw.rate:.6g} s), expected finite numbers"
            )


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
