"""Preparation of recordings and of their rig for a comparison.

The steps are: cut off the start, set the speed from the angle, estimate the noise and resolution of
sensors that the rig file does not state, and shorten and decimate long or finely sampled
recordings.

A simulation is as long and as finely sampled as the recording that it is compared with, and is
repeated many times. Two seconds contain at least a hundred slips, and nothing above 10 kHz is
compared. More of a recording would increase the cost in proportion and add little information.

A sidecar states the speed that was set. Recordings of one stated condition are repeats and get the
mean of their speeds, so that their differences count as differences between repeats.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from models.condition import known_condition
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensor
from noise.base.arrays import Array
from noise.diagnosis.sensors import with_estimated_sensors
from noise.diagnosis.starts import settled_parts
from sim.acquisition import decimate


def prepared(
    rig: Rig, recordings: Sequence[Recording]
) -> tuple[Rig, tuple[Recording, ...], tuple[str, ...], dict[int, str]]:
    """Prepare recordings and their rig for a comparison.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording
        Recordings of one rig with speed, interference and support stiffness in their conditions.

    Returns
    -------
    rig : Rig
        The rig, with estimates for sensors that its file does not state.
    recordings : tuple of Recording
        Settled parts of the usable recordings, with the measured speeds in their conditions.
    notes : tuple of str
        Notes for the user, one line each.
    left_out : dict of int to str
        Reason why a recording is not usable, by its index in `recordings`.

    Examples
    --------
    >>> import numpy as np
    >>> from models.condition import KnownCondition
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> x = 7.0 + 0.1 * np.random.default_rng(0).standard_normal((1, 15_000))
    >>> at = KnownCondition(1.0, 0.279e-3, 3745.0)
    >>> run = Recording(x, 30e3, (Channel("torque"),), at)
    >>> prepared(load_material_rig("fluorocarbon-thesis"), [run])[1][0].duration
    0.5
    """
    parts, cut, left_out = settled_parts(recordings)
    timed, turned = at_measured_speeds(parts)
    rig, sensed = with_estimated_sensors(rig, timed)
    rig, used, shortened = bounded(rig, timed)
    return rig, used, (*cut, *turned, *sensed, *shortened), left_out


FARTHEST = 0.08
"""Largest relative difference between the angle's speed and the stated one for a correction [-];
above it one of the two is wrong; assumed."""

_OFF = 0.005
"""Least relative error of a stated speed that is corrected [-], which is the difference between
runs of one speed; assumed."""


def measured_speed(angle: Array, rate: float) -> float:
    """Return the mean speed of a shaft [rad/s].

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Angle of the shaft [rad].
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> round(measured_speed(np.linspace(0.0, 2.0, 30_001), 30e3), 6)
    2.0
    """
    n = max(1, angle.size // 20)  # length of the ends, whose means reduce noise and steps
    turned = angle[-n:].mean() - angle[:n].mean()
    return float(turned * rate / max(angle.size - n, 1))


def at_measured_speeds(
    recordings: Sequence[Recording],
) -> tuple[tuple[Recording, ...], tuple[str, ...]]:
    """Return recordings with the speeds of their angles in their conditions.

    Parameters
    ----------
    recordings : sequence of Recording
        Recordings with speed, interference and support stiffness in their conditions.

    Returns
    -------
    recordings : tuple of Recording
        Recordings with corrected speeds. A recording is unchanged if it has no angle, or if its
        angle agrees with the stated speed or contradicts it.
    notes : tuple of str
        The largest error of the stated speeds; empty if no speed was corrected.

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.recording import Channel, Recording
    >>> angle = 1.02 * np.arange(30_000)[None] / 30e3
    >>> at = KnownCondition(1.0, 0.279e-3, 3745.0)
    >>> runs, notes = at_measured_speeds([Recording(angle, 30e3, (Channel("angle"),), at)])
    >>> round(runs[0].condition.speed, 6), notes
    (1.02, ('the shaft turns up to 2 % faster than stated; its angle counts',))
    """
    speeds: dict[tuple[object, ...], list[float]] = {}
    stated = [known_condition(recording.condition) for recording in recordings]
    for recording, at in zip(recordings, stated, strict=True):
        row = recording.first("angle")
        if row is not None:
            speed = measured_speed(recording.samples[row], recording.rate)
            if at.speed and abs(speed / at.speed - 1.0) <= FARTHEST:
                speeds.setdefault(_stated(recording), []).append(speed)
    corrected, worst = [], 0.0
    for recording, at in zip(recordings, stated, strict=True):
        if _stated(recording) in speeds:
            speed = float(np.mean(speeds[_stated(recording)]))
            by = speed / at.speed - 1.0
            if abs(by) > _OFF:
                worst = max(worst, by, key=abs)
                recording = replace(recording, condition=replace(at, speed=speed))
        corrected.append(recording)
    way = "faster" if worst > 0.0 else "slower"
    note = f"the shaft turns up to {100.0 * abs(worst):.2g} % {way} than stated; its angle counts"
    return tuple(corrected), (note,) if worst else ()


def _stated(recording: Recording) -> tuple[object, ...]:
    """Return the stated condition of a recording, equal for repeats."""
    at = known_condition(recording.condition)
    return at.speed, at.interference, at.support_stiffness, at.material, at.temperature


LONGEST = 2.0
"""Duration of the last, settled part of a recording that a diagnosis uses [s]; limits its cost;
assumed."""

HIGHEST_RATE = 51.2e3
"""Sampling rate above which recordings are decimated [Hz]; assumed."""


def bounded(
    rig: Rig, recordings: Sequence[Recording]
) -> tuple[Rig, tuple[Recording, ...], tuple[str, ...]]:
    """Shorten and decimate recordings to the limits of a diagnosis.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    rig : Rig
        The rig with sensors at the lower rate, which have less noise and no steps.
    recordings : tuple of Recording
        Recordings of at most `LONGEST` [s] and `HIGHEST_RATE` [Hz].
    notes : tuple of str
        One line each on decimated and on shortened recordings.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> long = Recording(np.zeros((1, 288_000)), 96e3, (Channel("torque"),))
    >>> _, (short,), notes = bounded(load_material_rig("PDMS"), [long])
    >>> short.rate, short.duration
    (48000.0, 2.0)
    >>> notes[1]
    'of recordings longer than 2 s the last 2 s were used'
    """
    factors = [math.ceil(recording.rate / HIGHEST_RATE) for recording in recordings]
    parts = tuple(_part(r, k) for r, k in zip(recordings, factors, strict=True))
    notes = []
    if max(factors, default=1) > 1:
        notes.append(f"samples above {HIGHEST_RATE / 1e3:g} kHz were filtered and thinned out")
    if any(recording.duration > LONGEST for recording in recordings):
        notes.append(f"of recordings longer than {LONGEST:g} s the last {LONGEST:g} s were used")
    least = min(factors, default=1)
    if least > 1:
        sensors = {kind: _decimated(s, least) for kind, s in rig.sensors.by_kind.items()}
        rig = replace(rig, sensors=replace(rig.sensors, by_kind=sensors))
    return rig, parts, tuple(notes)


def _part(recording: Recording, factor: int) -> Recording:
    """Return the last part of a recording, decimated by a factor."""
    samples, rate = recording.samples, recording.rate / factor
    if factor > 1:
        samples = np.stack([decimate(row, factor) for row in samples])
    last = samples[:, -round(LONGEST * rate) :]
    if last.shape == recording.samples.shape:
        return recording
    return replace(recording, samples=np.ascontiguousarray(last), rate=rate)


def _decimated(sensor: Sensor, factor: int) -> Sensor:
    """Return a sensor after decimation, with less white noise and with steps as white noise."""
    if sensor.noise is None:
        return replace(sensor, bits=None)
    noise = math.sqrt((sensor.noise**2 + sensor.step**2 / 12.0) / factor)
    return replace(sensor, noise=noise, bits=None)
