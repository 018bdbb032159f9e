"""Formats that recordings come in: one module each, found here by the endings of its files.

A module of this package with a `FORMAT` is a format; no list repeats it. A sound file is opened by
`Format.open`. A logger's file is described by `Format.channels` and read in a process of its own.
A reader returns what the file states and nothing more; what samples mean is decided in
`noise.recordings.meaning`, once for all formats.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import RecordingError
from models.recording import Channel

if TYPE_CHECKING:
    from noise.recordings.formats.logged import LoggedChannel

LOWEST_RATE, HIGHEST_RATE = 1.0, 400e3
"""Sampling rates that are possible [Hz]; filters and windows grow with them."""


Read = Callable[[int, int], NDArray[np.float64]]
"""From first and last sample (exclusive) to those between them."""

_BLOCK = 1 << 16  # samples a channel


@dataclass(frozen=True, eq=False)
class RawRecording:
    """An open file and what it states of its samples, before anyone decides what they mean.

    Parameters
    ----------
    n_channels, n_samples : int
    rate : float
        Sampling rate [Hz].
    fractional : bool
        Whether samples are coded as fractions of a full scale (integers, lossy formats) and not
        as floating-point values of their own.
    read : callable
        From first and last sample to those between them as stored, shape (n_channels, n); over
        full scale [-] where `fractional`.
    description, comment : str
        Free text in the file, where meters and engineers note a calibration.
    channels : tuple of Channel, optional
        Where the file itself says what it measures: samples are in the channels' units.
    condition : Condition
        As far as the file itself states it.
    notes : tuple of str
        What a reader should know of it, a line each.
    """

    n_channels: int
    n_samples: int
    rate: float
    fractional: bool
    read: Read
    description: str = ""
    comment: str = ""
    channels: tuple[Channel, ...] | None = None
    condition: Condition = field(default_factory=Condition)
    notes: tuple[str, ...] = ()

    def whole(self) -> NDArray[np.float64]:
        """Read all samples, shape (n_channels, n_samples), in the memory of the result alone."""
        samples = np.empty((self.n_channels, self.n_samples))
        for first in range(0, self.n_samples, _BLOCK):
            last = min(first + _BLOCK, self.n_samples)
            samples[:, first:last] = self.read(first, last)
        return samples


Logged = tuple[Sequence["LoggedChannel"], Mapping[str, object]]
"""Channels of a logger's file, and its properties, among which a condition may be."""


@dataclass(frozen=True)
class Format:
    """A file format.

    Parameters
    ----------
    name : str
    endings : tuple of str
        In lower case, with the dot.
    open : callable, optional
        From a path to a context that gives a `RawRecording`; of sound files.
    channels : callable, optional
        From a path to a context that gives its channels and properties; of loggers' files.
    library, extra : str
        What a logger's format needs, and the extra that installs it.
    """

    name: str
    endings: tuple[str, ...]
    open: Callable[[Path], AbstractContextManager[RawRecording]] | None = None
    channels: Callable[[Path], AbstractContextManager[Logged]] | None = None
    library: str = ""
    extra: str = ""


@cache
def formats() -> Mapping[str, Format]:
    """Return the formats by ending, in lower case.

    Examples
    --------
    >>> formats()[".mf4"].name
    'MDF'
    """
    modules = (import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__))
    found = [module.FORMAT for module in modules if hasattr(module, "FORMAT")]
    return dict(sorted((ending, one) for one in found for ending in one.endings))


def check_rate(rate: float, where: str) -> None:
    """Refuse a sampling rate [Hz] that no recording of sound or motion has.

    Raises
    ------
    RecordingError
        It lies outside of 1 Hz to 400 kHz, or is no number.

    Examples
    --------
    >>> check_rate(1e8, "run.wav")
    Traceback (most recent call last):
    models.errors.RecordingError: run.wav: sampling rate is 1e+08 Hz, expected 1 Hz to 400 kHz
    """
    if not LOWEST_RATE <= rate <= HIGHEST_RATE:
        raise RecordingError(f"{where}: sampling rate is {rate:g} Hz, expected 1 Hz to 400 kHz")
