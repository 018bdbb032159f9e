"""Noise and resolution of sensors that the rig file does not state, by the recordings.

All samples are multiples of the step of their converter. A recording has no silence, but well above
the frequencies of the rig it contains little but noise for a few milliseconds between slips. The
noise is estimated from the quietest short segments in the quietest bands of the quietest
recordings. A floor that bands and conditions have in common is white and belongs to the sensor. The
noise of a sensor varies between recordings; the estimate is a quantile of theirs.

Limits of the method: white noise of equal level in all recordings counts as sensor noise at any
level. Coloured noise, and noise that is louder in some recordings, does not, and remains a
difference to the simulation. Noise far below the step of the converter cannot be estimated and has
little influence.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import gamma

from features.kernels.spectra import segment_spectra
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensor
from models.units import CHANNEL_UNITS
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import USABLE
from sim.acquisition import Acquisition

_LENGTH, _FEWEST_SEGMENTS = 128, 20
"""Length of a segment, a few milliseconds [samples], and least number of segments; assumed."""

_BANDS, _LOWEST, _LOWEST_SHARE = 4, 500.0, 0.18
"""Number of bands, and their lower limit: the larger of a frequency [Hz] and a share of the
rate [-]; the upper limit is `USABLE`; assumed."""

_QUIETEST = (0.05, 0.2)
"""Quantiles of the segments' power at which the noise floor is read [-]; assumed."""

_OVERLAP = 1.94
"""Number of lines of a Hann window per independent line [-]: 1 + 2 (4/9 + 1/36), from the squares
of the correlations of neighbouring lines."""

_ALIKE, _ALIKE_RECORDINGS = 1.5, 2.5
"""Largest ratio of the powers of two bands, and of two recordings, with the same white floor [-];
assumed. The noise amplitude of a sensor varies by up to a half between recordings."""

_MIDDLE = 1.0 / 3.0
"""Quantile of the recordings' floors that is the noise [-]; signals may raise the louder floors;
assumed."""

_ABOVE_STEP = 0.4
"""Least white noise, as a share of the converter's step, that differs from rounding [-];
assumed."""


def estimated_noise(recordings: Sequence[Recording], kind: str, step: float = 0.0) -> float | None:
    """Estimate the noise of the sensor of a kind of channel.

    Parameters
    ----------
    recordings : sequence of Recording
        Recordings in physical units.
    kind : str
        Kind of the channel.
    step : float
        Step of the converter, whose rounding is subtracted [unit of the channel].

    Returns
    -------
    float, optional
        Standard deviation of white noise over the whole band [unit of the channel]; None if the
        recordings are too short, do not have the channel, or have no common white floor.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> noise = 0.02 * np.random.default_rng(0).standard_normal((1, 60_000))
    >>> tone = np.sin(2 * np.pi * 440 * np.arange(60_000) / 30e3)
    >>> run = Recording(tone + noise, 30e3, (Channel("torque"),))
    >>> round(estimated_noise([run], "torque"), 3)
    0.02
    """
    floors = []
    for recording in recordings:
        row = recording.first(kind)
        bands = None if row is None else _floors(recording.samples[row], recording.rate)
        if bands is not None:
            lower, higher = bands
            floors.append(0.5 * (lower + higher) if higher <= _ALIKE * lower else np.inf)
    quietest = min(floors, default=np.inf)
    alike = [power for power in floors if power <= _ALIKE_RECORDINGS * quietest < np.inf]
    if len(alike) < min(len(floors), 2) or not alike:
        return None
    level = float(np.sqrt(np.quantile(alike, _MIDDLE)))
    if level < _ABOVE_STEP * step:
        return None
    return float(np.sqrt(max(level**2 - step**2 / 12.0, 0.0)))


def _floors(x: Array, rate: float) -> tuple[float, float] | None:
    """Return the power of the two quietest bands of a signal [unit^2]; None if it is too short."""
    t = np.arange(x.size)
    x = x - (x[0] + (x[-1] - x[0]) / max(x.size - 1, 1) * t)  # removes the trend of an angle
    if x.size < _LENGTH * (_FEWEST_SEGMENTS + 1) // 2:
        return None
    first = int(np.ceil(max(_LOWEST / rate, _LOWEST_SHARE) * _LENGTH))
    lines = np.abs(segment_spectra(x, _LENGTH)[:, first : int(USABLE * _LENGTH) + 1]) ** 2
    width = lines.shape[1] // _BANDS
    bands = lines[:, lines.shape[1] - width * _BANDS :].reshape(len(lines), _BANDS, width)
    free = width / _OVERLAP
    share = gamma.ppf(_QUIETEST, free) / free
    quiet = np.quantile(bands.mean(axis=2), _QUIETEST, axis=0) / share[:, None]
    lowest = np.sort(quiet.min(axis=0))
    return float(lowest[0]), float(lowest[1])


_ROUNDED, _CLEAR = 2.0**-22, 20.0
"""Rounding error of samples stored in 32 bits, relative to the largest sample [-], and least ratio
of a step to it [-]; assumed."""

_SAME = 1e-4
"""Largest relative difference of the steps of recordings through one converter [-]; assumed."""

_FEWEST = 3
"""Least number of different values for an estimate of the step."""


def converter_step(recordings: Sequence[Recording], kind: str) -> float:
    """Estimate the step of the converter of a kind of channel.

    Parameters
    ----------
    recordings : sequence of Recording
    kind : str
        Kind of the channel.

    Returns
    -------
    float
        Step [unit of the channel]; 0 if there is none or if it differs between recordings.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> x = 0.05 * np.random.default_rng(0).integers(-40, 40, (1, 3000))
    >>> run = Recording(x.astype(np.float32).astype(float), 30e3, (Channel("torque"),))
    >>> round(converter_step([run], "torque"), 6)
    0.05
    """
    signals = channel_signals(recordings, kind)
    steps = np.array([_step(values) for x in signals if (values := np.unique(x)).size >= _FEWEST])
    middle = float(np.median(steps)) if steps.size else 0.0
    return middle if np.allclose(steps, middle, rtol=_SAME, atol=0.0) else 0.0


def channel_signals(recordings: Sequence[Recording], kind: str) -> list[Array]:
    """Return the samples of the first channel of a kind in the recordings that have one.

    Parameters
    ----------
    recordings : sequence of Recording
    kind : str

    Returns
    -------
    list of ndarray, shape (n_samples,)
        [unit of the channel]
    """
    return [r.samples[row] for r in recordings if (row := r.first(kind)) is not None]


def _step(values: Array) -> float:
    """Return the step of which differences of sorted values are multiples; 0 if there is none."""
    error = _ROUNDED * float(np.abs(values).max())
    apart = np.diff(values)
    step = float(apart.min())
    for reach in (1.5, 4.5, 64.5, np.inf):  # the error of the step is multiplied by their number
        near = apart[apart <= reach * step]
        step = float(near.sum() / np.round(near / step).sum())
    away = np.abs(apart - step * np.round(apart / step)).max()
    return step if step > _CLEAR * error and away <= 2.0 * error else 0.0


_BITS = 24
"""Bits of the converter that represents a step if the range is unknown; signals stay within it."""


def with_estimated_sensors(
    rig: Rig, recordings: Sequence[Recording]
) -> tuple[Rig, tuple[str, ...]]:
    """Return a rig with noise and resolution of its sensors estimated from recordings.

    Stated values are kept. Noise that cannot be estimated stays that of good sensors.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    rig : Rig
        The rig with estimated sensors.
    notes : tuple of str
        One line each on estimated noise and steps, and noise that cannot be estimated.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> noise = 0.01 * np.random.default_rng(0).standard_normal((1, 60_000))
    >>> run = Recording(noise, 30e3, (Channel("torque"),))
    >>> rig, notes = with_estimated_sensors(load_material_rig("fluorocarbon-thesis"), [run])
    >>> round(rig.sensors.of("torque").noise, 3), notes
    (0.01, ('noise of the sensors (white, RMS), by the recordings: torque 0.01 N m; ...',))
    """
    usual = Acquisition().noise
    sensors = dict(rig.sensors.by_kind)
    estimated, unknown, steps = [], [], []
    recorded = dict.fromkeys(c.kind for r in recordings for c in r.channels if c.kind in usual)
    for kind in recorded:
        sensor, unit = rig.sensors.of(kind), CHANNEL_UNITS[kind]
        if not sensor.step and (step := converter_step(recordings, kind)):
            sensor = _in_steps(sensor, step)
            steps.append(f"{kind} {step:.2g} {unit}")
        if sensor.noise is None:
            level = estimated_noise(recordings, kind, sensor.step)
            sensor = replace(sensor, noise=level)
            if level is None:
                unknown.append(kind)
            else:
                estimated.append(f"{kind} {level:.2g} {unit}")
        sensors[kind] = sensor
    notes = []
    if estimated:
        notes.append(
            f"noise of the sensors (white, RMS), by the recordings: {', '.join(estimated)}; "
            "constant room noise is counted as sensor noise, unless [sensors] of the rig file "
            "states less"
        )
    if steps:
        notes.append(f"steps of the converter, by the recordings: {', '.join(steps)}")
    if unknown:
        notes.append(
            f"noise of the sensors of {', '.join(unknown)}: these recordings do not determine it "
            "(no white floor between the slips); that of good sensors is assumed, which [sensors] "
            "of the rig file can replace"
        )
    return replace(rig, sensors=replace(rig.sensors, by_kind=sensors)), tuple(notes)


def _in_steps(sensor: Sensor, step: float) -> Sensor:
    """Return a sensor with a converter of a given step [unit of the channel].

    A sensor with a stated range is unchanged if no number of bits gives the step.
    """
    if sensor.full_scale is None:
        return replace(sensor, full_scale=math.ldexp(step, _BITS - 1), bits=_BITS)
    bits = 1 + math.log2(sensor.full_scale / step)
    whole = round(bits)
    return replace(sensor, bits=whole) if abs(bits - whole) < 1e-3 else sensor
