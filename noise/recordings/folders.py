"""Recursive search of folders for recordings, by the same rules for all commands.

Hidden files are skipped, links to folders are followed, and each folder is searched once. A folder
that disappears during the search counts as empty. Unreadable folders and paths that are no files
(broken links, pipes, devices) are skipped, with one note per reason.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from models.errors import ParameterError
from noise.base.progress import note, readable
from noise.recordings.formats import formats

_MAX_NAMES = 3
"""Number of skipped files that a note names."""

_NOT_READ = "recordings of this format are not read; convert to WAV or FLAC, as by ffmpeg"

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
        files and unknown suffixes are skipped; paths that are no files and recordings of an
        unsupported format are skipped with a note.

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
                for file, name in files_below(path, left_out):
                    if file.suffix.lower() in formats():
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
