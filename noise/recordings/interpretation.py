"""Channels, condition and calibration of a file: the physical value of a sample of 1.0.

The value of full scale of each channel comes from the first of these sources that states it:

1. the caller's `full_scale`, from an option or a calibrator's tone (pressure channels only); it is
   ignored with a note for samples that are already in a unit,
2. the sidecar: its ``scale``, such as N m per volt where a logger stored volts, or, for
   floating-point samples without one, the name of the channel, because such samples are in the
   unit of the channel; ``"calibrated": false`` disables 2 to 4,
3. the description in the file, then its name, as sound level meters write them,
4. the comment in the file.

Unless every channel has a value, the recording is not calibrated: samples remain fractions of full
scale, and levels are in dBFS. A partial calibration would invite wrong comparisons.

WAV files have no field for calibration, so meters write it into the name of the file
(``..._FS129.9dB(PK)_00.wav``) or its description (``0dBFS = 109.7 dBSPL``,
``0dBFS = 2.40 mps2``). The level is that of the *peak* at full scale: the sample 1.0 is
20 uPa * 10^(L/20). The names say ``PK``, and the manufacturer scales samples by that formula (NTi
Audio, XL2 manual on WAV recording and support note on scaling WAV files). The rms level of a
full-scale sine would be 3 dB lower.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError, RecordingError
from models.recording import REFERENCE_PRESSURE, Channel
from noise.recordings.formats import RawRecording
from noise.recordings.sidecar import Sidecar, find_sidecar, sidecar_of

_LARGEST = 1e15
"""Largest sample in any unit. No quantity of a rig is as large, and the squares of larger samples
overflow in single precision."""

_NUMBER = r"(-?\d{1,3}(?:[.,]\d{1,6})?)"
_IN_NAME = re.compile(rf"(?<![a-z0-9])FS\s*{_NUMBER}\s*dB[\s_(-]*PK(?![a-z0-9])", re.I | re.A)
_PRESSURE = re.compile(rf"0\s*dB\s*FS\s*=\s*{_NUMBER}\s*dB\s*SPL(?![a-z0-9])", re.I | re.A)
_ACCELERATION = re.compile(
    rf"0\s*dB\s*FS\s*=\s*{_NUMBER}\s*(?:mps2|m/s(?:\^?2|²))(?![a-z0-9])", re.I | re.A
)


@dataclass(frozen=True)
class Metadata:
    """Channels, condition and calibration of a file.

    Parameters
    ----------
    channels : tuple of Channel
        Channels with the value of a sample of 1.0.
    condition : Condition
    calibrated : bool
    notes : tuple of str
        Notes for the user, one line each.
    """

    channels: tuple[Channel, ...]
    condition: Condition
    calibrated: bool
    notes: tuple[str, ...] = ()


def interpret(path: Path, raw: RawRecording, full_scale: float | None) -> Metadata:
    """Return the channels, condition and calibration of a file.

    Parameters
    ----------
    path : Path
        The file; its sidecar lies beside it.
    raw : RawRecording
    full_scale : float, optional
        Pressure of a full-scale sample [Pa]; see `noise.recordings.read_recording`.

    Returns
    -------
    Metadata

    Raises
    ------
    RecordingError
        The sidecar cannot be read, or contradicts the file.
    ParameterError
        `full_scale` is not a positive number.

    Examples
    --------
    >>> from pathlib import Path
    >>> from noise.recordings.formats import RawRecording
    >>> raw = RawRecording(1, 480, 48e3, fractional=True, read=lambda a, b: np.zeros((1, b - a)))
    >>> result = interpret(Path("nowhere.wav"), raw, 2.0)
    >>> result.channels[0].name, result.channels[0].full_scale, result.calibrated
    ('pressure', 2.0, True)
    """
    if full_scale is not None and not 0 < full_scale < math.inf:
        raise ParameterError(f"full scale is {full_scale!r} Pa, expected a positive number")
    sidecar_path, sidecar = find_sidecar(path), sidecar_of(path)
    n_channels = raw.n_channels
    if sidecar.channels is not None and len(sidecar.channels) != n_channels:
        raise RecordingError(
            f"{sidecar_path}: names {len(sidecar.channels)} channels, {path.name} has {n_channels}"
        )
    notes = [*raw.notes, *filter(None, [sidecar.note])]
    channels, calibrated = _calibrated(path, raw, sidecar, full_scale, notes)
    return Metadata(channels, sidecar.condition, calibrated, tuple(notes))


def check_finite(
    path: Path,
    samples: NDArray[np.float64],
    rate: float,
    channels: tuple[Channel, ...],
    start: int = 0,
) -> None:
    """Refuse samples that are not finite, or too large to be squared in single precision.

    Parameters
    ----------
    path : Path
    samples : ndarray, shape (n_channels, n_samples)
        [units of the channels]
    rate : float
        Sampling rate [Hz].
    channels : tuple of Channel
    start : int
        Index of the first sample in the file.

    Raises
    ------
    RecordingError
        The message names the channel and the sample.
    """
    for channel, row in zip(channels, samples, strict=True):
        # NaN propagates through min and max, and fails both comparisons.
        if not (row.min(initial=0.0) >= -_LARGEST and row.max(initial=0.0) <= _LARGEST):
            first = int(np.argmin((row >= -_LARGEST) & (row <= _LARGEST)))
            raise RecordingError(
                f"{path}: channel {channel.name!r} is {row[first]} at sample {start + first} "
                f"({(start + first) / rate:.6g} s), expected finite numbers up to {_LARGEST:g}"
            )


def _calibrated(
    path: Path, raw: RawRecording, sidecar: Sidecar, full_scale: float | None, notes: list[str]
) -> tuple[tuple[Channel, ...], bool]:
    """Return channels with the value of full scale, and whether all of them have one."""
    texts = (raw.description, path.name, raw.comment)
    stated = next(filter(None, map(stated_full_scale, texts)), None)
    channels = tuple(one.channel for one in sidecar.channels or ()) or raw.channels or ()
    if not channels:
        kind = "pressure" if stated is None or full_scale is not None else stated.kind
        numbers = range(1, raw.n_channels + 1)
        channels = tuple(Channel(kind if i == 1 else f"{kind}_{i}") for i in numbers)
    named = sidecar.channels is not None or raw.channels is not None
    in_units = not raw.fractional and (named or sidecar.calibrated is True)
    scales = [one.scale for one in sidecar.channels or ()] or [None] * len(channels)
    values: list[float | None] = []
    for channel, scale in zip(channels, scales, strict=True):
        metered = stated.value if stated and stated.kind == channel.kind else None
        value = scale or (1.0 if in_units else metered)
        value = None if sidecar.calibrated is False else value
        if channel.kind == "pressure" and full_scale is not None:
            if in_units and value == 1.0:
                notes.append(
                    f"{channel.name} is in {channel.unit} already; the value of full scale "
                    "(--full-scale, --calibrator) is ignored"
                )
            else:
                value = full_scale
        values.append(value)
    known = [value for value in values if value is not None]
    if len(known) < len(values):
        return channels, False
    pairs = zip(channels, known, strict=True)
    return tuple(replace(channel, full_scale=value) for channel, value in pairs), True


class FullScale(NamedTuple):
    """Physical value of a full-scale sample.

    Parameters
    ----------
    kind : str
        ``"pressure"`` or ``"acceleration"``.
    value : float
        [Pa] or [m/s^2].
    """

    kind: str
    value: float


def stated_full_scale(text: str) -> FullScale | None:
    """Parse the value of full scale from a description, a comment or a file name.

    Parameters
    ----------
    text : str

    Returns
    -------
    FullScale or None
        None if the text states no value.

    Examples
    --------
    >>> stated_full_scale("2019-10-17_SLM_012_Audio_FS94.0dB(PK)_00.wav")
    FullScale(kind='pressure', value=1.002...)
    >>> stated_full_scale("Vibration: 0dBFS = 2.40 mps2 Time Zone: UTC-09:00 (DST)")
    FullScale(kind='acceleration', value=2.4)
    >>> stated_full_scale("rainy, some traffic") is None
    True
    """
    for pattern in (_IN_NAME, _PRESSURE):
        if level := pattern.search(text):
            return FullScale("pressure", REFERENCE_PRESSURE * 10 ** (_number(level) / 20))
    if (value := _ACCELERATION.search(text)) and _number(value) > 0:
        return FullScale("acceleration", _number(value))
    return None


def _number(match: re.Match[str]) -> float:
    """Return the number of a match, which may have a decimal comma."""
    return float(match[1].replace(",", "."))
