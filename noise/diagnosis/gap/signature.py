"""Signature of a recording: what it shares with others of its condition, whatever the phases.

Stick-slip is chaotic: two runs of one rig agree in no waveform, but in what they are made of.
A signature is the levels of each channel in sixth octaves and the statistics of the torque's
slips; the distance between two is what `noise.diagnosis.gap.distance` makes of it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from features.kernels.levels import band_power
from features.kernels.spectra import welch
from models.recording import Recording

KINDS = ("torque", "acceleration", "pressure")
"""Kinds of channel that have a signature; of each the first channel counts."""

_PER_OCTAVE = 6
_LOWEST, _HIGHEST = 50.0, 8000.0
_RESOLUTION = 12.0
"""Of the spectra [Hz]; the lowest bands share their lines with their neighbours; assumed."""

_USABLE = 0.42
"""Share of the sampling rate up to which a band counts; as of `channel_summary`."""

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


def group_of() -> NDArray[np.int64]:
    """Index into `GROUPS` of each value of a signature.

    Examples
    --------
    >>> [GROUPS[i] for i in group_of()[[0, -1]]]
    ['torque', 'cycle']
    """
    return np.array([GROUPS.index(name.split("_")[0]) for name in NAMES])


def signature(recording: Recording) -> NDArray[np.float64]:
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
    parts = {
        kind: channel_signature(recording.samples[row], recording.rate, kind)
        for kind in KINDS
        if (row := recording.first(kind)) is not None
    }
    return joined_signature(parts)


def channel_signature(signal: NDArray[np.float64], rate: float, kind: str) -> NDArray[np.float64]:
    """Describe one channel: its levels, and of a torque what its slips are like.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        [Hz]
    kind : str
        Of `KINDS`.

    Returns
    -------
    ndarray, shape (n,)
        Levels [Np], and of a torque ratios of its cycle [-].
    """
    levels = _levels(signal, rate, kind)
    return np.concatenate([levels, _cycle(signal, rate)]) if kind == "torque" else levels


def joined_signature(parts: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Join what `channel_signature` gave of the channels of a recording; NaN where one is missing.

    Examples
    --------
    >>> joined_signature({}).shape == (len(NAMES),)
    True
    """
    values = np.full(len(NAMES), np.nan)
    for i, kind in enumerate(KINDS):
        if kind in parts:
            values[i * _N_BANDS : (i + 1) * _N_BANDS] = parts[kind][:_N_BANDS]
    if "torque" in parts:
        values[len(KINDS) * _N_BANDS :] = parts["torque"][_N_BANDS:]
    return values


def _levels(signal: NDArray[np.float64], rate: float, kind: str) -> NDArray[np.float64]:
    spectrum = welch(signal - signal.mean(), rate, _RESOLUTION)
    power = band_power(spectrum, EDGES[:-1], EDGES[1:])
    power[EDGES[1:] > _USABLE * rate] = np.nan
    lines = np.diff(EDGES) + _CORNER * np.diff(np.log(EDGES))
    noise = _SENSOR_NOISE[kind] ** 2 * lines / _NOISE_BAND
    return np.asarray(0.5 * np.log(power + noise))


def _cycle(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
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


def block_signatures(recording: Recording) -> NDArray[np.float64] | None:
    """Describe each block of a recording.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    ndarray, shape (n_blocks, n_values), or None
        None where the recording is too short for three As of `signature`.
    """
    count = min(int(recording.duration / _BLOCK + 1e-6), _MOST_BLOCKS)
    if count < _FEWEST_BLOCKS:
        return None
    n = recording.samples.shape[1] // count
    return np.array([
        signature(replace(recording, samples=recording.samples[:, i * n : (i + 1) * n]))
        for i in range(count)
    ])  # fmt: skip
