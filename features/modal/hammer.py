"""Impulse hammer hits: checks, and the transfer function with its coherence.

Each hit is one segment with a boxcar window: the force ends and the response decays before its end,
so a window would only add damping. Cross- and autospectra are averaged over the hits. The estimator
is H1, which assumes noise in the response only.

A second contact of the hammer causes notches in the spectrum of the force, a clipped force is
wrong, and a drifting force hides its lowest lines; none can be corrected, so such hits are refused.

J. S. Bendat, A. G. Piersol, Random Data, chapters 6 and 9.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import csd, find_peaks, welch

from models.errors import ParameterError, RecordingError
from models.show import short_repr
from models.transfer_functions.transfer_function import TransferFunction

DOUBLE_HIT = 0.05
"""Share of the largest force from which a further contact counts; ringing of the sensor's filter is
lower."""

FLAT, NEAR = 3.0, 0.03
"""Ratio of samples at the limit to those within 3 % below it, from which a signal is clipped."""

LEAST_CREST = 10.0
"""Least ratio of the largest force to the rms of the rest."""

LONGEST_BLOW = 0.2
"""Longest contact of a hammer [s]; a longer one indicates a wrong unit of time."""

LARGEST_DRIFT = 0.01
"""Largest drift of the force outside the impact, over the largest force."""

NULL = 0.01
"""Power of the force at a null over that on either side."""

_SURE = 12.0  # times the median deviation of a part over the root of its length
_PARTS = 8  # of a force, whose medians show a drift but not a short impact
_LAST = 0.05  # share of a hit at its end
_BESIDE = 1.5  # frequency ratio within which a null has neighbours
_DIGITS = 9  # to which levels of a converter agree


@short_repr
@dataclass(frozen=True, eq=False)
class Hit:
    """Force and response of one hit.

    Parameters
    ----------
    force : ndarray, shape (n,)
        [N], or [N m] for a torque by an arm.
    response : ndarray, shape (n,)
        Such as an acceleration [m/s2].
    rate : float
        Sampling rate [Hz].
    name : str
        Name in messages, usually the file's.

    Examples
    --------
    >>> Hit(np.zeros(100), np.zeros(100), 25.6e3).name
    'hit'
    """

    force: NDArray[np.float64]
    response: NDArray[np.float64]
    rate: float
    name: str = "hit"


def check_hit(hit: Hit) -> None:
    """Raise if a hit would distort the average.

    Parameters
    ----------
    hit : Hit

    Raises
    ------
    RecordingError
        There is no hit, or a double one, or force or response is clipped.

    Examples
    --------
    >>> pulse = np.sin(np.pi * np.arange(0.5, 12) / 12)
    >>> ringing = np.exp(-0.01 * np.arange(500)) * np.sin(0.3 * np.arange(500))
    >>> force = np.zeros(500)
    >>> force[20:32] = 80 * pulse
    >>> check_hit(Hit(force, ringing, 10e3))
    >>> force[60:72] = 30 * pulse
    >>> check_hit(Hit(force, ringing, 10e3, "hit_3.npy"))
    Traceback (most recent call last):
    models.errors.RecordingError: hit_3.npy: double hit; the force rises again 4 ms after ...
    """
    problem = _problem(hit)
    if problem and not _problem(replace(hit, force=hit.response, response=hit.force)):
        problem = "force and response are swapped; the blow is in the response's place"
    if problem:
        raise RecordingError(f"{hit.name}: {problem}")


def _problem(hit: Hit) -> str:
    """Return the reason why a hit cannot be used; empty if it can."""
    if not hit.response.any():
        return "the response is zero throughout"
    force, top = _upright(hit.force)
    peak = float(force[top])
    start, end = _lobe(force, top)
    rest = np.concatenate([force[:start], force[end:]])
    parts = [part for part in np.array_split(force, _PARTS) if part.size]
    levels = np.array([np.median(part) for part in parts])
    scatter = max(
        float(np.median(np.abs(part - level))) / math.sqrt(part.size)
        for part, level in zip(parts, levels, strict=True)
    )
    if peak > 0.0 and float(np.ptp(levels)) > max(LARGEST_DRIFT * peak, _SURE * scatter):
        return (
            f"the force drifts beside the blow, from {levels[0]:.4g} to {levels[-1]:.4g} at a peak "
            f"of {peak:.4g}; the force of a hammer is zero there"
        )
    if not (peak > 0.0 and rest.size and peak > LEAST_CREST * math.sqrt(np.mean(rest**2))):
        return f"no hit; the force has no peak that stands {LEAST_CREST:g} times above the rest"
    response = hit.response
    for channel, signal in (("force", force), ("response", response), ("response", -response)):
        if flat := _flat_top(signal):
            return (
                f"{channel} is clipped; {flat} samples stand at its limit of "
                f"{float(signal.max()):.4g}"
            )
    height = DOUBLE_HIT * peak
    contacts, _ = find_peaks(np.concatenate([[0.0], force, [0.0]]), height, prominence=height)
    if contacts.size > 1:
        first, second = (contacts - 1)[:2] / hit.rate
        return (
            f"double hit; the force rises again {1e3 * (second - first):.3g} ms after the peak at "
            f"{first:.5g} s"
        )
    if end - start > LONGEST_BLOW * hit.rate:
        return f"the blow lasts {(end - start) / hit.rate:.3g} s; times must be in s"
    return ""


def remaining_response(hits: Sequence[Hit]) -> float:
    """Return the relative amplitude of the responses at the end of their hits.

    Parameters
    ----------
    hits : sequence of Hit

    Returns
    -------
    float
        Largest amplitude at an end, above the noise before the impact, relative to that after the
        impact [-].

    Examples
    --------
    >>> force, t = np.zeros(1000), np.arange(1000) / 1e3
    >>> force[100] = 1.0
    >>> ringing = np.where(t < 0.1, 0.0, np.exp(0.2 - 2 * t) * np.sin(300 * t))
    >>> round(remaining_response([Hit(force, ringing, 1e3)]), 2)
    0.18
    """
    remaining = 0.0
    for hit in hits:
        force, top = _upright(hit.force)
        start, _ = _lobe(force, top)
        length = max(1, round(_LAST * (hit.response.size - start)))
        power = hit.response**2
        before = float(power[:start].mean()) if start >= length // 2 and start else 0.0
        after = float(power[start : start + length].mean()) - before
        last = float(power[-length:].mean()) - before
        if last > 0.0:
            remaining = max(remaining, math.sqrt(last / after) if after > last else 1.0)
    return remaining


def force_nulls(
    hits: Sequence[Hit], frequency: NDArray[np.float64], half_width: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return whether the spectrum of the force has a null at frequencies.

    Parameters
    ----------
    hits : sequence of Hit
        Hits of one sampling rate and length.
    frequency, half_width : ndarray, shape (n,)
        Middle and half width of each band [Hz]; at least one line.

    Returns
    -------
    ndarray of bool, shape (n,)
        One entry per frequency [-].

    Examples
    --------
    >>> force = np.zeros(1000)
    >>> force[10:20] = 1.0
    >>> force_nulls([Hit(force, force, 1e3)], np.array([50.0, 102.0]), np.array([1.0, 3.0]))
    array([False,  True])
    """
    n, rate = hits[0].force.size, hits[0].rate
    lines, power = welch(
        np.concatenate([hit.force for hit in hits]), rate, "boxcar", n, 0, detrend=False
    )
    nulls = np.zeros(frequency.size, dtype=bool)
    for number, (f, reach) in enumerate(zip(frequency, half_width, strict=True)):
        least = float(power[np.abs(lines - f) <= max(reach, lines[1])].min())
        below = power[(lines >= f / _BESIDE) & (lines <= f)]
        above = power[(lines >= f) & (lines <= f * _BESIDE)]
        nulls[number] = all(side.size and least < NULL * side.max() for side in (below, above))
    return nulls


def estimate_transfer_function(
    hits: Sequence[Hit],
    *,
    input_unit: str = "N",
    output_unit: str = "m/s^2",
    name: str = "response",
) -> TransferFunction:
    """Estimate the transfer function and its coherence from hits.

    Parameters
    ----------
    hits : sequence of Hit
        One or more hits of one sampling rate and length.
    input_unit, output_unit : str
        Units of force and response.
    name : str
        Name in messages.

    Returns
    -------
    TransferFunction
        From 0 Hz, with ordinary coherence unless there is a single hit.

    Raises
    ------
    ParameterError
        There are no hits, or they differ in sampling rate or length.

    Examples
    --------
    >>> force = np.zeros(64)
    >>> force[3] = 1.0
    >>> hits = [Hit(force, 2.0 * force, 1e3), Hit(-force, -2.0 * force, 1e3)]
    >>> transfer = estimate_transfer_function(hits)
    >>> float(transfer.response[5].real.round(6)), float(transfer.coherence[5].round(6))
    (2.0, 1.0)
    """
    if not hits:
        raise ParameterError("there are no hits to average")
    n, rate = hits[0].force.size, hits[0].rate
    for hit in hits:
        if hit.force.size != n or hit.response.size != n or hit.rate != rate:
            raise ParameterError(
                f"{hit.name}: {hit.force.size} samples at {hit.rate:g} Hz, {hits[0].name} has {n} "
                f"at {rate:g} Hz; hits must be alike to be averaged"
            )
    force = np.concatenate([hit.force for hit in hits])
    response = np.concatenate([hit.response for hit in hits])
    frequencies, cross = csd(force, response, rate, "boxcar", n, 0, detrend=False)
    _, of_force = welch(force, rate, "boxcar", n, 0, detrend=False)
    _, of_response = welch(response, rate, "boxcar", n, 0, detrend=False)
    # Empty bins give zero without a warning.
    estimate = cross / np.maximum(of_force, np.finfo(np.float64).tiny)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(cross) ** 2 / (of_force * of_response)
    coherence = np.clip(np.where(np.isfinite(ratio), ratio, 0.0), 0.0, 1.0)
    return TransferFunction(
        frequencies, estimate, coherence if len(hits) > 1 else None, input_unit, output_unit, name
    )


def _upright(force: NDArray[np.float64]) -> tuple[NDArray[np.float64], int]:
    """Return the force with its largest value positive, and the index of that value."""
    top = int(np.argmax(np.abs(force)))
    return force * math.copysign(1.0, force[top]), top


def _lobe(signal: NDArray[np.float64], top: int) -> tuple[int, int]:
    """Return first sample and end of the lobe above `DOUBLE_HIT` of the value at `top`."""
    below = signal < DOUBLE_HIT * signal[top]
    before = np.flatnonzero(below[:top])
    after = np.flatnonzero(below[top:])
    return (
        int(before[-1]) + 1 if before.size else 0,
        top + int(after[0]) if after.size else signal.size,
    )


def _flat_top(signal: NDArray[np.float64]) -> int:
    """Return the number of samples at a clipped maximum; 0 without clipping.

    A signal that turns at its maximum has more samples just below it than at it, even if a
    converter rounds; a clipped signal skips them.
    """
    peak = float(signal.max())
    if peak <= 0.0:
        return 0
    levels = np.unique(np.round(signal / peak, _DIGITS))
    step = float(np.diff(levels).min()) if levels.size > 1 else 0.0
    top = signal >= peak * (1 - 1e-12)
    close = (signal >= peak * (1 - max(NEAR, 1.5 * step))) & ~top
    n_top, n_close = int(top.sum()), int(close.sum())
    return n_top if n_top > 2 and n_top > FLAT * n_close else 0
