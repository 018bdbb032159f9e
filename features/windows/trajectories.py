"""Statistics of a window's frames: strength, tone and pitch, and how they wander.

A friction tone holds its frequency; a dog, a cock or a siren glides, a voice has syllables and
formants. Frames count by their power, so that pauses say nothing about the pitch.

Windows of as many frames are described together. Each sum runs over the frames in their order, so
that a window's numbers do not depend on which others are described with it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from features.windows.arithmetic import ordered_sum
from features.windows.declared import TRAJECTORY_FEATURES
from features.windows.frames import BANDS, Frames

_BAND_NAMES = tuple(f"band_{i + 1}" for i in range(BANDS))

TRAJECTORY_NAMES = tuple(feature.name for feature in TRAJECTORY_FEATURES)
"""Of a window, in the order of `trajectory_features`."""

_LEAST_FRAMES = 3

_MOST_DB = 60.0
"""Range beyond which levels count as silence [dB]."""

_QUIETEST_BAND_DB = -70.0


def trajectory_features(
    frames: Frames, first: NDArray[np.int64], last: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Describe how the frames of windows follow each other.

    Parameters
    ----------
    frames : Frames
    first, last : ndarray of int, shape (n_windows,)
        Each window holds the frames from `first` up to `last`.

    Returns
    -------
    ndarray of float32, shape (n_windows, n_names)
        By `TRAJECTORY_NAMES`, each in its declared [unit]; NaN where a window has fewer than three
        frames.

    Examples
    --------
    >>> from features.windows.frames import describe_frames
    >>> tone = np.sin(2 * np.pi * 1000.0 * np.arange(8000) / 16e3).astype(np.float32)
    >>> frames = describe_frames(tone, 7000.0)
    >>> found = trajectory_features(frames, np.array([0]), np.array([47]))[0]
    >>> bool(abs(found[TRAJECTORY_NAMES.index("peak_frequency")]) < 0.01)
    True
    """
    out = np.full((len(first), len(TRAJECTORY_NAMES)), np.nan, dtype=np.float32)
    counts = last - first
    for n in np.unique(counts[counts >= _LEAST_FRAMES]):
        chosen = counts == n
        # Frames along the first axis, windows along the second.
        at = first[chosen] + np.arange(n)[:, None]
        found = _trajectories(np.take(frames.values.T, at, axis=1))
        found |= _bands(np.take(frames.bands.T, at, axis=1), np.take(frames.values[:, 0], at))
        out[chosen] = np.stack([found[name] for name in TRAJECTORY_NAMES], axis=1)
    return out


def _trajectories(frames: NDArray[np.float32]) -> dict[str, NDArray[np.floating]]:
    """Return all but the bands, from `FRAME_COLUMNS` of shape (n_columns, n_frames, n_windows)."""
    level, flatness, centroid, peak, share, second, flux, pitch, periodicity = frames
    n = len(level)
    relative = (level - level.max(axis=0)).astype(np.float64)
    weight = 10.0 ** (0.1 * relative)
    above = np.maximum(relative, -_MOST_DB)
    mean, square = ordered_sum(np.stack([above, above * above]), axis=1) / n
    x = (np.arange(n) - 0.5 * (n - 1))[:, None]
    ordered = np.sort(level, axis=0)
    loud = ordered[int(0.95 * (n - 1))]
    change = np.diff(level, axis=0)
    voiced = periodicity.astype(np.float64)
    averaged = flatness, share, share > 0.5, second, flux, voiced, voiced > 0.6
    flat, tone_share, tonal, tone_second, flow, voice, voices = ordered_sum(
        weight * np.stack(averaged), axis=1
    ) / ordered_sum(weight)
    periodic = np.where(np.isnan(pitch), 0.0, weight * np.maximum(voiced, 0.0) ** 2)
    middle, deviation, drift = (
        np.split(found, 3)
        for found in _wander(
            np.concatenate([centroid, peak, pitch], axis=1),
            np.concatenate([weight, weight * share, periodic], axis=1),
        )
    )
    jump = np.abs(np.diff(peak, axis=0)).astype(np.float64)
    jumps = np.sort(jump, axis=0)
    return {
        "range": np.minimum(loud - ordered[int(0.1 * (n - 1))], _MOST_DB),
        "peak_above_median": np.minimum(loud - ordered[n // 2], _MOST_DB),
        "loud_share": (above > -10.0).sum(axis=0) / n,
        "fluctuation": np.sqrt(np.maximum(square - mean**2, 0.0)),
        "steepest_rise": np.clip(change.max(axis=0), 0.0, _MOST_DB),
        "steepest_fall": np.clip(0.0 - change.min(axis=0), 0.0, _MOST_DB),
        "trend": 100.0 * ordered_sum(x * above) / ordered_sum(x * x),
        "flatness": flat,
        "flatness_lowest": np.where(weight > 0.01, flatness, 0.0).min(axis=0, initial=0.0),
        "centroid": middle[0],
        "centroid_wander": deviation[0],
        "peak_frequency": middle[1],
        "peak_wander": deviation[1],
        "peak_drift": drift[1],
        "peak_jump": 0.5 * (jumps[(n - 2) // 2] + jumps[(n - 1) // 2]),
        "tone_share": tone_share,
        "tonal_frames": tonal,
        "tone_second": np.maximum(tone_second, -40.0),
        "flux": flow,
        "voiced": voice,
        "voiced_frames": voices,
        "pitch": middle[2],
        "pitch_wander": deviation[2],
        "pitch_drift": drift[2],
        "tone_steady": _longest_run((jump < 0.02) & (weight[1:] > 0.003)) / n,
    }


def _longest_run(steady: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the most frames in a row of which each is like the one before."""
    step = np.arange(len(steady))[:, None]
    broken = np.maximum.accumulate(np.where(steady, -1, step), axis=0)
    return np.asarray((step - broken).max(axis=0) + 1)


def _wander(
    course: NDArray[np.float32], weight: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return weighted median, robust deviation and slope [1/s] of a trajectory with gaps.

    A gap has no weight; all three are NaN where nothing has any.
    """
    weight = np.where(weight > 0.0, weight, 0.0)
    whole = ordered_sum(weight)
    order, columns = np.argsort(course, axis=0), np.arange(course.shape[1])
    reached = np.cumsum(weight[order, columns], axis=0) >= 0.5 * whole
    median = course[order[reached.argmax(axis=0), columns], columns]
    off = np.where(weight > 0.0, course - median, np.float32(0.0)).astype(np.float64)
    i = np.arange(len(course))[:, None]
    whole = np.where(whole > 0.0, whole, np.nan)
    x = i - ordered_sum(weight * i) / whole
    deviation = ordered_sum(weight * np.minimum(np.abs(off), 1.0)) / whole
    spread = weight * x * x
    spread[0] += 1e-9
    drift = 100.0 * ordered_sum(weight * x * np.clip(off, -0.5, 0.5)) / ordered_sum(spread)
    return np.where(whole > 0.0, median, np.nan), deviation, drift


def _bands(
    bands: NDArray[np.float32], level: NDArray[np.float32]
) -> dict[str, NDArray[np.float64]]:
    """Return mean power of the bands, and how far they change together.

    The bands are of shape (n_bands, n_frames, n_windows).
    """
    m, n, windows = bands.shape
    relative = (bands - level.max(axis=0)).astype(np.float64)
    power = ordered_sum(10.0 ** (0.1 * relative), axis=1)
    share = 10.0 * np.log10(np.maximum(power / ordered_sum(power), 1e-6))
    # One less the mean variance of what is left once the common rise and fall is taken out.
    height = np.maximum(relative, _QUIETEST_BAND_DB)
    high = int(0.95 * (n - 1))
    ordered = np.partition(height, (n // 2, high), axis=1)
    rise = ordered[:, high] - ordered[:, n // 2]
    onset = ordered_sum(np.maximum(np.diff(height, axis=1), 0.0)) / m
    height -= ordered_sum(height / n, axis=1)[:, None]
    mean = ordered_sum(height / m)
    common = ordered_sum(mean * mean)
    own = ordered_sum((height**2 / m).swapaxes(0, 1).reshape(n * m, windows))
    together = np.divide(common, own, out=np.zeros(windows), where=own > 0.0)
    return {
        **dict(zip(_BAND_NAMES, share, strict=True)),
        "together": together,
        "band_rise": rise.max(axis=0),
        "band_rising": rise.argmax(axis=0) + 1,
        "onset": onset.max(axis=0),
        "onset_mean": ordered_sum(onset) / (n - 1),
    }
