"""Folders searched at any depth, by one rule for all commands.

What is hidden is left out. A link to a folder is followed as if it were one, after all that is
there without links: so a recording that can be reached in both ways has its own name, and a link
that leads back into a folder already searched ends there. A folder that goes away while it is
searched is one without files. What is no file (a link to nothing, a pipe, a device) is never
opened, and what nobody may look into is left out; one line says so.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from models.errors import ParameterError
from models.foreign_file import check_plain_file
from noise.base.progress import note

_NAMED = 3
"""Of what is left out, so many are named."""


def files_below(folder: Path, *, tell: bool = False) -> list[tuple[Path, str]]:
    """List the files in a folder at any depth.

    Parameters
    ----------
    folder : Path
    tell : bool
        Whether to say in one line what was left out, and why.

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
    others: list[Path] = []
    waiting = [folder]
    while waiting:
        links: list[Path] = []
        for top in waiting:
            found += _walked(top, seen, links, others)
        waiting = sorted(links)
    if tell and others:
        _tell(folder, sorted(others))
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


def _walked(
    top: Path, seen: set[tuple[int, int]], links: list[Path], others: list[Path]
) -> Iterator[Path]:
    """Go through the files below `top`, each folder once; collect links to folders, and others."""

    def closed(error: OSError) -> None:
        if not isinstance(error, FileNotFoundError):  # it went away
            others.append(Path(error.filename))

    for place, folders, names in os.walk(top, onerror=closed):
        try:
            status = Path(place).stat()
        except OSError:
            folders.clear()
            continue
        identity = (status.st_dev, status.st_ino)
        if identity in seen:
            folders.clear()
            continue
        seen.add(identity)
        here = Path(place)
        folders[:] = [name for name in folders if not name.startswith(".")]
        links += [here / name for name in folders if os.path.islink(here / name)]  # noqa: PTH114
        for path in (here / name for name in names if not name.startswith(".")):
            if is_file(path):
                yield path
            else:
                others.append(path)


def _tell(folder: Path, others: list[Path]) -> None:
    said = [f"{path.relative_to(folder)}: {_why(path)}" for path in others[:_NAMED]]
    more = len(others) - len(said)
    note(f"{folder}: left out {'; '.join(said)}{f'; and {more} more' * bool(more)}")


def _why(path: Path) -> str:
    """Tell what something is that is no file to be read, without opening it."""
    if os.path.islink(path) and not os.path.exists(path):  # noqa: PTH110, PTH114  # never raise
        return "links to nothing"
    if os.path.isdir(path):  # noqa: PTH112  # never raises
        return "cannot be looked into"
    try:
        check_plain_file(path, where="")
    except ParameterError as error:
        return str(error).removeprefix(": ")
    return "cannot be read"
