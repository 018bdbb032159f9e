"""Channels, condition and calibration of a file's samples: what a sample of 1.0 is worth.

The worth is decided per channel by the first of these that says something:

1. the caller's `full_scale`, an option or a calibrator's tone (pressure channels only), unless the
   samples are in a unit already: full scale is worth nothing there, and a note says so,
2. the sidecar: its ``scale``, or, for floating-point samples, that it names the channel, since
   such samples are then in the channel's unit; ``"calibrated": false`` silences 2 to 4,
3. the file's description, then its name, as sound level meters write them,
4. the file's comment,
5. the calibration of the chain, a curve from what it read to the quantity, as ``[sensors]`` in a
   rig file states it. A sidecar that names volts or counts as a channel's unit leaves it to 1 or 5;
   its ``scale`` is then in these units per full scale.

Unless every channel has its value the recording is not calibrated: its samples stay fractions of
full scale, and levels can be told in dBFS alone. Half a calibration would only invite comparing
what cannot be compared.

A WAV file has no field for calibration, so meters put it into the name of the file
(``..._FS129.9dB(PK)_00.wav``) or its description (``0dBFS = 109.7 dBSPL``,
``0dBFS = 2.40 mps2``). A stated level is that of the *peak* at full scale, so the sample 1.0 is
worth 20 uPa * 10^(L/20). The names say ``PK``, and the maker of these meters scales samples by that
same formula with the level of the description (NTi Audio, XL2 manual on WAV recording and support
note on scaling WAV files). Reading it as the rms of a full-scale sine would be 3 dB higher.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.calibration import READING_UNITS, Calibration
from models.condition import Condition
from models.errors import ParameterError, RecordingError
from models.recording import REFERENCE_PRESSURE, Channel
from noise.recordings.formats import RawRecording
from noise.recordings.sidecar import Sidecar, SidecarChannel, find_sidecar, sidecar_of

PascalPerFullScale = float | tuple[float, ...]
"""Pressure of a full-scale sample [Pa], of all tracks or of each."""

_LARGEST = 1e15
"""Of a sample in any unit: nothing on a rig is as large, and the squares of what is larger, of
which levels and spectra are made, lie beyond the numbers of single precision."""

_NUMBER = r"(-?\d{1,3}(?:[.,]\d{1,6})?)"
_IN_NAME = re.compile(rf"(?<![a-z0-9])FS\s*{_NUMBER}\s*dB[\s_(-]*PK(?![a-z0-9])", re.I | re.A)
_PRESSURE = re.compile(rf"0\s*dB\s*FS\s*=\s*{_NUMBER}\s*dB\s*SPL(?![a-z0-9])", re.I | re.A)
_ACCELERATION = re.compile(
    rf"0\s*dB\s*FS\s*=\s*{_NUMBER}\s*(?:mps2|m/s(?:\^?2|²))(?![a-z0-9])", re.I | re.A
)


@dataclass(frozen=True)
class Meaning:
    """What the samples of a file are.

    Parameters
    ----------
    channels : tuple of Channel
        With what a sample of 1.0 is worth.
    condition : Condition
    calibrated : bool
    curves : tuple of (Calibration or None)
        One a channel: from samples to values, where it takes more than a factor.
    notes : tuple of str
        What a reader should know of it, a line each.
    """

    channels: tuple[Channel, ...]
    condition: Condition
    calibrated: bool
    curves: tuple[Calibration | None, ...]
    notes: tuple[str, ...] = ()


def describe(
    path: Path,
    raw: RawRecording,
    full_scale: PascalPerFullScale | None = None,
    calibrations: Mapping[str, Calibration] | None = None,
) -> Meaning:
    """Decide what the samples of a file are, from all that says something about them.

    Parameters
    ----------
    path : Path
        The file, beside which the sidecar is sought.
    raw : RawRecording
    full_scale, calibrations
        As for `read_recording`.

    Returns
    -------
    Meaning

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
    >>> meaning = describe(Path("nowhere.wav"), raw, 2.0)
    >>> meaning.channels[0].name, meaning.channels[0].full_scale, meaning.calibrated
    ('pressure', 2.0, True)
    """
    options = _by_track(path, full_scale, raw.n_channels)
    sidecar_path, sidecar = find_sidecar(path), sidecar_of(path)
    n_channels = raw.n_channels
    if sidecar.channels is not None and len(sidecar.channels) != n_channels:
        raise RecordingError(
            f"{sidecar_path}: names {len(sidecar.channels)} channels, {path.name} has {n_channels}"
        )
    if not raw.fractional and any(one.scale is not None for one in sidecar.channels or ()):
        raise RecordingError(
            f"{sidecar_path}: gives a scale, but {path.name} holds floating-point samples, which "
            f"are in the channel's unit; remove the scale"
        )
    notes = [*raw.notes, *filter(None, [sidecar.note])]
    channels, curves = _interpret(path, raw, sidecar, options, calibrations or {}, notes)
    # The sidecar's word for the conditions, and the file's own where it has none.
    stated = {key: value for key, value in vars(sidecar.condition).items() if value is not None}
    condition = replace(raw.condition, **stated)
    return Meaning(channels, condition, bool(curves), curves or (None,) * n_channels, tuple(notes))


def _by_track(
    path: Path, full_scale: PascalPerFullScale | None, n_tracks: int
) -> tuple[float | None, ...]:
    """Return what a caller says of each track."""
    given = full_scale if isinstance(full_scale, tuple) else (full_scale,) * n_tracks
    for value in given:
        if value is not None and not 0 < value < math.inf:
            raise ParameterError(f"full scale is {value!r} Pa, expected a positive number")
    if len(given) != n_tracks:
        raise RecordingError(
            f"{path}: has {n_tracks} tracks, and full scale is given for {len(given)}; record the "
            "calibrator on as many, or on one for all"
        )
    return given


def check_finite(
    path: Path,
    samples: NDArray[np.float64],
    rate: float,
    channels: tuple[Channel, ...],
    start: int = 0,
) -> None:
    """Refuse samples that are no numbers, or too large to be squared in single precision.

    Parameters
    ----------
    path : Path
    samples : ndarray, shape (n_channels, n_samples)
        [units of the channels]
    rate : float
        Sampling rate [Hz].
    channels : tuple of Channel
    start : int
        Number of the first sample in the file.

    Raises
    ------
    RecordingError
        Says which sample of which channel is none.
    """
    for channel, row in zip(channels, samples, strict=True):
        # A value that is no number is the least and the most.
        if not (row.min(initial=0.0) >= -_LARGEST and row.max(initial=0.0) <= _LARGEST):
            first = int(np.argmin((row >= -_LARGEST) & (row <= _LARGEST)))
            raise RecordingError(
                f"{path}: channel {channel.name!r} is {row[first]} at sample {start + first} "
                f"({(start + first) / rate:.6g} s), expected finite numbers up to {_LARGEST:g}"
            )


def _interpret(
    path: Path,
    raw: RawRecording,
    sidecar: Sidecar,
    options: tuple[float | None, ...],
    calibrations: Mapping[str, Calibration],
    notes: list[str],
) -> tuple[tuple[Channel, ...], tuple[Calibration | None, ...]]:
    """Channels with the value of their full scale, and curves; none where a channel lacks both."""
    texts = (raw.description, path.name, raw.comment)
    stated = next((found for text in texts if (found := stated_full_scale(text))), None)
    channels = tuple(one.channel for one in sidecar.channels or ()) or raw.channels or ()
    if not channels:
        kind = "pressure" if stated is None or any(options) else stated.kind
        numbers = range(1, raw.n_channels + 1)
        channels = tuple(Channel(kind if i == 1 else f"{kind}_{i}") for i in numbers)
    named = sidecar.channels is not None or raw.channels is not None
    in_units = not raw.fractional and (named or sidecar.calibrated is True)
    said = sidecar.channels or [SidecarChannel(one.name) for one in channels]
    pairs: list[tuple[Channel, Calibration | None]] = []
    for channel, one, option in zip(channels, said, options, strict=True):
        scale, reading = one.scale, one.reading
        in_unit = sidecar.calibrated is not False and not reading
        if channel.kind == "pressure" and option is not None:
            if not (in_units and in_unit):
                pairs.append((replace(channel, full_scale=option), None))
                continue
            notes.append(
                f"{channel.name} is in {channel.unit} already; what full scale is worth "
                "(--full-scale, --calibrator) is not used"
            )
        metered = stated.value if stated and stated.kind == channel.kind else None
        value = scale or (1.0 if in_units else metered) if in_unit else None
        if value is not None:
            pairs.append((replace(channel, full_scale=value), None))
        elif channel.kind in calibrations:
            where = f"{path}: channel {channel.name!r}"
            curve = _curve(calibrations[channel.kind], reading, scale, raw.fractional, where)
            pairs.append((replace(channel, full_scale=abs(curve.gain)), curve))
        else:
            return channels, ()
    return tuple(channel for channel, _ in pairs), tuple(curve for _, curve in pairs)


def _curve(
    calibration: Calibration,
    reading: str,
    scale: float | None,
    fractional: bool,
    where: str,
) -> Calibration:
    """Return a calibration for samples as a file holds them."""
    given = scale if reading else None  # of a channel in its own unit, it was silenced
    if fractional and given is None and (reading or calibration.unit):
        unit = reading or calibration.unit
        raise RecordingError(
            f"{where} holds fractions of full scale, and {calibration.source} is in {unit}; state "
            f"its unit, {unit!r}, and scale, in {unit} per full scale, in the sidecar"
        )
    size = 1.0 if given is None else given
    if reading and calibration.unit:
        (read, one), (calibrated, other) = (READING_UNITS[u] for u in (reading, calibration.unit))
        if read != calibrated:
            raise RecordingError(
                f"{where} is in {reading}, and {calibration.source} in {calibration.unit}; "
                "calibrate it in the unit that is recorded"
            )
        size *= one / other
    return calibration.in_units_of(size)


class FullScale(NamedTuple):
    """The value of a full-scale sample.

    Parameters
    ----------
    kind : str
        ``"pressure"`` or ``"acceleration"``, as in `models.recording.CHANNEL_UNITS`.
    value : float
        [Pa] or [m/s^2].
    """

    kind: str
    value: float


def stated_full_scale(text: str) -> FullScale | None:
    """Find the value of full scale in a description, a comment or the name of a file.

    Parameters
    ----------
    text : str
        Anything at all.

    Returns
    -------
    FullScale or None
        None where the text states nothing.

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
    return float(match[1].replace(",", "."))
