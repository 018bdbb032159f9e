"""The noise of sensors, estimated from recordings of a rig at work.

A recording has no silence, but between slips and lines there is little else than noise: the tenth
of all short segments that is quietest, in the bands that are quietest, up to where anti-alias
filters begin. Where several bands share that floor it is taken for white noise of the sensor; the
hiss of the room counts as that too. Where none do, a sound fills all bands at all times, and
nothing can be told. The rounding of a converter that the rig file states is taken off, since it is
added again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import gamma

from features.kernels.segments import segment_spectra
from models.recording import CHANNEL_UNITS
from noise.diagnosis.evidence.channel_summary import USABLE
from sim.acquisition import Acquisition

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from models.recording import Recording
    from models.rig import Rig
    from models.sensors import Sensors

__all__ = ["estimated_noise", "noise_remarks", "with_estimated_noise"]

_LENGTH = 1024
"""Of a segment [samples]."""

_WIDTH = 32
"""Of a band [lines]."""

_LOWEST = 500.0
"""[Hz]; below, amplifiers rise as 1/f and everything sounds."""

_QUIETEST = 0.1
"""Of the segments."""

_FREE = _WIDTH / 1.94
"""Independent ones among the lines of a band, whose Hann windows overlap."""

_SHARE = float(gamma.ppf(_QUIETEST, _FREE) / _FREE)
"""Of the mean power of white noise, below which the quietest segments lie."""

_FEWEST = 10
"""Segments to tell it from."""

_ALIKE, _FLAT, _FEWEST_BANDS = 1.4, 0.2, 3
"""White noise is the floor of several bands: so many times the lowest power at most, so large a
share of the bands, and so many. What sounds all the time is coloured."""


def estimated_noise(recordings: Sequence[Recording], kind: str) -> float | None:
    """Estimate the noise of the sensor of a kind of channel.

    Parameters
    ----------
    recordings : sequence of Recording
        In physical units.
    kind : str

    Returns
    -------
    float, optional
        Standard deviation of white noise over the whole band [unit of the channel]; None where the
        recordings are too short, have no such channel, or have no floor that is white.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> noise = 0.02 * np.random.default_rng(0).standard_normal((1, 60_000))
    >>> tone = np.sin(2 * np.pi * 440 * np.arange(60_000) / 30e3)
    >>> run = Recording(tone + noise, 30e3, (Channel("torque"),))
    >>> round(estimated_noise([run], "torque"), 3)
    0.02
    """
    powers = []
    for recording in recordings:
        row = recording.first(kind)
        if row is None or recording.samples.shape[1] < _LENGTH:
            continue
        x = recording.samples[row]
        t = np.arange(x.size)
        x = x - np.polynomial.Polynomial.fit(t, x, 1)(t)  # a shaft turns all the time
        frequency = np.fft.rfftfreq(_LENGTH, 1.0 / recording.rate)
        inside = (frequency >= _LOWEST) & (frequency <= USABLE * recording.rate)
        power = np.abs(segment_spectra(x, _LENGTH)[:, inside]) ** 2
        n_bands = power.shape[1] // _WIDTH
        kept = power[:, power.shape[1] - n_bands * _WIDTH :]
        powers.append(kept.reshape(len(power), n_bands, _WIDTH).mean(axis=2))
    if sum(map(len, powers)) < _FEWEST:
        return None
    n_bands = min(bands.shape[1] for bands in powers)  # rates may differ
    if n_bands < _FEWEST_BANDS:
        return None
    pooled = np.concatenate([bands[:, -n_bands:] for bands in powers])
    quiet = np.sort(np.quantile(pooled, _QUIETEST, axis=0))
    floor = quiet[quiet <= _ALIKE * quiet[0]]
    if len(floor) < max(_FEWEST_BANDS, _FLAT * n_bands):
        return None
    return float(np.sqrt(np.median(floor) / _SHARE))


def with_estimated_noise(rig: Rig, recordings: Sequence[Recording]) -> Rig:
    """Return a rig with the noise of its sensors, where it is to be taken from recordings.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    Rig
        The same where its file states the noise, or nothing of it.
    """
    if not rig.sensors.noise_from_recordings:
        return rig
    kinds = dict.fromkeys(channel.kind for r in recordings for channel in r.channels)
    found = dict(rig.sensors.by_kind)
    for kind in kinds:
        sensor = rig.sensors.of(kind)
        level = estimated_noise(recordings, kind)
        if level is not None:
            rounding = sensor.step**2 / 12.0
            noise = float(np.sqrt(max(0.0, level**2 - rounding)))
            found[kind] = replace(sensor, noise=noise)
    return replace(rig, sensors=replace(rig.sensors, by_kind=found))


def noise_remarks(sensors: Sensors, kinds: Collection[str]) -> list[str]:
    """Say what noise was taken from recordings, and where none could be told.

    Parameters
    ----------
    sensors : Sensors
        Of `with_estimated_noise`.
    kinds : collection of str
        Kinds of channel that were recorded.

    Examples
    --------
    >>> from models.sensors import Sensor, Sensors
    >>> noise_remarks(Sensors({"torque": Sensor(0.02)}), ("torque",))
    []
    """
    if not sensors.noise_from_recordings:
        return []
    levels = {kind: sensors.of(kind).noise for kind in Acquisition().noise if kind in kinds}
    told = [f"{k} {x:.2g} {CHANNEL_UNITS[k]}" for k, x in levels.items() if x is not None]
    untold = [kind for kind, level in levels.items() if level is None]
    found = []
    if told:
        found.append(
            f"noise of the sensors, from the quietest tenth of the recordings: {', '.join(told)}; "
            "hiss of the room counts as theirs"
        )
    if untold:
        found.append(
            f"the noise of {', '.join(untold)} cannot be told from these recordings, in which "
            "something sounds at all times; that of good sensors is used"
        )
    return found
