"""Which recordings a batch goes through, and in which order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.batch.work import Job
from noise.recordings import find_recordings

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

__all__ = ["find_jobs"]


def find_jobs(paths: Sequence[Path]) -> list[Job]:
    """Find the recordings, each once however often it is named.

    Parameters
    ----------
    paths : sequence of Path
        Recordings, or folders that are searched at any depth.

    Returns
    -------
    list of Job

    Raises
    ------
    ParameterError
        A path does not exist, or there are no recordings.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (Path(folder) / "run07.wav").touch()
    ...     [job.name for job in find_jobs([Path(folder)])]
    ['run07.wav']
    """
    found = {(path.absolute(), name): path for path, name in find_recordings(paths)}
    if not found:
        raise ParameterError(f"{', '.join(map(str, paths))}: there are no recordings in it")
    return [Job(index, path, name) for index, ((_, name), path) in enumerate(found.items())]
