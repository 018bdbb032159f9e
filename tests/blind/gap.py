"""How far a case lies from what it would be with nothing the matter, in floors.

The examiner's own measure, so that which cases count does not hang on the candidate's. Sixth-octave
levels of torque, acceleration and pressure, and size and phase of the ways from one channel to the
next, are taken with and without what is the matter, all chance being the same; the floor of each is
how repeats differ without, smoothed over neighbouring bands. The gap is that of the channel or way
which differs most, 1 where nothing does: a recording differs from a repeat by the floor as well.
A band counts for six floors at most, so that none decides alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import uniform_filter1d

from .benches import CHANNELS
from .cases import Case, run_case

if TYPE_CHECKING:
    from .design import Design

__all__ = ["gap_between", "gaps_of", "null_gap", "repeats_of", "summary"]

_LOWEST, _HIGHEST_SHARE, _PER_OCTAVE = 40.0, 0.42, 6
_LEAST_LEVEL, _LEAST_PHASE = 0.5, 0.05
_SMOOTHED = 7
_WAYS = ((0, 1), (0, 2), (1, 2))
_PHASED, _FEWEST_LINES = 0.7, 8
_LARGEST = 6.0


def _edges(rate: float) -> np.ndarray:
    octaves = np.log2(_HIGHEST_SHARE * rate / _LOWEST)
    return _LOWEST * 2.0 ** (np.arange(int(_PER_OCTAVE * octaves) + 1) / _PER_OCTAVE)


def summary(samples: np.ndarray, rate: float) -> np.ndarray:
    """Levels [dB] of three channels, then size [dB] and phase [rad] of three ways, by band."""
    x = samples[:3].astype(float)
    n = x.shape[1]
    spectrum = np.fft.rfft((x - x.mean(axis=1, keepdims=True)) * np.hanning(n), axis=1)
    first = np.searchsorted(np.fft.rfftfreq(n, 1.0 / rate), _edges(rate))

    def banded(y: np.ndarray) -> np.ndarray:
        return np.add.reduceat(y, first, axis=-1)[..., :-1]

    power = banded(np.abs(spectrum) ** 2) + 1e-30
    cross = np.stack([banded(spectrum[b] * spectrum[a].conj()) for a, b in _WAYS])
    level = 10.0 * np.log10(power)
    size = np.stack([20.0 * np.log10(np.abs(c) + 1e-30) - level[a] for c, (a, _) in
                     zip(cross, _WAYS, strict=True)])  # fmt: skip
    coherent = [np.abs(c) / np.sqrt(power[a] * power[b]) for c, (a, b) in
                zip(cross, _WAYS, strict=True)]  # fmt: skip
    phased = (np.array(coherent) > _PHASED) & (np.diff(first) >= _FEWEST_LINES)
    phase = np.where(phased, np.angle(cross), np.nan)
    return np.concatenate([level, size, phase])


def _apart(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Differences of two summaries; phases by the shorter way, none where there is no phase."""
    d = one - other
    d[6:] = np.nan_to_num(np.angle(np.exp(1j * d[6:])))
    return d


def gap_between(
    with_it: list[np.ndarray],
    without: list[np.ndarray],
    repeats: list[tuple[np.ndarray, np.ndarray]],
    rate: float,
    channels: tuple[str, ...] = tuple(CHANNELS),
) -> float:
    """Gap of recordings from the same without; `repeats` are pairs of one condition, without."""
    plain = [summary(x, rate) for x in without]
    away = [_apart(summary(x, rate), y) for x, y in zip(with_it, plain, strict=True)]
    spread = np.mean([_apart(summary(x, rate), summary(y, rate)) ** 2 for x, y in repeats], axis=0)
    smooth = uniform_filter1d(spread, _SMOOTHED, axis=1, mode="nearest")
    floor = np.sqrt(np.maximum(smooth, 0.0))
    least = np.repeat([_LEAST_LEVEL, _LEAST_PHASE], [6, 3])[:, None]
    z = np.minimum(np.abs(away) / np.maximum(floor, least), _LARGEST)
    of_channel = [name in channels for name in ("torque", "acceleration", "pressure")]
    seen = of_channel + [of_channel[a] and of_channel[b] for a, b in _WAYS]
    gap = float(np.sqrt(1.0 + np.mean(z**2, axis=(0, 2))[seen + seen[3:]].max()))
    if not np.isfinite(gap):
        raise RuntimeError("the gap is not finite")
    return gap


def repeats_of(design: Design, without: tuple) -> list[tuple[np.ndarray, np.ndarray]]:
    """Pairs of recordings of one condition; where the case repeats none, its first two are."""
    c = design.conditions
    found = [(without[i], without[j]) for i in range(len(c)) for j in range(i) if c[i] == c[j]]
    if found:
        return found
    few = replace(design, conditions=c[:2], offsets={}, forms=())
    return list(zip(run_case(few).recordings, run_case(few, again=3).recordings, strict=True))


def gaps_of(case: Case) -> dict:
    """Gap of a case and, of several effects, of each by itself; as the answer's further keys."""
    design = case.design
    names = [form.effect for form, _ in design.forms]
    if design.kind == "none":
        return {"gap": 1.0, "gap_alone": {}}
    plain = run_case(design, frozenset(names), plain=True).recordings
    repeats = repeats_of(design, plain)

    def gap(of: Case) -> float:
        return gap_between(of.recordings, plain, repeats, design.rate, design.bench.channels)

    alone = {
        name: gap(run_case(design, frozenset(names) - {name})) for name in names if len(names) > 1
    }
    return {"gap": gap(case), "gap_alone": alone}


def null_gap(design: Design) -> float:
    """Gap of a bench on which nothing is the matter from the one that its user describes.

    Both are of other chance, so that it is about that of two repeats; what sidecars say wrongly is
    right in the second.
    """
    null = replace(design, kind="none", offsets={}, forms=())
    right = replace(null, bench=replace(design.bench, speed_factor=1.0, warmer=0.0))
    recordings = run_case(null).recordings
    repeats = repeats_of(null, recordings)
    described = run_case(right, again=1).recordings
    return gap_between(recordings, described, repeats, design.rate, design.bench.channels)
