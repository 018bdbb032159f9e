"""Identity of a result: of which file it is, and which program made it.

A file is known by its size and the time it was last written, as `make` and `rsync` know it, and a
recording's sidecar counts as part of it. The program is known by the content of its sources and
models, and by the versions of the libraries that compute: its own version would stay the same while
someone works on it. What Python and numba put beside the sources does not count, since it changes
with every command that compiles and never what comes out.
"""

from __future__ import annotations

import hashlib
import json
import os
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from noise.recordings.sidecar import find_sidecar

if TYPE_CHECKING:
    from collections.abc import Iterator

    from noise.batch.work import Work

__all__ = ["call_identity", "file_digest", "file_identity", "program_identity", "work_identity"]

_PACKAGES = ("models", "sim", "features", "noise")
_LIBRARIES = ("librosa", "numba", "numpy", "scikit-learn", "scipy", "soundfile")
"""What the numbers come from. Readers of loggers' files are not among them: to install one is no
reason to do all recordings again, and what it could not read before was not kept."""


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


@lru_cache(maxsize=1)  # a process goes on with the program that it has loaded
def program_identity() -> str:
    """Digest of the program's sources and models, and of the libraries' versions.

    Examples
    --------
    >>> len(program_identity())
    64
    """
    return _digest(Path(__file__).parents[2])


def _digest(root: Path) -> str:
    digest = hashlib.sha256()
    for library in _LIBRARIES:
        digest.update(f"{library} {version(library)}\n".encode())
    for path in sorted(_sources(root)):
        digest.update(f"{path.relative_to(root).as_posix()} {file_digest(path)}\n".encode())
    return digest.hexdigest()


def _sources(root: Path) -> Iterator[Path]:
    """Go through sources and models, passing over what is hidden or was compiled from them."""
    for package in _PACKAGES:
        for folder, inner, names in os.walk(root / package):
            inner[:] = [name for name in inner if name != "__pycache__"]
            yield from (Path(folder, name) for name in names if not name.startswith("."))


def work_identity(work: Work) -> str:
    """Digest of all that decides a row beside its recording."""
    return call_identity(work.doing, list(work.columns), dict(work.identity()))


def call_identity(*said: object) -> str:
    """Digest of the program, and of what decides a result beside it, as JSON can hold it."""
    return hashlib.sha256(json.dumps([program_identity(), *said]).encode()).hexdigest()
