"""Recordings that are looked at, kept in memory; long ones are read in parts."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import ExitStack
from dataclasses import dataclass, field
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.bands import REFERENCES
from models.errors import ParameterError, RecordingError
from noise.recordings import read_recording
from noise.recordings.blocks import RecordingBlocks, open_blocks

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from models.recording import Channel
    from noise.app.opened import Opened

__all__ = ["SoundCache", "Track"]

_KEPT = 6
"""Recordings in memory: two that are compared, and those beside them."""


@dataclass(frozen=True, eq=False)
class Track:
    """One channel of a recording.

    Parameters
    ----------
    channel : Channel
    calibrated : bool
    rate : float
        Sampling rate [Hz].
    n : int
        Samples.
    read : callable
        From first and last sample to the samples between them, shape (last - first,) [unit of the
        channel]; from any thread.
    """

    channel: Channel
    calibrated: bool
    rate: float
    n: int
    read: Callable[[int, int], NDArray[np.float64]]

    @property
    def duration(self) -> float:
        """Of the whole [s]."""
        return self.n / self.rate

    @property
    def in_full_scale(self) -> bool:
        """Whether it is sound whose pressure is not known, in fractions of full scale."""
        return self.channel.kind == "pressure" and not self.calibrated

    @property
    def unit(self) -> str:
        """Of its samples."""
        return "FS" if self.in_full_scale else self.channel.unit

    @property
    def reference(self) -> float:
        """Of its levels [unit of the samples]."""
        return 1.0 if self.in_full_scale else REFERENCES.get(self.channel.kind, 1.0)

    @property
    def level_unit(self) -> str:
        """Of its levels."""
        if self.in_full_scale:
            return "dBFS"
        if self.channel.kind == "pressure":
            return "dB re 20 µPa"
        return f"dB re {self.reference:g} {self.unit}"


@dataclass
class _Reading:
    """A recording that is read once, whoever asks first."""

    path: Path
    lock: Lock = field(default_factory=Lock)
    open: ExitStack = field(default_factory=ExitStack)
    blocks: RecordingBlocks | None = None

    def get(self) -> RecordingBlocks:
        with self.lock:
            if self.blocks is None:
                # It is closed when nobody holds it any more, who may be reading still.
                long = self.open.enter_context(open_blocks(self.path))
                self.blocks = long or RecordingBlocks.of(read_recording(self.path))
            return self.blocks


class SoundCache:
    """The recordings that were opened, of which the last few are kept.

    Parameters
    ----------
    opened : Opened
    """

    def __init__(self, opened: Opened) -> None:
        self._opened = opened
        self._lock = Lock()
        self._kept: OrderedDict[tuple[int, int, int], _Reading] = OrderedDict()

    def blocks(self, index: int) -> RecordingBlocks:
        """Return a recording, read anew where its file has changed.

        Raises
        ------
        ParameterError, RecordingError
            There is none of this number, or it cannot be read.
        """
        return self._reading(index).get()

    def track(self, index: int, name: str = "") -> Track:
        """Return a channel of a recording; by default the first of sound pressure, or any.

        Raises
        ------
        ParameterError, RecordingError
            There is none, or it cannot be read.
        """
        reading = self._reading(index)
        blocks = reading.get()
        names = [channel.name for channel in blocks.channels]
        if name and name not in names:
            raise ParameterError(f"channel {name!r}: {blocks.name} has {', '.join(names)}")
        row = names.index(name) if name else blocks.first("pressure") or 0

        def read(first: int, last: int) -> NDArray[np.float64]:
            with reading.lock:
                return np.asarray(blocks.read(first, last)[row])

        return Track(blocks.channels[row], blocks.calibrated, blocks.rate, blocks.n_samples, read)

    def _reading(self, index: int) -> _Reading:
        path = self._opened.job(index).path
        try:
            found = path.stat()
        except OSError as error:
            raise RecordingError(f"{path.name}: {error.strerror}") from None
        key = index, found.st_size, found.st_mtime_ns
        with self._lock:
            reading = self._kept.setdefault(key, _Reading(path))
            self._kept.move_to_end(key)
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return reading
