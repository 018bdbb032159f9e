"""Recordings on disk: samples in one file and, where more is known, a sidecar of the same stem.

Formats are found in `noise.recordings.formats`; what the samples mean is decided in
`noise.recordings.meaning`, once for all of them.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.calibration import Calibration
from models.errors import ParameterError, RecordingError
from models.foreign_file import reading, refusing
from models.recording import Channel, Recording
from noise.base.progress import note, readable
from noise.recordings.folders import files_below
from noise.recordings.formats import RawSamples, check_rate, formats
from noise.recordings.formats.isolated import open_isolated
from noise.recordings.meaning import PascalPerFullScale, check_finite, describe
from noise.recordings.sidecar import sidecar_of
from noise.recordings.unwrapping import find_turns

MIN_SAMPLES = 16
"""Fewer samples than this are no recording."""

_NAMED = 3
"""Of what is left out, so many are named."""

_CONVERT = "convert to WAV or FLAC, as by: ffmpeg -i {name} {stem}.wav"
_EXPORT = "export as TDMS, MDF4, HDF5, UFF58 or WAV from the program that wrote it"
OTHERS = {
    **dict.fromkeys(
        (".3gp", ".aac", ".ac3", ".amr", ".ape", ".au", ".caf", ".dsf", ".m4a", ".m4b", ".mka",
         ".mkv", ".mov", ".mp2", ".mp4", ".snd", ".w64", ".webm", ".wma", ".wv"), _CONVERT
    ),
    **dict.fromkeys((".ats", ".d7d", ".dxd", ".hdf", ".mat", ".pti", ".sie", ".tdm"), _EXPORT),
}  # fmt: skip
"""Endings of recordings that are not read -> what to do."""

_BLOCK = 1 << 16  # samples a channel

_said: set[str] = set()


def read_recording(
    path: str | os.PathLike[str],
    *,
    full_scale: PascalPerFullScale | None = None,
    calibrations: Mapping[str, Calibration] | None = None,
) -> Recording:
    """Read a recording and what its sidecar, or the file itself, says about it.

    Parameters
    ----------
    path : path-like
        File with one of the endings of `noise.recordings.formats.formats`. A sidecar is the file
        of the same stem with the ending ``.json``. Without one each track of a sound file is a
        pressure channel (an acceleration channel where a meter says so).
    full_scale : float or tuple of float, optional
        Pressure of a full-scale sample [Pa], of all tracks or of each; wins over all that file and
        sidecar say, but for samples that are in a unit already.
    calibrations : mapping of str to Calibration, optional
        By kind of channel, for channels that neither file nor sidecar calibrates.

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
    >>> from noise.recordings import write_recording
    >>> samples, channels = np.full((1, 480), 30.0), (Channel("torque"),)
    >>> torque = Recording(samples, 48e3, channels, Condition(speed=5.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = read_recording(write_recording(Path(folder) / "run07", torque))
    >>> run.name, float(run["torque"].max()), run.condition.speed
    ('run07.wav', 30.0, 5.0)
    """
    path = Path(path)
    with refusing(str(path), "recording", RecordingError):
        return _read_recording(path, full_scale, calibrations)


def _read_recording(
    path: Path,
    full_scale: PascalPerFullScale | None,
    calibrations: Mapping[str, Calibration] | None,
) -> Recording:
    raw = read_raw(path)
    meaning = describe(path, raw, full_scale, calibrations)
    samples, channels = raw.samples, meaning.channels
    n_samples = samples.shape[1]
    if n_samples < MIN_SAMPLES:
        raise RecordingError(f"{path}: holds {n_samples} samples, expected at least {MIN_SAMPLES}")
    with np.errstate(over="ignore", invalid="ignore"):  # found and refused below
        beyond = [
            _to_units(path, channel, curve, row)
            for channel, curve, row in zip(channels, meaning.curves, samples, strict=True)
        ]
    check_finite(path, samples, raw.rate, channels)
    unwrapping = find_turns(channels, lambda a, b: samples[:, a:b], n_samples, meaning.calibrated)
    unwrapping.add(samples, 0)
    notes = (*meaning.notes, *filter(None, beyond), *unwrapping.notes)
    say_once(path, notes)
    return Recording(
        samples, raw.rate, channels, meaning.condition, meaning.calibrated, path.name, notes
    )


def _to_units(
    path: Path, channel: Channel, curve: Calibration | None, row: NDArray[np.float64]
) -> str:
    """Bring the samples of a channel to its unit, in place; return what should be known of it."""
    if curve is None:
        row *= channel.full_scale
        return ""
    try:
        out = curve.beyond(row)
        row[:] = curve.of(row)
    except ParameterError as error:
        raise RecordingError(f"{path}: channel {channel.name!r} {error}") from None
    if not out:
        return ""
    return f"{channel.name} was read up to {out:.1%} of its span outside of {curve.source}"


def find_recordings(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
) -> list[tuple[Path, str]]:
    """Find recordings: files as named, and those in folders at any depth.

    Parameters
    ----------
    paths : path-like or iterable of path-like
        A file stands for itself, whatever its ending. In a folder hidden files and folders and
        unknown endings are passed over, links to folders are followed, and what is no file, or a
        recording of a format that is not read, is left out with a note.

    Returns
    -------
    list of (Path, str)
        Each file with its name relative to the folder named, with forward slashes; the bare name
        where the file itself was named; what cannot be shown of it as
        `noise.base.progress.readable` has it. Paths in the order given, sorted within a folder.

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
                files = files_below(path, tell=True)
                _note_others(path, [name for _, name in files])
                found += [
                    (file, readable(name))
                    for file, name in files
                    if file.suffix.lower() in formats()
                ]
            elif path.exists():
                found.append((path, readable(path.name)))
            else:
                raise ParameterError(f"{path}: there is no such file or folder")
        except OSError as error:
            raise ParameterError(f"{path}: cannot be read ({error.strerror or error})") from error
    return found


def _note_others(folder: Path, names: list[str]) -> None:
    """Name the recordings in a folder that cannot be read, with what to do."""
    for advice in (_CONVERT, _EXPORT):
        left = [name for name in names if OTHERS.get(Path(name).suffix.lower()) == advice]
        if left:
            more = f" and {len(left) - _NAMED} more" * (len(left) > _NAMED)
            note(f"{folder}: left out {', '.join(left[:_NAMED])}{more}: {_what_to_do(left[0])}")


def _what_to_do(name: str) -> str:
    path = Path(name)
    return "not read; " + OTHERS[path.suffix.lower()].format(name=path.name, stem=path.stem)


def read_raw(path: Path) -> RawSamples:
    """Read what a file holds, before anyone says what it means.

    Raises
    ------
    RecordingError
        It cannot be read.
    """
    with reading(path, "recording", error=RecordingError):
        if path.stat().st_size == 0:
            raise RecordingError(f"{path}: is empty (0 bytes)")
        if path.suffix.lower() in OTHERS:
            raise RecordingError(f"{path}: {_what_to_do(path.name)}")
        of = formats().get(path.suffix.lower())
        if of is None:
            known = ", ".join(formats())
            raise RecordingError(f"{path}: has no ending of a recording; known are {known}")
        raw = _read_logged(path) if of.read is None else of.read(path)
        check_rate(raw.rate, str(path))
        return raw


def _read_logged(path: Path) -> RawSamples:
    with open_isolated(path) as (raw, n_samples, read):
        samples = np.empty((len(raw.samples), n_samples))
        for first in range(0, n_samples, _BLOCK):
            last = min(first + _BLOCK, n_samples)
            samples[:, first:last] = read(first, last)
    return replace(raw, samples=samples)


def names_channels(path: Path) -> bool:
    """Whether a recording says what its channels are; the tracks of a plain sound file do not.

    Raises
    ------
    RecordingError
        Its sidecar cannot be read.

    Examples
    --------
    >>> names_channels(Path("stereo.wav")), names_channels(Path("run07.tdms"))
    (False, True)
    """
    of = formats().get(path.suffix.lower())
    logged = of is not None and of.read is None
    return logged or sidecar_of(path).channels is not None


def say_once(path: Path, notes: Iterable[str]) -> None:
    """Print notes on a recording; one that is true of many files is printed for the first."""
    for text in notes:
        if text not in _said:
            _said.add(text)
            note(f"{path}: {text}")
