"""Samples, spectrograms and levels of recordings for the views of the app.

Recordings that are looked at are kept in memory; long ones are read in parts. Samples are played by
a page that has one gain for all calibrated sounds, so they are given as floating-point numbers, in
pascals where these are known. The meters are those of the label table.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from features.kernels.levels import REFERENCES
from features.kernels.weighting import sound_levels
from models.errors import ParameterError, RecordingError
from models.recording import Channel, RecordingBlocks
from noise.app.requests import number
from noise.audio.sound import RATE, playable
from noise.audio.spectrogram import (
    HIGHEST,
    LOWEST,
    Grid,
    spectrogram as levels_of,
)
from noise.recordings.files import open_blocks
from noise.recordings.wav import wav_bytes

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened

Query = Mapping[str, str]
Facts = dict[str, object]


_MOST_OPEN = 6
"""Number of recordings in memory."""


@dataclass(frozen=True, eq=False)
class Track:
    """Channel of a recording.

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
        """Duration [s]."""
        return self.n / self.rate

    @property
    def in_full_scale(self) -> bool:
        """Whether samples are fractions of full scale: sound without calibration."""
        return self.channel.kind == "pressure" and not self.calibrated

    @property
    def unit(self) -> str:
        """Unit of the samples."""
        return "FS" if self.in_full_scale else self.channel.unit

    @property
    def reference(self) -> float:
        """Reference of levels [unit of the samples]."""
        return 1.0 if self.in_full_scale else REFERENCES.get(self.channel.kind, 1.0)

    @property
    def level_unit(self) -> str:
        """Unit of levels."""
        if self.in_full_scale:
            return "dBFS"
        if self.channel.kind == "pressure":
            return "dB re 20 µPa"
        return f"dB re {self.reference:g} {self.unit}"


@lru_cache(_MOST_OPEN)
def _open(path: Path, *_state: int) -> tuple[RecordingBlocks, Lock, object]:
    """Open a recording in a state of its file; it is closed when nobody holds its context."""
    context = open_blocks(path)
    return context.__enter__(), Lock(), context


class SoundCache:
    """Cache of the recordings used last.

    Parameters
    ----------
    opened : Opened
    """

    def __init__(self, opened: Opened) -> None:
        self._opened = opened

    def blocks(self, index: int) -> RecordingBlocks:
        """Return a recording; a changed file is read again.

        Raises
        ------
        ParameterError, RecordingError
            The recording does not exist or cannot be read.
        """
        return self._reading(index)[0]

    def track(self, index: int, name: str = "") -> Track:
        """Return a channel of a recording; by default the first of sound pressure, or any.

        Raises
        ------
        ParameterError, RecordingError
            There is none, or it cannot be read.
        """
        reading = self._reading(index)
        blocks, lock, _ = reading
        names = [channel.name for channel in blocks.channels]
        if name and name not in names:
            raise ParameterError(f"channel {name!r}: {blocks.name} has {', '.join(names)}")
        row = names.index(name) if name else blocks.first("pressure") or 0

        def read(first: int, last: int) -> NDArray[np.float64]:
            with lock:
                return np.asarray(reading[0].read(first, last)[row])

        return Track(blocks.channels[row], blocks.calibrated, blocks.rate, blocks.n_samples, read)

    def _reading(self, index: int) -> tuple[RecordingBlocks, Lock, object]:
        path = self._opened.job(index).path
        try:
            status = path.stat()
        except OSError as error:
            raise RecordingError(f"{path.name}: {error.strerror}") from None
        return _open(path, status.st_size, status.st_mtime_ns)


def read_stretch(query: Query, track: Track, longest: float = math.inf) -> tuple[int, int]:
    """Parse the interval `start` to `end` of a request; by default the whole recording.

    Parameters
    ----------
    query : mapping of str to str
    track : Track
    longest : float
        Maximum duration [s].

    Returns
    -------
    first, last : int
        Samples.

    Raises
    ------
    ParameterError
        The interval is empty.
    """
    start = number(query, "start", 0.0, math.inf, 0.0)
    end = number(query, "end", 0.0, math.inf, track.duration)
    first = round(min(start * track.rate, track.n))
    last = round(min(end * track.rate, track.n, (start + longest) * track.rate))
    if first >= last:
        raise ParameterError(
            f"{start:g} to {end:g} s: must be a stretch of the {track.duration:g} s that there are"
        )
    return first, last


_LONGEST_PLAYED = 600.0
"""Maximum duration of one answer [s]."""

_LONGEST_BANDS = 120.0
"""Maximum interval for band levels [s]."""


def wav(track: Track, query: Query) -> bytes:
    """Return an interval as a WAV file of floats in the unit of the channel."""
    first, last = read_stretch(query, track, _LONGEST_PLAYED)
    return wav_bytes(playable(track.read(first, last), track.rate), RATE, 32)


def bands(track: Track, query: Query) -> dict[str, object]:
    """Return levels and third-octave levels of an interval."""
    first, last = read_stretch(query, track, _LONGEST_BANDS)
    signal = track.read(first, last)
    measured = sound_levels(signal, track.rate, reference=track.reference)
    octaves = {band: _plain(level) for band, level in measured.third_octaves.items()}
    return {
        "start": first / track.rate,
        "end": last / track.rate,
        "unit": track.level_unit,
        "level": _plain(measured.level),
        "level_a": _plain(measured.level_a),
        "level_af_max": _plain(measured.level_af_max),
        "third_octaves": octaves,
    }


def _plain(level: float) -> float | None:
    """Return a level as a JSON value; None for silence."""
    return round(level, 2) if math.isfinite(level) else None


_STEP = 0.5
"""Step of levels coded as bytes [dB]."""

_ROUND = 5.0
"""Rounding of the highest level [dB]."""

_WINDOW = (0.01, 0.04)
"""Minimum and maximum frame [s]."""

_COLUMNS = 8.0
"""Columns per frame in between [-]."""


def outline(track: Track, query: Query) -> tuple[Facts, NDArray[np.float32]]:
    """Return minimum and maximum of the samples in each column, shape (2, width)."""
    begin, end = read_stretch(query, track)
    width = min(end - begin, int(number(query, "width", 1, 4000, 1000)))
    edges = np.linspace(begin, end, width + 1).astype(int)
    ends = np.empty((2, width), np.float32)
    columns = max(1, (1 << 22) * width // (end - begin))  # read at once
    for column in range(0, width, columns):
        part = edges[column : column + columns + 1]
        samples = track.read(int(part[0]), int(part[-1]))
        for row, extreme in enumerate((np.minimum, np.maximum)):
            ends[row, column : column + columns] = extreme.reduceat(samples, part[:-1] - part[0])
    facts: Facts = {"start": begin / track.rate, "end": end / track.rate, "unit": track.unit}
    return facts, ends


def spectrogram(track: Track, query: Query) -> tuple[Facts, NDArray[np.uint8]]:
    """Return levels coded as bytes, highest frequency first, shape (height, width)."""
    begin, end = read_stretch(query, track)
    highest = min(HIGHEST, 0.5 * track.rate)
    lowest = min(LOWEST, 0.01 * highest)
    width = int(number(query, "width", 16, 4000, 1000))
    height = int(number(query, "height", 16, 1024, 256))
    shortest, longest = (seconds * track.rate for seconds in _WINDOW)
    length = min(max(_COLUMNS * (end - begin) / width, shortest), longest)
    length = 1 << round(math.log2(max(length, 64.0)))
    grid = Grid(begin, end, width, height, lowest, highest, length, padding=2)
    levels = levels_of(track.read, track.n, track.rate, track.reference, grid)
    top = _ROUND * math.ceil(float(levels.max()) / _ROUND)
    floor = top - 255 * _STEP
    facts: Facts = {
        "start": begin / track.rate,
        "end": end / track.rate,
        "low": lowest,
        "high": highest,
        "width": width,
        "height": height,
        "floor": floor,
        "step": _STEP,
        "unit": track.level_unit,
    }
    return facts, np.clip(np.rint((levels - floor) / _STEP), 0, 255).astype(np.uint8)


def routes(opened: Opened) -> list[BaseRoute]:
    """Return the routes of recordings by number."""
    sounds = SoundCache(opened)

    def about(request: Request) -> Response:
        from noise.labels.rows import labelled_tracks  # which the list comes before

        index = request.path_params["id"]
        blocks = sounds.blocks(index)
        tracks = [sounds.track(index, channel.name) for channel in blocks.channels]
        channels = [
            {"name": of.channel.name, "kind": of.channel.kind, "unit": of.unit} for of in tracks
        ]
        played = sounds.track(index)
        return JSONResponse(
            {
                "id": index,
                "name": opened.job(index).name,
                "channels": channels,
                "tracks": labelled_tracks(opened.job(index).path, len(channels)),
                "channel": played.channel.name,
                "rate": blocks.rate,
                "duration_s": played.duration,
                "calibrated": blocks.calibrated,
                "conditions": blocks.condition.words,
            }
        )

    def of_track(answer: Callable[[Track, Query], Response]) -> Callable[[Request], Response]:
        def endpoint(request: Request) -> Response:
            query = request.query_params
            return answer(sounds.track(request.path_params["id"], query.get("channel", "")), query)

        return endpoint

    def audio(*given: Any) -> Response:
        return Response(wav(*given), media_type="audio/wav")

    at = "/api/sounds/{id:int}"
    return [
        Route(at, about),
        Route(f"{at}/audio", of_track(audio)),
        Route(f"{at}/outline", of_track(lambda *given: _framed(*outline(*given)))),
        Route(f"{at}/spectrogram", of_track(lambda *given: _framed(*spectrogram(*given)))),
        Route(f"{at}/bands", of_track(lambda *given: JSONResponse(bands(*given)))),
    ]


def _framed(facts: Facts, values: NDArray[np.generic]) -> Response:
    """Return length of the header, JSON header padded to 4 bytes, and values as one response."""
    head = json.dumps(facts).encode()
    head += b" " * (-len(head) % 4)
    content = len(head).to_bytes(4, "little") + head + values.tobytes()
    return Response(content, media_type="application/octet-stream")
