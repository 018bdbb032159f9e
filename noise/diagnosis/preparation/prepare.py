"""Preparation of recordings, and of the rig, before they are compared.

In order: the start is left out, the speed is what the angle says, the noise and the resolution of
sensors are taken from the recordings, where the rig file does not state them, and of recordings
that are long or finely sampled a part is looked at.

Whatever is compared with a recording is simulated as long and as finely, many times over. Two
seconds hold a hundred slips and more, and nothing above 10 kHz counts, so that more of a recording
would cost in proportion and tell little.

The step of a converter is that of which all samples are multiples. A sidecar says what was set.
Recordings of one stated condition are repeats of each other and get one speed, the mean of theirs:
what they differ by is what repeats differ by.

A recording has no silence, but high above what the rig sounds at there is little else than noise
for a few milliseconds between slips: of all short segments the quietest, in the quietest bands, in
the quietest recordings. What bands and conditions share there is white and the sensor's.

A sensor is not equally noisy in all recordings, so that its noise is a middle of theirs.

What is given up: white noise that fills all recordings alike counts as the sensor's, however loud.
Coloured noise, and such as is louder in some recordings than in others, is no sensor's, and stays
what the simulation lacks. A noise well below the step of the converter cannot be told, and changes
little there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import gamma

from features.kernels.spectra import segment_spectra
from models.condition import known_condition
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensor
from models.units import CHANNEL_UNITS
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import USABLE
from noise.diagnosis.preparation.settled_part import settled_parts
from sim.acquisition import Acquisition, decimate

_LENGTH = 128
"""Of a segment [samples]; a few milliseconds; assumed."""

_BANDS, _LOWEST, _LOWEST_SHARE = 4, 500.0, 0.18
"""From the larger of a frequency [Hz] and of a share of the rate [-], up to `USABLE`; assumed."""

_QUIETEST = (0.05, 0.2)
"""Shares of the segments, the quietest, of which either may be free of signals; assumed."""

_OVERLAP = 1.94
"""Neighbouring lines of a Hann window that count as one independent line; 1 + 2 (4/9 + 1/36), from
the squares of their correlations."""

_FEWEST_STEPS = 20
"""Segments to tell it from; assumed."""

_ALIKE, _ALIKE_RECORDINGS = 1.5, 2.5
"""White noise is the floor of two bands, and of two recordings where there are two: so many times
the power of the lower at most [-]; assumed. From one recording to the next the noise of a sensor
may be half as large again."""

_MIDDLE = 1.0 / 3.0
"""Quantile of the recordings' floors that is the noise: in the louder ones signals may reach into
the floor; assumed."""

_ABOVE_STEP = 0.4
"""Of a converter's step, below which white noise cannot be told from its rounding [-]; assumed."""


def estimated_noise(recordings: Sequence[Recording], kind: str, step: float = 0.0) -> float | None:
    """Estimate the noise of the sensor of a kind of channel.

    Parameters
    ----------
    recordings : sequence of Recording
        In physical units.
    kind : str
    step : float
        Of the converter, whose rounding does not count [unit of the channel].

    Returns
    -------
    float, optional
        Standard deviation of white noise over the whole band [unit of the channel]; None where the
        recordings are too short, have no such channel, or share no floor that is white.

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
        found = None if row is None else _floors(recording.samples[row], recording.rate)
        if found is not None:
            lower, higher = found
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
    """Power of the two quietest bands of a signal [unit^2]."""
    t = np.arange(x.size)
    x = x - (x[0] + (x[-1] - x[0]) / max(x.size - 1, 1) * t)  # a shaft turns all the time
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
"""Relative difference from which an angle's speed is no correction of the one that is stated but
says that one of the two is wrong [-]; assumed."""

_OFF = 0.005
"""Relative difference from which a stated speed is off [-]; runs of one speed differ by as much;
assumed."""


def measured_speed(angle: Array, rate: float) -> float:
    """Mean speed of a shaft [rad/s].

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> round(measured_speed(np.linspace(0.0, 2.0, 30_001), 30e3), 6)
    2.0
    """
    n = max(1, angle.size // 20)  # ends that noise and steps are averaged over
    turned = angle[-n:].mean() - angle[:n].mean()
    return float(turned * rate / max(angle.size - n, 1))


def at_measured_speeds(
    recordings: Sequence[Recording],
) -> tuple[tuple[Recording, ...], tuple[str, ...]]:
    """Return recordings with the speed in their conditions that their angles have.

    Parameters
    ----------
    recordings : sequence of Recording
        With speed, interference and support stiffness in their conditions.

    Returns
    -------
    recordings : tuple of Recording
        Those without an angle, or whose angle turns as stated or at quite another speed, are
        themselves.
    notes : tuple of str
        By how much the stated speeds were off, if that is worth telling.

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
    found, off = [], [0.0]
    for recording, at in zip(recordings, stated, strict=True):
        if _stated(recording) in speeds:
            speed = float(np.mean(speeds[_stated(recording)]))
            by = speed / at.speed - 1.0
            if abs(by) > _OFF:
                off.append(by)
                recording = replace(recording, condition=replace(at, speed=speed))
        found.append(recording)
    return tuple(found), tuple(_told(off))


def _stated(recording: Recording) -> tuple[object, ...]:
    at = known_condition(recording.condition)
    return at.speed, at.interference, at.support_stiffness, at.material, at.temperature


def _told(off: Sequence[float]) -> list[str]:
    slower, faster = -min(off), max(off)
    said = [
        f"up to {100.0 * by:.2g} % {word}"
        for by, word in ((faster, "faster"), (slower, "slower"))
        if by > _OFF
    ]
    return [f"the shaft turns {' and '.join(said)} than stated; its angle counts"] if said else []


_LOOKED_AT = 8192
"""Samples of a recording."""

_ROUNDED = 2.0**-22
"""Error of samples that are kept in 32 bits, over the largest [-]."""

_CLEAR = 20.0
"""A step is so many times that error at least; assumed."""

_REACHES = (1.0, 4.0, 64.0, np.inf)
"""Steps that values are apart at most, from which the step is found more and more exactly."""

_SAME = 1e-4
"""Relative difference of the steps of recordings through one converter [-]; assumed."""

_FEWEST = 3
"""Different values between which a step can be told."""


def converter_step(recordings: Sequence[Recording], kind: str) -> float:
    """Find the step in which a kind of channel was sampled.

    Parameters
    ----------
    recordings : sequence of Recording
    kind : str

    Returns
    -------
    float
        [unit of the channel]; 0 where there is none, or not the same in all recordings.

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
    told = steps[np.isfinite(steps)]
    if not told.size:
        return 0.0
    middle = float(np.median(told))
    return middle if np.allclose(told, middle, rtol=_SAME, atol=0.0) else 0.0


def _step(x: Array) -> float:
    """Greatest common divisor of what samples differ by; 0 if none, NaN if they say nothing."""
    values = np.unique(x[:: max(1, x.size // _LOOKED_AT)])
    if values.size < _FEWEST:
        return np.nan
    error = _ROUNDED * float(np.abs(values).max())
    apart = np.diff(values)
    step = float(apart.min())
    while step > _CLEAR * error:
        for reach in _REACHES:  # the step's own error counts as often as a difference has steps
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


_EXCEEDED = 1.5
"""Noise over that which is stated, from which the recordings have more [-]; assumed."""

_BITS = 24
"""Of the converter that a step is written as; its range is never reached."""


def with_seen_sensors(rig: Rig, recordings: Sequence[Recording]) -> tuple[Rig, tuple[str, ...]]:
    """Return a rig with noise and resolution of its sensors, where these can be told.

    What is stated stays. A noise that cannot be told is that of good sensors.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    rig : Rig
    notes : tuple of str
        What was found, and what could not be, a line each.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> noise = 0.01 * np.random.default_rng(0).standard_normal((1, 60_000))
    >>> run = Recording(noise, 30e3, (Channel("torque"),))
    >>> seen, notes = with_seen_sensors(load_material_rig("fluorocarbon-thesis"), [run])
    >>> round(seen.sensors.of("torque").noise, 3), notes
    (0.01, ('noise of the sensors (white, RMS), by the recordings: torque 0.01 N m; ...',))
    """
    usual = Acquisition().noise
    found = dict(rig.sensors.by_kind)
    told, untold, louder, steps = [], [], [], []
    recorded = dict.fromkeys(c.kind for r in recordings for c in r.channels if c.kind in usual)
    for kind in recorded:
        sensor, unit = rig.sensors.of(kind), CHANNEL_UNITS[kind]
        if not sensor.step and (step := converter_step(recordings, kind)):
            sensor = _in_steps(sensor, step)
            steps.append(f"{kind} {step:.2g} {unit}")
        level = estimated_noise(recordings, kind, sensor.step)
        if sensor.noise is not None:
            if level is not None and level > _EXCEEDED * math.hypot(
                sensor.noise, 0.3 * sensor.step
            ):
                louder.append(f"{kind} {level:.2g} {unit} (stated {sensor.noise:.2g})")
        elif level is None:
            untold.append(kind)
        else:
            sensor = replace(sensor, noise=level)
            told.append(f"{kind} {level:.2g} {unit}")
        found[kind] = sensor
    notes = []
    if told:
        notes.append(
            f"noise of the sensors (white, RMS), by the recordings: {', '.join(told)}; constant "
            "room noise is counted as sensor noise, unless [sensors] of the rig file states less"
        )
    if steps:
        notes.append(f"steps of the converter, by the recordings: {', '.join(steps)}")
    if untold:
        notes.append(
            f"noise of the sensors of {', '.join(untold)}: these recordings do not tell it (no "
            "white floor between the slips); that of good sensors is assumed, which [sensors] of "
            "the rig file can replace"
        )
    if louder:
        notes.append(f"more white noise than [sensors] of the rig file states: {', '.join(louder)}")
    return replace(rig, sensors=replace(rig.sensors, by_kind=found)), tuple(notes)


def _in_steps(sensor: Sensor, step: float) -> Sensor:
    """Return a sensor with a converter of some step, within the range that it may have."""
    if sensor.full_scale is None:
        return replace(sensor, full_scale=math.ldexp(step, _BITS - 1), bits=_BITS)
    bits = 1 + math.log2(sensor.full_scale / step)
    whole = round(bits)
    return replace(sensor, bits=whole) if abs(bits - whole) < 1e-3 else sensor


LONGEST = 2.0
"""Of a recording the last part of this length is looked at, in which it has settled [s]; what a
diagnosis may cost settles it; assumed."""

HIGHEST_RATE = 51.2e3
"""Recordings at higher rates are filtered and thinned out [Hz]; assumed."""


def bounded(
    rig: Rig, recordings: Sequence[Recording]
) -> tuple[Rig, tuple[Recording, ...], tuple[str, ...]]:
    """Keep of recordings what a diagnosis looks at.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    rig : Rig
        Its sensors as they are at the lower rate: with less noise, and without steps.
    recordings : tuple of Recording
        At most `LONGEST`, at `HIGHEST_RATE` or below.
    notes : tuple of str
        What was left out, a line each.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> long = Recording(np.zeros((1, 288_000)), 96e3, (Channel("torque"),))
    >>> _, (short,), notes = bounded(load_material_rig("PDMS"), [long])
    >>> short.rate, short.duration
    (48000.0, 2.0)
    >>> print("; ".join(notes))
    1 of 1 recordings is sampled above 51.2 kHz and was filtered and thinned out; 1 of 1 recordings
    is longer than 2 s, of which the last 2 s were looked at
    """
    factors = [math.ceil(recording.rate / HIGHEST_RATE) for recording in recordings]
    kept = tuple(_part(r, k) for r, k in zip(recordings, factors, strict=True))
    n, fine = len(kept), sum(k > 1 for k in factors)
    long = sum(recording.duration > LONGEST for recording in recordings)
    notes = []
    if fine:
        are = "is" if fine == 1 else "are"
        notes.append(
            f"{fine} of {n} recordings {are} sampled above {HIGHEST_RATE / 1e3:g} kHz and "
            f"{'was' if fine == 1 else 'were'} filtered and thinned out"
        )
    if long:
        notes.append(
            f"{long} of {n} recordings {'is' if long == 1 else 'are'} longer than {LONGEST:g} s, "
            f"of which the last {LONGEST:g} s were looked at"
        )
    return _with_thinned_sensors(rig, min(factors, default=1)), kept, tuple(notes)


def _part(recording: Recording, factor: int) -> Recording:
    """Return the last part of a recording, at a rate so many times lower."""
    samples, rate = recording.samples, recording.rate / factor
    if factor > 1:
        samples = np.stack([decimate(row, factor) for row in samples])
    last = samples[:, -round(LONGEST * rate) :]
    if last.shape == recording.samples.shape:
        return recording
    return replace(recording, samples=np.ascontiguousarray(last), rate=rate)


def _with_thinned_sensors(rig: Rig, factor: int) -> Rig:
    if factor == 1:
        return rig
    thinned = {kind: _thinned_sensor(s, factor) for kind, s in rig.sensors.by_kind.items()}
    return replace(rig, sensors=replace(rig.sensors, by_kind=thinned))


def _thinned_sensor(sensor: Sensor, factor: int) -> Sensor:
    """Of white noise a filter passes what it passes of the band; steps become such noise."""
    if sensor.noise is None:
        return replace(sensor, bits=None)
    noise = math.sqrt((sensor.noise**2 + sensor.step**2 / 12.0) / factor)
    return replace(sensor, noise=noise, bits=None)


def prepared(
    rig: Rig, recordings: Sequence[Recording]
) -> tuple[Rig, tuple[Recording, ...], tuple[str, ...], dict[int, str]]:
    """Make recordings ready to be compared with a rig.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording
        Of one rig, with speed, interference and support stiffness in their conditions.

    Returns
    -------
    rig : Rig
        Its sensors as the recordings show them, where its file does not state them.
    recordings : tuple of Recording
        Their settled part, at the speed that they turn at; those that are left out are missing.
    notes : tuple of str
        What a user should know of it, a line each.
    left_out : dict of int to str
        Why a recording cannot be used, by its place among those given.

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
    seen, sensed = with_seen_sensors(rig, timed)
    thinned, kept, shortened = bounded(seen, timed)
    return thinned, kept, (*cut, *turned, *sensed, *shortened), left_out
