"""Preparation of recordings and of their rig for a comparison.

The steps are: cut off the start, set the speed from the angle, estimate the noise and resolution of
sensors that the rig file does not state, and shorten and decimate long or finely sampled
recordings.

A simulation is as long and as finely sampled as the recording that it is compared with, and is
repeated many times. Two seconds contain at least a hundred slips, and nothing above 10 kHz is
compared. More of a recording would increase the cost in proportion and add little information.

All samples are multiples of the step of their converter. A sidecar states the speed that was set.
Recordings of one stated condition are repeats and get the mean of their speeds, so that their
differences count as differences between repeats.

A recording has no silence, but well above the frequencies of the rig it contains little but noise
for a few milliseconds between slips. The noise is estimated from the quietest short segments in the
quietest bands of the quietest recordings. A floor that bands and conditions have in common is white
and belongs to the sensor. The noise of a sensor varies between recordings; the estimate is a
quantile of theirs.

Limits of the method: white noise of equal level in all recordings counts as sensor noise at any
level. Coloured noise, and noise that is louder in some recordings, does not, and remains a
difference to the simulation. Noise far below the step of the converter cannot be estimated and has
little influence.

A settled recording is returned unchanged, bit for bit. The settled part of another has one of a few
lengths, so that recordings can share simulations and repeats of a condition stay comparable. A
start is a deviation from the later speed that exists at the beginning, ends, and is several times
larger than all later deviations. It is detected from the angle, which is read where it crosses the
steps of its converter, so that a coarse converter is as accurate as a fine one. A torque that rises
from zero shows a start from rest. Without an angle, the rate at which the torque rises while the
contact sticks shows the speed, because the rotation of the shaft twists the elastomer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.stats import gamma

from features.kernels.spectra import segment_spectra
from models.condition import known_condition
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensor
from models.units import CHANNEL_UNITS
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import USABLE, segment_frequency
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL
from noise.diagnosis.words import joined
from sim.acquisition import Acquisition, decimate

_LENGTH = 128
"""Length of a segment, a few milliseconds [samples]; assumed."""

_BANDS, _LOWEST, _LOWEST_SHARE = 4, 500.0, 0.18
"""Number of bands, and their lower limit: the larger of a frequency [Hz] and a share of the
rate [-]; the upper limit is `USABLE`; assumed."""

_QUIETEST = (0.05, 0.2)
"""Quantiles of the segments' power at which the noise floor is read [-]; assumed."""

_OVERLAP = 1.94
"""Number of lines of a Hann window per independent line [-]: 1 + 2 (4/9 + 1/36), from the squares
of the correlations of neighbouring lines."""

_FEWEST_STEPS = 20
"""Least number of segments for an estimate of noise; assumed."""

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
            white = higher <= _ALIKE * lower
            floors.append(0.5 * (lower + higher) if white else np.inf)
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
    if x.size < _LENGTH * (_FEWEST_STEPS + 1) // 2:
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


_STEP_SAMPLES = 8192
"""Least number of samples of a longer recording from which a step is estimated."""

_ROUNDED = 2.0**-22
"""Rounding error of samples stored in 32 bits, relative to the largest sample [-]."""

_CLEAR = 20.0
"""Least ratio of a step to the rounding error [-]; assumed."""

_REACHES = (1.0, 4.0, 64.0, np.inf)
"""Largest differences of values, in steps, of the successive refinements of a step [-]."""

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
    rows = [(r.samples, row) for r in recordings if (row := r.first(kind)) is not None]
    steps = np.array([_step(samples[row]) for samples, row in rows])
    known = steps[np.isfinite(steps)]
    if not known.size:
        return 0.0
    middle = float(np.median(known))
    return middle if np.allclose(known, middle, rtol=_SAME, atol=0.0) else 0.0


def _step(x: Array) -> float:
    """Return the greatest common divisor of the differences of samples [unit of the channel].

    The result is 0 if there is none and NaN if the samples have too few different values.
    """
    values = np.unique(x[:: max(1, x.size // _STEP_SAMPLES)])
    if values.size < _FEWEST:
        return np.nan
    error = _ROUNDED * float(np.abs(values).max())
    apart = np.diff(values)
    step = float(apart.min())
    while step > _CLEAR * error:
        for reach in _REACHES:  # the error of the step is multiplied by the number of steps
            steps = np.round(apart / step)
            near = steps <= reach
            if not near.any():
                continue
            left = float(np.abs(apart - step * steps)[near].max())
            if left > 2.0 * error:
                step = left
                break
            step = float(apart[near].sum() / steps[near].sum())
        else:
            return step
    return 0.0


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
        level = estimated_noise(recordings, kind, sensor.step)
        if sensor.noise is None and level is None:
            unknown.append(kind)
        elif sensor.noise is None:
            sensor = replace(sensor, noise=level)
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


_BLOCK, _LAG = 5e-3, 2
"""Length of the blocks over which an angle is averaged [s], and number of blocks on either side for
the slope that is the speed; assumed."""

_LATE = 0.6
"""Share of a recording after which every start has ended [-]; assumed."""

_EARLY = 0.08
"""Time from the beginning within which a start is visible [s], at least a quarter of the slowest
swing of a controller; assumed."""

_SMALLEST, _LARGER = 0.04, 4.0
"""Least relative deviation of the speed in a start, and its least ratio to later deviations [-];
assumed."""

_OVER = 0.012
"""Largest relative deviation of a settled speed [-]; assumed."""

_RISE, _STUCK, _STEEP = 5e-4, 0.02, 0.8
"""Interval over which the rise of a torque is taken [s], length of the window of such rises [s],
and quantile of the rises in a window [-]; assumed."""

_SMALLEST_RISE, _LARGER_RISE, _OVER_RISE = 0.12, 2.5, 0.05
"""Values of `_SMALLEST`, `_LARGER` and `_OVER` for the rise of a torque, which is less exact [-];
assumed."""

_FEWEST_LEVELS = 8
"""Least number of converter levels of an angle for interpolation between them; assumed."""

_FROM_ZERO = 0.25
"""Largest initial torque of a start from rest, as a share of the lowest later torque [-];
assumed."""


def start_of(recording: Recording) -> float:
    """Return the time at which the shaft of a recording reaches its speed; 0 without a start [s].

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> even = np.linspace(0.0, 1.0, 30_000)[None]
    >>> start_of(Recording(even, 30e3, (Channel("angle"),)))
    0.0
    """
    rate, starts = recording.rate, [0.0]
    angle, torque = recording.first("angle"), recording.first("torque")
    if angle is not None:
        starts.append(_start_by_angle(recording.samples[angle], rate))
    if torque is not None:
        starts.append(_start_from_zero(recording.samples[torque], rate))
    if torque is not None and angle is None:
        starts.append(_start_by_sticking(recording.samples[torque], rate))
    return max(starts)


def _start_by_angle(angle: Array, rate: float) -> float:
    """Return the time at which the speed of an angle settles; 0 without a start [s]."""
    block = max(1, round(_BLOCK * rate))
    n = angle.size // block
    turned = angle * (1.0 if angle[-1] >= angle[0] else -1.0)
    means = _continuous(turned)[: n * block].reshape(n, block).mean(axis=1)
    if n < 8 * _LAG:
        return 0.0
    at = np.arange(n)
    after, before = np.minimum(at + _LAG, n - 1), np.maximum(at - _LAG, 0)
    speed = (means[after] - means[before]) / (after - before)
    settled = _settled(speed, round(_EARLY / _BLOCK), _OVER, _SMALLEST, _LARGER)
    return min((settled + _LAG) * block, angle.size) / rate if settled else 0.0


def _start_by_sticking(torque: Array, rate: float) -> float:
    """Return the time at which the rise of the torque in stick phases settles; 0 without one [s].

    The rise is proportional to the speed of the shaft. A high quantile of it is the rise in the
    stick phase, independent of the falls in between.
    """
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    lag, hop, length = (max(1, round(x * rate)) for x in (_RISE, _BLOCK, _STUCK))
    rises = turned[lag:] - turned[:-lag]
    if rises.size < 8 * length:
        return 0.0
    rise = np.quantile(sliding_window_view(rises, length)[::hop], _STEEP, axis=1)
    settled = _settled(rise, round(_EARLY / _BLOCK), _OVER_RISE, _SMALLEST_RISE, _LARGER_RISE)
    return min(settled * hop + length, torque.size) / rate if settled else 0.0


def _settled(values: Array, n_early: int, over: float, smallest: float, larger: float) -> int:
    """Return the index from which values agree with the late ones; 0 without a start."""
    first_late = round(_LATE * values.size)
    late = values[first_late:].mean()
    if late <= 0.0:
        return 0
    away = np.abs(values / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # largest deviation from each index on
    settled = int(np.argmax(beyond <= max(over, 1.2 * beyond[first_late])))
    limit = max(smallest, larger * beyond[settled])
    if settled == 0 or away[:settled].max() < limit or away[:n_early].max() < 0.5 * limit:
        return 0
    return settled


def _continuous(angle: Array) -> Array:
    """Return an angle interpolated linearly between the crossings of its converter's levels.

    The number of samples below a level is the time of its crossing, even if noise crosses it
    several times.
    """
    levels, count = np.unique(angle, return_counts=True)
    if levels.size > 0.5 * angle.size or levels.size < _FEWEST_LEVELS:
        return angle
    crossed = np.cumsum(count)[:-1] - 0.5
    between = 0.5 * (levels[1:] + levels[:-1])
    first, last = np.polyfit(crossed[:3], between[:3], 1), np.polyfit(crossed[-3:], between[-3:], 1)
    at = np.arange(angle.size)
    smooth = np.interp(at, crossed, between)
    before, after = at < crossed[0], at > crossed[-1]
    smooth[before], smooth[after] = np.polyval(first, at[before]), np.polyval(last, at[after])
    return np.asarray(smooth)


def _start_from_zero(torque: Array, rate: float) -> float:
    """Return the time at which a torque that begins at zero reaches its later range [s].

    The result is 0 if the torque does not begin at zero.
    """
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    late = turned[round(_LATE * turned.size) :]
    lowest = float(np.quantile(late, 0.01))
    n = max(1, round(1e-3 * rate))
    if lowest <= 0.0 or np.abs(turned[:n]).mean() > _FROM_ZERO * lowest:
        return 0.0
    return float(np.argmax(turned >= lowest)) / rate


_SHORTEST = LEAD + TAIL + 0.1
"""Least duration with enough cycles [s]."""

_PATH_ENDS = 0.09
"""Duration of the ends that `evidence.channel_summary` omits before it takes spectra
of segments [s]."""

RINGING = 0.06
"""Decay time of a ringing clamp after the speed has settled [s]: three time constants 2 J_C / c of
the thesis's clamp."""

_LENGTHS = 0.05
"""Step of the durations of settled parts [s], so that recordings share simulations; assumed."""

_MOST_NAMED = 6
"""Largest number of recordings that a note names; assumed."""

_SHORTENED = 0.5
"""Least share of a recording that remains if it is shortened to the length of its repeat [-];
assumed."""


def shortest(rate: float) -> float:
    """Return the least duration of a recording for a comparison [s].

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> round(shortest(30e3), 2), round(shortest(12e3), 2)
    (0.17, 0.26)
    """
    return max(_SHORTEST, _PATH_ENDS + segment_frequency(rate)[0] / rate)


def settled_parts(
    recordings: Sequence[Recording],
) -> tuple[tuple[Recording, ...], tuple[str, ...], dict[int, str]]:
    """Return recordings without their starts.

    Parameters
    ----------
    recordings : sequence of Recording
        Recordings with speed, interference and support stiffness in their conditions.

    Returns
    -------
    parts : tuple of Recording
        Settled parts; a settled recording is unchanged, and repeats of a condition have one length.
    notes : tuple of str
        What was cut off, in one line; empty if nothing was.
    refused : dict of int to str
        Reason why a recording has no settled part, by index; empty if no recording has one.

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.recording import Channel, Recording
    >>> speed = np.minimum(np.arange(30_000) / 9e3, 1.0)  # of 1 rad/s, reached after 0.3 s
    >>> at = KnownCondition(1.0, 0.279e-3, 3745.0)
    >>> run = Recording(np.cumsum(speed)[None] / 30e3, 30e3, (Channel("angle"),), at, name="run")
    >>> parts, notes, _ = settled_parts([run])
    >>> round(parts[0].duration, 3), notes
    (0.6, ('run: the first 0.4 s at most, in which the shaft comes to its speed, were left out',))
    """
    starts = [start_of(recording) for recording in recordings]
    refused = {
        i: f"the shaft comes to its speed only {start:.2g} s after the beginning, and "
        f"{shortest(recording.rate):.2g} s at least must be left"
        for i, (start, recording) in enumerate(zip(starts, recordings, strict=True))
        if start > recording.duration - shortest(recording.rate)
    }
    if len(refused) == len(recordings):
        refused = {}
    usable = [i for i in range(len(recordings)) if i not in refused]
    n_settled = {i: _n_settled(recordings[i], starts[i]) for i in usable}
    for repeats in _repeats(recordings, usable):
        fewest = min(n_settled[i] for i in repeats)
        if fewest >= _SHORTENED * max(n_settled[i] for i in repeats):
            n_settled |= dict.fromkeys(repeats, fewest)
    parts, cut, longest = [], [], 0.0
    for i in usable:
        recording = recordings[i]
        first = recording.samples.shape[1] - n_settled[i]
        parts.append(_from(recording, first))
        if first:
            cut.append(recording.name or f"recording {i + 1}")
            longest = max(longest, first / recording.rate)
    notes: tuple[str, ...] = ()
    if cut:
        which = joined(cut) if len(cut) <= _MOST_NAMED else f"{len(cut)} recordings"
        notes = (
            f"{which}: the first {longest:.2g} s at most, in which the shaft comes to its speed, "
            "were left out",
        )
    return tuple(parts), notes, refused


def _n_settled(recording: Recording, start: float) -> int:
    """Return the number of samples of the settled part after a start [s]."""
    n = int(recording.samples.shape[1])
    if start == 0.0:
        return n
    left = recording.duration - start
    rounded = _LENGTHS * float(np.floor((left - RINGING) / _LENGTHS + 1e-6))
    return min(n, math.ceil(max(rounded, shortest(recording.rate)) * recording.rate))


def _repeats(recordings: Sequence[Recording], usable: Sequence[int]) -> list[list[int]]:
    """Return groups of indices of recordings with the same stated condition, rate and length."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for i in usable:
        r, c = recordings[i], known_condition(recordings[i].condition)
        stated = (c.speed, c.interference, c.support_stiffness, r.rate, r.samples.shape[1])
        groups.setdefault(stated, []).append(i)
    return list(groups.values())


def _from(recording: Recording, first: int) -> Recording:
    """Return the part of a recording from a sample on, with its angle starting at zero."""
    if first == 0:
        return recording
    samples = recording.samples[:, first:].copy()
    for row, channel in enumerate(recording.channels):
        if channel.kind == "angle":
            samples[row] -= samples[row, 0]
    return replace(recording, samples=samples)
