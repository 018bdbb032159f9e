"""Folders searched at any depth, by one rule for all commands.

What is hidden is left out. A link to a folder is followed as if it were one, after all that is
there without links: so a recording that can be reached in both ways has its own name, and a link
that leads back into a folder already searched ends there. A folder that goes away while it is
searched is one without files.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["files_below", "is_file"]


def files_below(folder: Path) -> list[tuple[Path, str]]:
    """List the files in a folder at any depth.

    Parameters
    ----------
    folder : Path

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
    waiting = [folder]
    while waiting:
        links: list[Path] = []
        for top in waiting:
            found += _walked(top, seen, links)
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


def _walked(top: Path, seen: set[tuple[int, int]], links: list[Path]) -> Iterator[Path]:
    """Go through the files below `top`, each folder once, collecting links to folders."""
    for place, folders, names in os.walk(top):
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
        links += [here / name for name in folders if (here / name).is_symlink()]
        files = (here / name for name in names if not name.startswith("."))
        yield from (path for path in files if path.is_file())
