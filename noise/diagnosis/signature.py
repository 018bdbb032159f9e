"""Signature of a recording: what does not depend on the phases of its stick-slip.

Stick-slip is chaotic: two runs of one rig agree in no waveform, but in what they are made of. So a
recording has a signature, the levels of each channel in sixth octaves and the statistics of the
torque's slips. All groups of its values weigh alike. Large deviations count linearly (Huber 1964,
Ann. Math. Statist. 35, 73), so that a single line of hum cannot hide all else.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from features.kernels.levels import band_power
from features.kernels.spectra import welch
from models.recording import Recording
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import USABLE

KINDS = ("torque", "acceleration", "pressure")
"""Kinds of channel that have a signature; of each the first channel counts."""

_PER_OCTAVE = 6
_LOWEST, _HIGHEST = 50.0, 8000.0
_RESOLUTION = 12.0
"""Of the spectra [Hz]; the lowest bands share their lines with their neighbours; assumed."""

_SENSOR_NOISE = {"torque": 0.025, "acceleration": 0.1, "pressure": 4e-3}
"""White noise from 0 to 15 kHz, rms in the channel's unit, five times that of good sensors: added
to all bands, so that what lies below it does not count; assumed."""

_NOISE_BAND = 15e3

_CORNER = 500.0
"""Below which that noise rises as 1/f, as amplifiers' and rooms' does [Hz]; assumed."""

_N_BANDS = math.floor(_PER_OCTAVE * math.log2(_HIGHEST / _LOWEST))
EDGES = _LOWEST * 2.0 ** (np.arange(_N_BANDS + 1) / _PER_OCTAVE)
"""Of the bands, shape (n_bands + 1,) [Hz]."""

_STATISTICS = ("mean", "spread", "slow", "skewness", "highest", "lowest", "steepest_fall")
"""Of the torque: logarithm of its mean, its standard deviation and that of its slow part over the
mean, skewness, its highest and lowest thousandth over the mean, and the steepest fall."""

GROUPS = (*KINDS, "cycle")
"""Parts of a signature that weigh alike in a distance: three spectra, and the torque's cycle."""

NAMES = (
    *(f"{kind}_{round(low)}" for kind in KINDS for low in EDGES[:-1].tolist()),
    *(f"cycle_{name}" for name in _STATISTICS),
)
"""Of the values of a signature."""


GROUP_OF = np.array([GROUPS.index(name.split("_")[0]) for name in NAMES])
"""Index into `GROUPS` of each value of a signature."""


def signature(recording: Recording) -> Array:
    """Describe a recording by what does not depend on phases.

    Parameters
    ----------
    recording : Recording
        In physical units.

    Returns
    -------
    ndarray, shape (n,)
        By `NAMES`: levels in nepers (a tenth is 0.87 dB), so that they compare with relative
        errors; NaN where a channel is missing or its rate does not reach a band.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon-thesis"), 2.5, seconds=0.4)
    >>> values = signature(run.recording)
    >>> values.shape == (len(NAMES),), bool(np.isfinite(values).all())
    (True, True)
    """
    values = np.full(len(NAMES), np.nan)
    for i, kind in enumerate(KINDS):
        if (row := recording.first(kind)) is not None:
            levels = _levels(recording.samples[row], recording.rate, kind)
            values[i * _N_BANDS : (i + 1) * _N_BANDS] = levels
    if (row := recording.first("torque")) is not None:
        values[len(KINDS) * _N_BANDS :] = _cycle(recording.samples[row], recording.rate)
    return values


def _levels(signal: Array, rate: float, kind: str) -> Array:
    spectrum = welch(signal - signal.mean(), rate, _RESOLUTION)
    power = band_power(spectrum, EDGES[:-1], EDGES[1:])
    power[EDGES[1:] > USABLE * rate] = np.nan
    lines = np.diff(EDGES) + _CORNER * np.diff(np.log(EDGES))
    noise = _SENSOR_NOISE[kind] ** 2 * lines / _NOISE_BAND
    return np.asarray(0.5 * np.log(power + noise))


def _cycle(torque: Array, rate: float) -> Array:
    mean, spread = float(torque.mean()), float(torque.std())
    scale = abs(mean) + 1e-9
    block = max(1, round(0.02 * rate))
    slow = torque[: torque.size // block * block].reshape(-1, block).mean(axis=1)
    low, high = np.quantile(torque, (0.001, 0.999))
    step = max(1, round(2e-4 * rate))
    fall = float(np.min(torque[step:] - torque[:-step]))
    skewness = float(np.mean((torque - mean) ** 3)) / (spread**3 + 1e-12)
    return np.array([
        math.log(scale), spread / scale, float(slow.std()) / scale, skewness,
        float(high) / scale, float(low) / scale, fall / scale,
    ])  # fmt: skip


_BLOCK = 0.25
"""Shortest block of a recording that has a signature of its own [s]; assumed."""

_MOST_BLOCKS = 16
_FEWEST_BLOCKS = 3


def block_signatures(recording: Recording) -> Array | None:
    """Describe each block of a recording.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    ndarray, shape (n_blocks, n_values), or None
        None where the recording is too short for three; as of `signature`.
    """
    count = min(int(recording.duration / _BLOCK + 1e-6), _MOST_BLOCKS)
    if count < _FEWEST_BLOCKS:
        return None
    n = recording.samples.shape[1] // count
    return np.array([
        signature(replace(recording, samples=recording.samples[:, i * n : (i + 1) * n]))
        for i in range(count)
    ])  # fmt: skip


_BEND = 3.0
"""Deviations beyond so many standard deviations count linearly; assumed."""


def group_costs(deviation: Array) -> Array:
    """Mean square of the deviations in each of `GROUPS`, large ones bent; NaN where unknown.

    Parameters
    ----------
    deviation : ndarray, shape (n_values,)
        In standard deviations [-].

    Returns
    -------
    ndarray, shape (n_groups,)
        [-]

    Examples
    --------
    >>> group_costs(np.full(len(GROUP_OF), 2.0))
    array([4., 4., 4., 4.])
    """
    size = np.abs(deviation)
    cost = np.where(size <= _BEND, size**2, _BEND * (2.0 * size - _BEND))
    shares = np.full(len(GROUPS), np.nan)
    for i in range(len(GROUPS)):
        inside = cost[(i == GROUP_OF) & np.isfinite(cost)]
        if inside.size:
            shares[i] = inside.mean()
    return shares


def squared_distance(deviation: Array) -> float:
    """Return the mean of `group_costs` over the groups that are known [-].

    Parameters
    ----------
    deviation : ndarray, shape (n_values,)
        In standard deviations [-].
    """
    return float(np.nanmean(group_costs(deviation)))


def channel_costs(deviation: Array) -> Array:
    """Mean cost of each of `KINDS`, the torque's with that of its cycle.

    Parameters
    ----------
    deviation : ndarray, shape (n_values,)
        In standard deviations [-].

    Returns
    -------
    ndarray, shape (n_kinds,)
        [-]
    """
    *channels, cycle = group_costs(deviation)
    torque = KINDS.index("torque")
    if np.isfinite(cycle):
        channels[torque] = 0.5 * (channels[torque] + cycle)
    return np.array(channels)
