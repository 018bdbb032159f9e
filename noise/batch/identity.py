"""Whether a result still holds: of which file it is, and which program made it.

A file is known by its size and the time it was last written, as `make` and `rsync` know it, and a
recording's sidecar counts as part of it. The program is known by its own files and the version of
the array library: a number from the package's version alone would stay the same while someone
works on the program.
"""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from noise.recordings.sidecar import find_sidecar

if TYPE_CHECKING:
    from noise.batch.work import Work

__all__ = ["file_digest", "file_identity", "program_identity", "work_identity"]

_PACKAGES = ("models", "sim", "features", "noise")


def file_identity(path: Path) -> list[int] | None:
    """Size [byte] and time of the last change [ns] of a recording, then those of its sidecar.

    None where the file cannot be looked at.

    Examples
    --------
    >>> file_identity(Path("nowhere.wav")) is None
    True
    """
    try:
        parts = [path, *filter(None, [find_sidecar(path)])]
        return [value for part in parts for value in (part.stat().st_size, part.stat().st_mtime_ns)]
    except OSError:
        return None


def file_digest(path: Path) -> str:
    """Return the SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@lru_cache(maxsize=1)
def program_identity() -> str:
    """Digest of all files of the program, and of numpy's version.

    Examples
    --------
    >>> len(program_identity())
    64
    """
    import numpy as np

    digest = hashlib.sha256(np.__version__.encode())
    for package in _PACKAGES:
        folder = Path(str(import_module(package).__file__)).parent
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.suffix != ".pyc":
                digest.update(f"{package}/{path.relative_to(folder).as_posix()}\n".encode())
                digest.update(file_digest(path).encode())
    return digest.hexdigest()


def work_identity(work: Work) -> str:
    """Digest of all that decides a row beside its recording."""
    said = [program_identity(), work.doing, list(work.columns), dict(work.identity())]
    return hashlib.sha256(json.dumps(said).encode()).hexdigest()
