"""Recordings on disk: samples in one file and, where more is known, a sidecar of the same stem.

Formats are found in `noise.recordings.formats`; what the samples mean is decided in
`noise.recordings.meaning`, once for all of them.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.blocks import RecordingBlocks
from models.calibration import Calibration
from models.errors import RecordingError, naming
from models.foreign_file import reading, refusing
from models.recording import Recording
from noise.base.progress import note
from noise.recordings.folders import why_not_read
from noise.recordings.formats import RawRecording, check_rate, formats
from noise.recordings.formats.isolated import open_isolated
from noise.recordings.meaning import Meaning, PascalPerFullScale, check_finite, describe
from noise.recordings.rotation import find_turns
from noise.recordings.sidecar import sidecar_of

MIN_SAMPLES = 16
"""Fewer samples than this are no recording."""

_DENSEST = 8192  # samples a byte: FLAC holds silence in about 10 bytes a block of 65535 samples
_LARGE = 64 << 20
"""Recordings of fewer bytes, as 64-bit samples, are read whole."""

_CHUNK = 8 << 20
"""What is read at once of others [byte of 64-bit samples]."""

_noted: set[str] = set()


def read_recording(
    path: str | os.PathLike[str],
    *,
    full_scale: PascalPerFullScale | None = None,
    calibrations: Mapping[str, Calibration] | None = None,
) -> Recording:
    """Read a recording and what its sidecar, or the file itself, says about it.

    Parameters
    ----------
    path : path-like
        File with one of the endings of `noise.recordings.formats.formats`. A sidecar is the file
        of the same stem with the ending ``.json``. Without one each track of a sound file is a
        pressure channel (an acceleration channel where a meter says so).
    full_scale : float or tuple of float, optional
        Pressure of a full-scale sample [Pa], of all tracks or of each; wins over all that file and
        sidecar say, but for samples that are in a unit already.
    calibrations : mapping of str to Calibration, optional
        By kind of channel, for channels that neither file nor sidecar calibrates.

    Returns
    -------
    Recording
        Samples of shape (n_channels, n_samples), in the unit of each channel where `calibrated`,
        otherwise in fractions of full scale.

    Raises
    ------
    RecordingError
        The file or its sidecar cannot be read, or they contradict each other.
    ParameterError
        `full_scale` is not a positive number.

    Examples
    --------
    >>> import tempfile
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> samples, channels = np.full((1, 480), 30.0), (Channel("torque"),)
    >>> torque = Recording(samples, 48e3, channels, Condition(speed=5.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = read_recording(write_recording(Path(folder) / "run07", torque))
    >>> run.name, float(run["torque"].max()), run.condition.speed
    ('run07.wav', 30.0, 5.0)
    """
    path = Path(path)
    with refusing(str(path), "recording", RecordingError), open_raw(path) as raw:
        return _whole(path, raw, describe(path, raw, full_scale, calibrations))


@contextmanager
def open_blocks(
    path: str | os.PathLike[str], *, full_scale: PascalPerFullScale | None = None
) -> Iterator[RecordingBlocks]:
    """Open a recording of which parts are wanted; only what is looked at is read of a long one.

    Compressed sound that cannot be entered at a given sample is decoded from its beginning.

    Parameters
    ----------
    path : path-like
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording`.

    Yields
    ------
    RecordingBlocks
        Reading raises RecordingError where samples are missing or not finite.

    Raises
    ------
    RecordingError
        As for `read_recording`.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> torque = Recording(np.full((1, 480), 30.0), 48e3, (Channel("torque"),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_recording(Path(folder) / "run07", torque)
    ...     with open_blocks(path) as blocks:
    ...         float(blocks.read(100, 200).mean())
    30.0
    """
    path = Path(path)
    with ExitStack() as stack:
        with refusing(str(path), "recording", RecordingError):
            raw = stack.enter_context(open_raw(path))
            meaning = describe(path, raw, full_scale)
            if 8 * raw.n_channels * raw.n_samples < _LARGE:
                blocks = RecordingBlocks.of(_whole(path, raw, meaning))
                stack.close()
            else:
                blocks = _in_chunks(path, raw, meaning)
        yield blocks


@contextmanager
def open_raw(path: Path) -> Iterator[RawRecording]:
    """Open a recording, before anyone says what its samples mean.

    Raises
    ------
    RecordingError
        It cannot be read.
    """
    with ExitStack() as stack:
        with reading(path, "recording", error=RecordingError):
            if path.stat().st_size == 0:
                raise RecordingError(f"{path}: is empty (0 bytes)")
            of = formats().get(path.suffix.lower())
            if of is None:
                known = f"has no ending of a recording; known are {', '.join(formats())}"
                raise RecordingError(f"{path}: {why_not_read(path.name) or known}")
            raw = stack.enter_context((of.open or open_isolated)(path))
            check_rate(raw.rate, str(path))
            if raw.n_samples > _DENSEST * path.stat().st_size:
                raise RecordingError(
                    f"{path}: its header announces {raw.n_samples} samples, more than a file of "
                    "this size holds"
                )
            if raw.n_samples < MIN_SAMPLES:
                raise RecordingError(
                    f"{path}: holds {raw.n_samples} samples, expected at least {MIN_SAMPLES}"
                )
        yield raw


def _whole(path: Path, raw: RawRecording, meaning: Meaning) -> Recording:
    samples, channels = raw.whole(), meaning.channels
    beyond = _to_units(path, raw, meaning, samples)
    unwrapping = find_turns(
        channels, lambda a, b: samples[:, a:b], raw.n_samples, meaning.calibrated
    )
    unwrapping.add(samples, 0)
    notes = (*meaning.notes, *beyond, *unwrapping.notes)
    _say_once(path, notes)
    return Recording(
        samples, raw.rate, channels, meaning.condition, meaning.calibrated, path.name, notes
    )


def _in_chunks(path: Path, raw: RawRecording, meaning: Meaning) -> RecordingBlocks:
    """Return a long recording, in units, of which the last chunks that were read are kept."""
    channels = meaning.channels
    length = max(1, _CHUNK // (8 * raw.n_channels))

    @lru_cache(maxsize=2)
    def chunk(number: int) -> NDArray[np.float64]:
        start = number * length
        samples = raw.read(start, min(start + length, raw.n_samples))
        _to_units(path, raw, meaning, samples, start)
        return samples

    def read(first: int, last: int) -> NDArray[np.float64]:
        last = min(last, raw.n_samples)
        numbers = range(first // length, math.ceil(last / length))
        parts = [chunk(n)[:, max(0, first - n * length) : last - n * length] for n in numbers]
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)

    unwrapping = find_turns(channels, read, raw.n_samples, meaning.calibrated)
    _say_once(path, (*meaning.notes, *unwrapping.notes))

    def read_unwrapped(first: int, last: int) -> NDArray[np.float64]:
        samples = read(first, last)
        if unwrapping.jumps:
            samples = samples.copy()
            unwrapping.add(samples, first)
        return samples

    return RecordingBlocks(
        raw.rate, channels, meaning.condition, meaning.calibrated, path.name, raw.n_samples,
        read_unwrapped,
    )  # fmt: skip


def _to_units(
    path: Path, raw: RawRecording, meaning: Meaning, samples: NDArray[np.float64], start: int = 0
) -> list[str]:
    """Bring samples from number `start` on to their units, in place; return what to note of it."""
    notes = []
    with np.errstate(over="ignore", invalid="ignore"):  # found and refused below
        for channel, curve, row in zip(meaning.channels, meaning.curves, samples, strict=True):
            if curve is None:
                if channel.full_scale != 1.0:
                    row *= channel.full_scale
                continue
            with naming(f"{path}: channel {channel.name!r} ", RecordingError):
                out = curve.beyond(row)
                row[:] = curve.of(row)
            if out:
                notes.append(
                    f"{channel.name} was read up to {out:.1%} of its span outside of {curve.source}"
                )
    check_finite(path, samples, raw.rate, meaning.channels, start)
    return notes


def names_channels(path: Path) -> bool:
    """Whether a recording says what its channels are; the tracks of a plain sound file do not.

    Raises
    ------
    RecordingError
        Its sidecar cannot be read.

    Examples
    --------
    >>> names_channels(Path("stereo.wav")), names_channels(Path("run07.tdms"))
    (False, True)
    """
    of = formats().get(path.suffix.lower())
    logged = of is not None and of.open is None
    return logged or sidecar_of(path).channels is not None


def _say_once(path: Path, notes: Iterable[str]) -> None:
    """Print notes on a recording; one that is true of many files is printed for the first."""
    for text in notes:
        if text not in _noted:
            _noted.add(text)
            note(f"{path}: {text}")
