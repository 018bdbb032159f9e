"""Folders searched at any depth, by one rule for all commands.

What is hidden is left out. A link to a folder is followed as if it were one, after all that is
there without links: so a recording that can be reached in both ways has its own name, and a link
that leads back into a folder already searched ends there. A folder that goes away while it is
searched is one without files. What is no file (a link to nothing, a pipe, a device) is never
opened, and what nobody may look into is left out; a line for each reason says so.
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

_NAMED = 3
"""Of what is left out, so many are named."""

_CONVERT = "convert to WAV or FLAC, as by: ffmpeg -i {name} {stem}.wav"
_EXPORT = "export as WAV, or a format that is read, from the program that wrote it"
_OTHERS = {
    **dict.fromkeys(
        (".3gp", ".aac", ".ac3", ".amr", ".ape", ".au", ".caf", ".dsf", ".m4a", ".m4b", ".mka",
         ".mkv", ".mov", ".mp2", ".mp4", ".snd", ".w64", ".webm", ".wma", ".wv"), _CONVERT
    ),
    **dict.fromkeys((".ats", ".d7d", ".dxd", ".hdf", ".mat", ".pti", ".sie", ".tdm"), _EXPORT),
}  # fmt: skip
"""Endings of recordings that are not read -> what to do."""


def files_below(
    folder: Path, left_out: dict[str, list[str]] | None = None
) -> list[tuple[Path, str]]:
    """List the files in a folder at any depth.

    Parameters
    ----------
    folder : Path
    left_out : dict, optional
        Filled with what is left out, by the reason.

    Returns
    -------
    list of (Path, str)
        Each with its name relative to the folder, with forward slashes; sorted by it.

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
    os.scandir(folder).close()  # what was named must be there; what is below may come and go
    seen: set[tuple[int, int]] = set()
    found: list[Path] = []

    def leave_out(path: Path, reason: str) -> None:
        if left_out is not None:
            left_out.setdefault(reason, []).append(path.relative_to(folder).as_posix())

    def closed(error: OSError) -> None:
        if not isinstance(error, FileNotFoundError):  # it went away
            leave_out(Path(error.filename), "cannot be looked into")

    waiting = [folder]
    while waiting:
        links: list[Path] = []
        for place, folders, names in chain(*(os.walk(top, onerror=closed) for top in waiting)):
            here, before = Path(place), len(seen)
            with suppress(OSError):
                status = here.stat()
                seen.add((status.st_dev, status.st_ino))
            if len(seen) == before:  # it went away, or was searched already
                folders.clear()
                continue
            folders[:] = [name for name in folders if not name.startswith(".")]
            links += [here / name for name in folders if os.path.islink(here / name)]  # noqa: PTH114
            for path in (here / name for name in sorted(names) if not name.startswith(".")):
                if is_file(path):
                    found.append(path)
                else:
                    leave_out(path, _why(path))
        waiting = sorted(links)
    named = ((path, path.relative_to(folder).as_posix()) for path in found)
    return sorted(named, key=lambda entry: entry[1])


def is_file(path: Path) -> bool:
    """Whether there is a file, of a path that a table or a page may have made up.

    Examples
    --------
    >>> is_file(Path("x" * 5000))
    False
    """
    try:
        return path.is_file()
    except OSError:  # such as a name that is too long for the system
        return False


def _why(path: Path) -> str:
    """Tell what something is that is no file to be read, without opening it."""
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
                left_out: dict[str, list[str]] = {}
                files = files_below(path, left_out)
                _note_left_out(path, left_out, [name for _, name in files])
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


def _note_left_out(folder: Path, left_out: dict[str, list[str]], names: list[str]) -> None:
    """Say what is left out of a folder, recordings that are not read with what to do."""
    others: dict[str, list[str]] = {}
    for name in names:
        if advice := _advice(Path(name)):
            others.setdefault(advice, []).append(name)
    for reason, left in (left_out | {why_not_read(o[0]): o for o in others.values()}).items():
        more = f" and {len(left) - _NAMED} more" * (len(left) > _NAMED)
        note(f"{folder}: left out {', '.join(left[:_NAMED])}{more}: {reason}")


def why_not_read(name: str) -> str:
    """Say that a recording is not read, and what to do; empty where its ending is none of one.

    Examples
    --------
    >>> why_not_read("memo.m4a")
    'not read; convert to WAV or FLAC, as by: ffmpeg -i memo.m4a memo.wav'
    """
    path = Path(name)
    advice = _advice(path).format(name=path.name, stem=path.stem)
    return f"not read; {advice}" if advice else ""


def _advice(path: Path) -> str:
    ending = path.suffix.lower()
    return "" if ending in formats() else _OTHERS.get(ending, "")
