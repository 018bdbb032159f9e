"""The file formats that recordings come in: an ending, and the function that reads it.

Readers are named, not imported: a format whose library is an optional extra costs nothing until a
file of it turns up, and a further format is one file and one entry here. A reader returns what the
file says and nothing more; what the samples mean is decided once, for all formats, in
`noise.recordings`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from models.condition import Condition
from models.errors import RecordingError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from models.recording import Channel

__all__ = ["READERS", "RawSamples", "Reader", "read_raw"]


@dataclass(frozen=True, eq=False)
class RawSamples:
    """What a file holds, before anyone says what it means.

    Parameters
    ----------
    samples : ndarray, shape (n_channels, n_samples)
        As stored: fractions of full scale where `fractional`.
    rate : float
        Sampling rate [Hz].
    fractional : bool
        Whether samples are coded as fractions of a full scale (integers, lossy formats) and not
        as floating-point values of their own.
    description, comment : str
        Free text in the file, where meters and engineers note a calibration.
    channels : tuple of (Channel or None), optional
        Where the file itself says what it measures: one a row of `samples`, which are in the
        channels' units; None for a row that is no channel of ours, as the file has it.
    condition : Condition
        As far as the file itself tells it.
    unclear : str
        Why the file's own words do not settle what it measures, where they do not: the error,
        unless a sidecar names the channels.
    """

    samples: NDArray[np.float64]
    rate: float
    fractional: bool
    description: str = ""
    comment: str = ""
    channels: tuple[Channel | None, ...] | None = None
    condition: Condition = field(default_factory=Condition)
    unclear: str = ""


Reader = Callable[[Path], RawSamples]

_SOUND = "noise.recordings.formats.sound_file:read_sound_file"
_HDF5 = "noise.recordings.formats.hdf5_file:read_hdf5_file"
_MDF = "noise.recordings.formats.mdf_file:read_mdf_file"
_TDMS = "noise.recordings.formats.tdms_file:read_tdms_file"
_UNIVERSAL = "noise.recordings.formats.universal_file:read_universal_file"

READERS = {
    ".aif": _SOUND,
    ".aiff": _SOUND,
    ".flac": _SOUND,
    ".h5": _HDF5,
    ".hdf5": _HDF5,
    ".mdf": _MDF,
    ".mf4": _MDF,
    ".mp3": _SOUND,
    ".oga": _SOUND,
    ".ogg": _SOUND,
    ".opus": _SOUND,
    ".rf64": _SOUND,
    ".tdms": _TDMS,
    ".uff": _UNIVERSAL,
    ".unv": _UNIVERSAL,
    ".wav": _SOUND,
}
"""Ending in lower case -> reader, as ``module:function``."""


def read_raw(path: Path) -> RawSamples:
    """Read a file with the reader of its ending.

    Parameters
    ----------
    path : Path
        A file whose ending is a key of `READERS`, in either case.

    Raises
    ------
    RecordingError
        The file is missing, empty, of no known format, or its reader refuses it.

    Examples
    --------
    >>> read_raw(Path("nowhere.wav"))
    Traceback (most recent call last):
    models.errors.RecordingError: nowhere.wav: there is no such file
    """
    try:
        if path.is_dir():
            raise RecordingError(f"{path}: is a folder, not a recording")
        if not path.exists():
            raise RecordingError(f"{path}: there is no such file")
        if not path.is_file():
            raise RecordingError(f"{path}: is no regular file")
        if path.stat().st_size == 0:
            raise RecordingError(f"{path}: is empty (0 bytes)")
        if path.suffix.lower() not in READERS:
            known = ", ".join(READERS)
            raise RecordingError(f"{path}: has no ending of a recording; known are {known}")
        module, _, function = READERS[path.suffix.lower()].partition(":")
        reader: Reader = getattr(import_module(module), function)
        return reader(path)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror or error})") from error
    except MemoryError as error:
        raise RecordingError(f"{path}: needs more memory than there is") from error
