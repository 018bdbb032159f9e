"""Recursive search of folders for recordings, by the same rules for all commands.

Hidden files are skipped. Links to folders are followed after all real folders, so that a recording
has the name of its real path, and each folder is searched once. A folder that disappears during the
search counts as empty. Unreadable folders and paths that are no files (broken links, pipes,
devices) are skipped, with one note per reason.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from itertools import chain
from pathlib import Path

from models.errors import ParameterError
from models.foreign_file import check_plain_file
from noise.base.progress import note, readable
from noise.recordings.formats import formats

_MAX_NAMES = 3
"""Number of skipped files that a note names."""

_CONVERT = "convert to WAV or FLAC, as by: ffmpeg -i {name} {stem}.wav"
_EXPORT = "export as WAV, or a format that is read, from the program that wrote it"
_OTHERS = {
    **dict.fromkeys(
        (".3gp", ".aac", ".ac3", ".amr", ".ape", ".au", ".caf", ".dsf", ".m4a", ".m4b", ".mka",
         ".mkv", ".mov", ".mp2", ".mp4", ".snd", ".w64", ".webm", ".wma", ".wv"), _CONVERT
    ),
    **dict.fromkeys((".ats", ".d7d", ".dxd", ".hdf", ".mat", ".pti", ".sie", ".tdm"), _EXPORT),
}  # fmt: skip
"""Suffixes of unsupported recordings -> advice."""


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
    files: list[Path] = []

    def leave_out(path: Path, reason: str) -> None:
        if left_out is not None:
            left_out.setdefault(reason, []).append(path.relative_to(folder).as_posix())

    def unreadable(error: OSError) -> None:
        if not isinstance(error, FileNotFoundError):  # it disappeared
            leave_out(Path(error.filename), "cannot be read")

    waiting = [folder]
    while waiting:
        links: list[Path] = []
        for place, folders, names in chain(*(os.walk(top, onerror=unreadable) for top in waiting)):
            here, n_before = Path(place), len(visited)
            with suppress(OSError):
                status = here.stat()
                visited.add((status.st_dev, status.st_ino))
            if len(visited) == n_before:  # it disappeared, or was searched already
                folders.clear()
                continue
            folders[:] = [name for name in folders if not name.startswith(".")]
            links += [here / name for name in folders if os.path.islink(here / name)]  # noqa: PTH114
            for path in (here / name for name in sorted(names) if not name.startswith(".")):
                if is_file(path):
                    files.append(path)
                else:
                    leave_out(path, _skip_reason(path))
        waiting = sorted(links)
    named = ((path, path.relative_to(folder).as_posix()) for path in files)
    return sorted(named, key=lambda entry: entry[1])


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


def _skip_reason(path: Path) -> str:
    """Return why a path is not a readable file, without opening it."""
    if os.path.islink(path) and not os.path.exists(path):  # noqa: PTH110, PTH114  # never raise
        return "links to nothing"
    try:
        check_plain_file(path, where="")
    except ParameterError as error:
        return str(error).removeprefix(": ")
    return "cannot be read"


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
                files = files_below(path, left_out)
                _note_left_out(path, left_out, [name for _, name in files])
                recordings += [
                    (file, readable(name))
                    for file, name in files
                    if file.suffix.lower() in formats()
                ]
            elif path.exists():
                recordings.append((path, readable(path.name)))
            else:
                raise ParameterError(f"{path}: there is no such file or folder")
        except OSError as error:
            raise ParameterError(f"{path}: cannot be read ({error.strerror or error})") from error
    return recordings


def _note_left_out(folder: Path, left_out: dict[str, list[str]], names: list[str]) -> None:
    """Print a note per reason on the skipped files of a folder."""
    unsupported: dict[str, list[str]] = {}
    for name in names:
        if advice := _advice(Path(name)):
            unsupported.setdefault(advice, []).append(name)
    by_reason = left_out | {why_not_read(same[0]): same for same in unsupported.values()}
    for reason, skipped in by_reason.items():
        more = f" and {len(skipped) - _MAX_NAMES} more" * (len(skipped) > _MAX_NAMES)
        note(f"{folder}: left out {', '.join(skipped[:_MAX_NAMES])}{more}: {reason}")


def why_not_read(name: str) -> str:
    """Return a message with advice for a recording of an unsupported format, else an empty text.

    Examples
    --------
    >>> why_not_read("memo.m4a")
    'not read; convert to WAV or FLAC, as by: ffmpeg -i memo.m4a memo.wav'
    """
    path = Path(name)
    advice = _advice(path).format(name=path.name, stem=path.stem)
    return f"not read; {advice}" if advice else ""


def _advice(path: Path) -> str:
    """Return the advice for an unsupported format as a template; empty for other files."""
    ending = path.suffix.lower()
    return "" if ending in formats() else _OTHERS.get(ending, "")
