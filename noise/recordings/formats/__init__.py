"""File formats of recordings, one module each, registered by file suffix.

Each module of this package with a `FORMAT` is a format. Sound files are opened by `Format.open`.
Logger files are opened by `Format.channels` and read in a separate process. Readers return only
what the file states; `noise.recordings.interpretation` interprets the samples of all formats.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError
from models.recording import Channel

if TYPE_CHECKING:
    from noise.recordings.formats.logged import LoggedChannel

LOWEST_RATE, HIGHEST_RATE = 1.0, 400e3
"""Range of sampling rates [Hz]; filters and windows grow with the rate."""


Read = Callable[[int, int], NDArray[np.float64]]
"""``read(first, last)`` returns the samples from `first` up to, not including, `last`."""

_BLOCK = 1 << 16  # samples per channel


@dataclass(frozen=True, eq=False)
class RawRecording:
    """Open file with uninterpreted samples and the metadata that it states.

    Parameters
    ----------
    n_channels, n_samples : int
    rate : float
        Sampling rate [Hz].
    fractional : bool
        Whether samples are fractions of full scale (integer and lossy formats) in place of
        floating-point values.
    read : callable
        ``read(first, last)`` returns stored samples, shape (n_channels, last - first); over full
        scale [-] if `fractional`.
    description, comment : str
        Free text in the file, which may state a calibration.
    channels : tuple of Channel, optional
        Channels that the file states; samples are in their units.
    notes : tuple of str
        Notes for the user, one line each.
    """

    n_channels: int
    n_samples: int
    rate: float
    fractional: bool
    read: Read
    description: str = ""
    comment: str = ""
    channels: tuple[Channel, ...] | None = None
    notes: tuple[str, ...] = ()

    def whole(self) -> NDArray[np.float64]:
        """Read all samples, shape (n_channels, n_samples), without further large arrays."""
        samples = np.empty((self.n_channels, self.n_samples))
        for first in range(0, self.n_samples, _BLOCK):
            last = min(first + _BLOCK, self.n_samples)
            samples[:, first:last] = self.read(first, last)
        return samples


@dataclass(frozen=True)
class Format:
    """File format of recordings.

    Parameters
    ----------
    name : str
    endings : tuple of str
        File suffixes in lower case, with the dot.
    open : callable, optional
        Context manager from a path to a `RawRecording`, for sound files.
    channels : callable, optional
        Context manager from a path to channels, for logger files.
    library, extra : str
        Library of a logger format, and the extra that installs it.
    """

    name: str
    endings: tuple[str, ...]
    open: Callable[[Path], AbstractContextManager[RawRecording]] | None = None
    channels: Callable[[Path], AbstractContextManager[Sequence[LoggedChannel]]] | None = None
    library: str = ""
    extra: str = ""


@cache
def formats() -> Mapping[str, Format]:
    """Return the formats by suffix in lower case.

    Examples
    --------
    >>> formats()[".mf4"].name
    'MDF'
    """
    modules = (import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__))
    known = [module.FORMAT for module in modules if hasattr(module, "FORMAT")]
    return dict(sorted((ending, one) for one in known for ending in one.endings))


def check_rate(rate: float, where: str) -> None:
    """Refuse an implausible sampling rate [Hz].

    Raises
    ------
    RecordingError
        The rate is outside 1 Hz to 400 kHz, or NaN.

    Examples
    --------
    >>> check_rate(1e8, "run.wav")
    Traceback (most recent call last):
    models.errors.RecordingError: run.wav: sampling rate is 1e+08 Hz, expected 1 Hz to 400 kHz
    """
    if not LOWEST_RATE <= rate <= HIGHEST_RATE:
        raise RecordingError(f"{where}: sampling rate is {rate:g} Hz, expected 1 Hz to 400 kHz")
