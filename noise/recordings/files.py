"""Reader of recordings, whole or in blocks: a file of samples and an optional sidecar.

The formats are in `noise.recordings.formats`; `noise.recordings.interpretation` determines channels
and calibration for all of them.

In folders hidden files are skipped, links to folders are followed, and each folder is searched
once. A folder that disappears during the search counts as empty. Unreadable folders and paths that
are no files (broken links, pipes, devices) are skipped, with one note per reason.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, RecordingError
from models.foreign_file import reading, refusing
from models.recording import Recording, RecordingBlocks
from noise.base.progress import note, readable
from noise.recordings.formats import RawRecording, check_rate, formats
from noise.recordings.formats.isolated import open_isolated
from noise.recordings.interpretation import Metadata, check_finite, interpret
from noise.recordings.rotation import find_turns
from noise.recordings.sidecar import sidecar_of

MIN_SAMPLES = 16
"""Smallest number of samples of a recording."""

_DENSEST = 8192  # samples per byte: FLAC stores silence in about 10 bytes per block of 65535
_LARGE = 64 << 20
"""Size of 64-bit samples from which on a recording is read in chunks [byte]."""

_CHUNK = 8 << 20
"""Size of a chunk of 64-bit samples [byte]."""

_noted: set[str] = set()


def read_recording(path: str | os.PathLike[str], *, full_scale: float | None = None) -> Recording:
    """Read a recording with the metadata of its sidecar or of the file itself.

    Parameters
    ----------
    path : path-like
        File of one of the formats of `noise.recordings.formats.formats`. Its sidecar has the same
        stem and the suffix ``.json``. Without a sidecar each track of a sound file is a pressure
        channel, or an acceleration channel if the file of a meter states one.
    full_scale : float, optional
        Pressure of a full-scale sample [Pa]. It overrides file and
        sidecar, except for samples that are already in a unit.

    Returns
    -------
    Recording
        Samples of shape (n_channels, n_samples), in the units of the channels if `calibrated`,
        otherwise as fractions of full scale.

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
    with refusing(str(path), "recording", RecordingError), open_raw(path) as raw:
        return _whole(path, raw, interpret(path, raw, full_scale))


@contextmanager
def open_blocks(
    path: str | os.PathLike[str], *, full_scale: float | None = None
) -> Iterator[RecordingBlocks]:
    """Open a recording for reading in blocks; a long file is read only where needed.

    Compressed formats without random access are decoded from the beginning.

    Parameters
    ----------
    path : path-like
    full_scale : float, optional
        Pressure of a full-scale sample [Pa], as for `read_recording`.

    Yields
    ------
    RecordingBlocks
        Its reading raises RecordingError for missing or infinite samples.

    Raises
    ------
    RecordingError
        See `read_recording`.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> torque = Recording(np.full((1, 480), 30.0), 48e3, (Channel("torque"),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_recording(Path(folder) / "run07", torque)
    ...     with open_blocks(path) as blocks:
    ...         float(blocks.read(100, 200).mean())
    30.0
    """
    path = Path(path)
    with ExitStack() as stack:
        with refusing(str(path), "recording", RecordingError):
            raw = stack.enter_context(open_raw(path))
            metadata = interpret(path, raw, full_scale)
            if 8 * raw.n_channels * raw.n_samples < _LARGE:
                blocks = RecordingBlocks.of(_whole(path, raw, metadata))
                stack.close()
            else:
                blocks = _in_chunks(path, raw, metadata)
        yield blocks


@contextmanager
def open_raw(path: Path) -> Iterator[RawRecording]:
    """Open a recording without interpreting its samples.

    Raises
    ------
    RecordingError
        The file cannot be read.
    """
    with ExitStack() as stack:
        with reading(path, "recording", error=RecordingError):
            if path.stat().st_size == 0:
                raise RecordingError(f"{path}: is empty (0 bytes)")
            file_format = formats().get(path.suffix.lower())
            if file_format is None:
                raise RecordingError(
                    f"{path}: has no ending of a recording; known are {', '.join(formats())}; "
                    "convert others, as by ffmpeg"
                )
            raw = stack.enter_context((file_format.open or open_isolated)(path))
            check_rate(raw.rate, str(path))
            if raw.n_samples > _DENSEST * path.stat().st_size:
                raise RecordingError(
                    f"{path}: its header announces {raw.n_samples} samples, more than a file of "
                    "this size holds"
                )
            if raw.n_samples < MIN_SAMPLES:
                raise RecordingError(
                    f"{path}: holds {raw.n_samples} samples, expected at least {MIN_SAMPLES}"
                )
        yield raw


def _whole(path: Path, raw: RawRecording, metadata: Metadata) -> Recording:
    """Return a recording with all its samples."""
    samples, channels = raw.whole(), metadata.channels
    _to_units(path, raw, metadata, samples)
    unwrapping = find_turns(
        channels, lambda a, b: samples[:, a:b], raw.n_samples, metadata.calibrated
    )
    unwrapping.add(samples, 0)
    notes = (*metadata.notes, *unwrapping.notes)
    _note_once(path, notes)
    return Recording(
        samples, raw.rate, channels, metadata.condition, metadata.calibrated, path.name, notes
    )


def _in_chunks(path: Path, raw: RawRecording, metadata: Metadata) -> RecordingBlocks:
    """Return a long recording that is read in chunks, with a cache of the last two."""
    channels = metadata.channels
    length = max(1, _CHUNK // (8 * raw.n_channels))

    @lru_cache(maxsize=2)
    def chunk(number: int) -> NDArray[np.float64]:
        start = number * length
        samples = raw.read(start, min(start + length, raw.n_samples))
        _to_units(path, raw, metadata, samples, start)
        return samples

    def read(first: int, last: int) -> NDArray[np.float64]:
        last = min(last, raw.n_samples)
        numbers = range(first // length, math.ceil(last / length))
        parts = [chunk(n)[:, max(0, first - n * length) : last - n * length] for n in numbers]
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)

    unwrapping = find_turns(channels, read, raw.n_samples, metadata.calibrated)
    _note_once(path, (*metadata.notes, *unwrapping.notes))

    def read_unwrapped(first: int, last: int) -> NDArray[np.float64]:
        samples = read(first, last)
        if unwrapping.jumps:
            samples = samples.copy()
            unwrapping.add(samples, first)
        return samples

    return RecordingBlocks(
        raw.rate, channels, metadata.condition, metadata.calibrated, path.name,
        raw.n_samples, read_unwrapped,
    )  # fmt: skip


def _to_units(
    path: Path, raw: RawRecording, metadata: Metadata, samples: NDArray[np.float64], start: int = 0
) -> None:
    """Convert samples from index `start` on to their units in place."""
    with np.errstate(over="ignore", invalid="ignore"):  # `check_finite` refuses them
        for channel, row in zip(metadata.channels, samples, strict=True):
            if channel.full_scale != 1.0:
                row *= channel.full_scale
    check_finite(path, samples, raw.rate, metadata.channels, start)


def names_channels(path: Path) -> bool:
    """Whether a recording names its channels, in contrast to a plain sound file.

    Raises
    ------
    RecordingError
        The sidecar cannot be read.

    Examples
    --------
    >>> names_channels(Path("stereo.wav")), names_channels(Path("run07.tdms"))
    (False, True)
    """
    file_format = formats().get(path.suffix.lower())
    logged = file_format is not None and file_format.open is None
    return logged or sidecar_of(path).channels is not None


def _note_once(path: Path, notes: Iterable[str]) -> None:
    """Print notes on a recording; a note on several files is printed for the first only."""
    for text in notes:
        if text not in _noted:
            _noted.add(text)
            note(f"{path}: {text}")


_MAX_NAMES = 3
"""Number of skipped files that a note names."""

_NOT_READ = "recordings of this format are not read; convert to WAV or FLAC, as by ffmpeg"

_RENDERED = "made for listening from the files of the same names in recordings"

_OTHERS = (
    *(".3gp", ".aac", ".ac3", ".amr", ".ape", ".ats", ".au", ".caf", ".d7d", ".dsf", ".dxd"),
    *(".hdf", ".m4a", ".m4b", ".mat", ".mka", ".mkv", ".mov", ".mp2", ".mp4", ".pti", ".sie"),
    *(".snd", ".tdm", ".w64", ".webm", ".wma", ".wv"),
)
"""Suffixes of unsupported recordings."""


def files_below(
    folder: Path, left_out: dict[str, list[str]] | None = None
) -> list[tuple[Path, str]]:
    """List the files in a folder recursively.

    Parameters
    ----------
    folder : Path
    left_out : dict, optional
        Filled with the names of skipped paths by reason.

    Returns
    -------
    list of (Path, str)
        Files with their names relative to the folder, with forward slashes, sorted by name.

    Raises
    ------
    OSError
        The folder itself cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as name:
    ...     (Path(name) / "day1").mkdir()
    ...     (Path(name) / "day1" / "run07.wav").touch()
    ...     (Path(name) / ".hidden").touch()
    ...     [name for _, name in files_below(Path(name))]
    ['day1/run07.wav']
    """
    os.scandir(folder).close()  # raises if the folder itself is missing
    visited: set[tuple[int, int]] = set()
    files: list[tuple[Path, str]] = []

    def leave_out(path: Path, reason: str) -> None:
        if left_out is not None:
            left_out.setdefault(reason, []).append(path.relative_to(folder).as_posix())

    def unreadable(error: OSError) -> None:
        if not isinstance(error, FileNotFoundError):  # it disappeared
            leave_out(Path(error.filename), "cannot be read")

    for place, folders, names in os.walk(folder, onerror=unreadable, followlinks=True):
        try:
            status = os.stat(place)  # noqa: PTH116
        except OSError:  # it disappeared
            continue
        if (status.st_dev, status.st_ino) in visited:
            folders.clear()
            continue
        visited.add((status.st_dev, status.st_ino))
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for path in (Path(place, name) for name in sorted(names) if not name.startswith(".")):
            if is_file(path):
                files.append((path, path.relative_to(folder).as_posix()))
            else:
                leave_out(path, "is no file, or links to nothing")
    return sorted(files, key=lambda entry: entry[1])


def _original(path: Path) -> Path | None:
    """Return ``recordings/run07.wav`` of ``audio/run07.wav``, as `demo` writes them."""
    if path.parent.name != "audio" or path.suffix.lower() != ".wav":
        return None
    return path.parent.with_name("recordings") / path.name


def is_file(path: Path) -> bool:
    """Whether a path is a file; False also for names that the system does not accept.

    Examples
    --------
    >>> is_file(Path("x" * 5000))
    False
    """
    try:
        return path.is_file()
    except OSError:
        return False


def find_recordings(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
) -> list[tuple[Path, str]]:
    """Find recordings in files and folders.

    Parameters
    ----------
    paths : path-like or iterable of path-like
        Files, with any suffix, or folders, which are searched recursively. In a folder hidden
        files and unknown suffixes are skipped; paths that are no files, recordings of an
        unsupported format, and ``audio/run07.wav`` beside ``recordings/run07.wav`` are skipped
        with a note.

    Returns
    -------
    list of (Path, str)
        Files with their names: relative to the folder with forward slashes, or the bare file name;
        escaped by `noise.base.progress.readable`. In the order of `paths`, sorted within a folder.

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
    recordings: list[tuple[Path, str]] = []
    for path in map(Path, [paths] if isinstance(paths, str | os.PathLike) else paths):
        try:
            if path.is_dir():
                left_out: dict[str, list[str]] = {}
                files = files_below(path, left_out)
                there = {file for file, _ in files}
                for file, name in files:
                    if _original(file) in there:
                        left_out.setdefault(_RENDERED, []).append(name)
                    elif file.suffix.lower() in formats():
                        recordings.append((file, readable(name)))
                    elif file.suffix.lower() in _OTHERS:
                        left_out.setdefault(_NOT_READ, []).append(name)
                for reason, skipped in left_out.items():
                    more = f" and {len(skipped) - _MAX_NAMES} more" * (len(skipped) > _MAX_NAMES)
                    note(f"{path}: left out {', '.join(skipped[:_MAX_NAMES])}{more}: {reason}")
            elif path.exists():
                recordings.append((path, readable(path.name)))
            else:
                raise ParameterError(f"{path}: there is no such file or folder")
        except OSError as error:
            raise ParameterError(f"{path}: cannot be read ({error.strerror or error})") from error
    return recordings
