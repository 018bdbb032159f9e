"""Where the file goes that is written for each recording of a batch."""

from __future__ import annotations

from collections import Counter
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

__all__ = ["export_paths"]


def export_paths(
    target: Path, files: Sequence[str], endings: Sequence[str], option: str
) -> dict[str, Path]:
    """Return where the file of each recording goes.

    Parameters
    ----------
    target : Path
        A folder, in which they lie as the recordings do in theirs; or a file of one of the endings,
        for one recording.
    files : sequence of str
        Recordings, as tables call them.
    endings : sequence of str
        That a file may have; in a folder, files have the first.
    option : str
        Of the command line, that names the target.

    Raises
    ------
    ParameterError
        Two recordings have the same name, or there are several for one file.

    Examples
    --------
    >>> from pathlib import Path
    >>> paths = export_paths(Path("tracks"), ["day1/run07.wav"], [".txt"], "--audacity")
    >>> paths["day1/run07.wav"].as_posix()
    'tracks/day1/run07.txt'
    """
    if target.suffix.lower() in endings:
        if len(set(files)) > 1:
            raise ParameterError(
                f"{option} {target}: is one file, but there are {len(set(files))} recordings; "
                "name a folder"
            )
        return dict.fromkeys(files, target)
    times = Counter(files)
    for file in files:
        if times[file] > 1:
            raise ParameterError(
                f"{option} {target}: two recordings are called {file}; name the folder that "
                "holds them both"
            )
        if PurePosixPath(file).is_absolute() or ".." in PurePosixPath(file).parts:
            raise ParameterError(f"{option} {target}: {file} lies outside of the folder named")
    # Recordings that differ in the ending alone keep it.
    short = [PurePosixPath(file).with_suffix(endings[0]) for file in files]
    alike = Counter(short)
    return {
        file: target / (name if alike[name] == 1 else f"{file}{endings[0]}")
        for file, name in zip(files, short, strict=True)
    }
