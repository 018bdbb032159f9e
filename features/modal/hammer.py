"""Hits with an impulse hammer: which can be used, and the transfer function that they give.

Each hit is one segment under a boxcar window: the force is over before the segment ends and the
response has died away, so a window could only add damping that is not there. Cross- and
autospectra are averaged over the hits. H1 takes noise to be in the response alone, H2 in the force
alone, Hv in both in proportion to their power, which puts it half-way (geometrically) between.

A second contact of the hammer makes notches in the spectrum of the force, and a clipped one is
not the force; neither can be mended, so such hits are refused.

J. S. Bendat, A. G. Piersol, Random Data, chapters 6 and 9; for Hv G. T. Rocklin, J. Crowley,
H. Vold, A comparison of the H1, H2, and Hv frequency response functions, Proc. IMAC 3 (1985).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import csd, find_peaks, welch

from models.errors import ParameterError, RecordingError
from models.show import short_repr
from models.transfer_functions.transfer_function import TransferFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["ESTIMATORS", "Hit", "check_hit", "estimate_transfer_function"]

ESTIMATORS = ("H1", "H2", "Hv")
"""For noise in the response, for noise in the force, for noise in both."""

DOUBLE_HIT = 0.05
"""A further contact counts from this share of the largest force on; ringing of the sensor's own
filter stays below."""

FLAT, NEAR = 3.0, 0.03
"""A signal is clipped that stands at its limit so many times as often as just below it."""

LEAST_CREST = 10.0
"""Largest force over the rms of the rest, below which there is no hit to be seen."""

_FINE = 1e-3  # steps of a converter, relative to the peak, that leave two neighbours unlike
_EVEN = 1e-4  # flanks of a top that is sampled evenly about its middle differ by less
_DIGITS = 9  # to which levels of a converter agree


@short_repr
@dataclass(frozen=True, eq=False)
class Hit:
    """One hit.

    Parameters
    ----------
    force : ndarray, shape (n,)
        [N], or [N m] where an arm has turned it into a torque.
    response : ndarray, shape (n,)
        Such as an acceleration [m/s2].
    rate : float
        Sampling rate [Hz].
    name : str
        What messages call it, usually its file.

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
    """Refuse a hit that would spoil the average.

    Parameters
    ----------
    hit : Hit

    Raises
    ------
    RecordingError
        There is no hit in it, a second one, or force or response is clipped.

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
    if not hit.response.any():
        raise RecordingError(f"{hit.name}: the response is zero throughout")
    top = int(np.argmax(np.abs(hit.force)))
    force = hit.force * math.copysign(1.0, hit.force[top])
    peak = float(force[top])
    start, end = _lobe(force, top, DOUBLE_HIT)
    rest = np.concatenate([force[:start], force[end:]])
    if not (peak > 0.0 and rest.size and peak > LEAST_CREST * math.sqrt(np.mean(rest**2))):
        raise RecordingError(
            f"{hit.name}: no hit; the force has no peak that stands {LEAST_CREST:g} times above "
            "the rest"
        )
    response = hit.response
    for channel, signal in (("force", force), ("response", response), ("response", -response)):
        if flat := _flat_top(signal):
            raise RecordingError(
                f"{hit.name}: {channel} is clipped; {flat} samples stand at its limit of "
                f"{float(signal.max()):.4g}"
            )
    height = DOUBLE_HIT * peak
    contacts, _ = find_peaks(np.concatenate([[0.0], force, [0.0]]), height, prominence=height)
    if contacts.size > 1:
        first, second = (contacts - 1)[:2] / hit.rate
        raise RecordingError(
            f"{hit.name}: double hit; the force rises again {1e3 * (second - first):.3g} ms after "
            f"the peak at {first:.5g} s"
        )


def estimate_transfer_function(
    hits: Sequence[Hit],
    *,
    estimator: str = "H1",
    input_unit: str = "N",
    output_unit: str = "m/s^2",
    name: str = "response",
) -> TransferFunction:
    """Estimate the transfer function and its coherence, averaged over hits.

    Parameters
    ----------
    hits : sequence of Hit
        At least one, all of one sampling rate and length.
    estimator : str
        ``"H1"``, ``"H2"`` or ``"Hv"``.
    input_unit, output_unit : str
        Of force and response.
    name : str
        What messages call it.

    Returns
    -------
    TransferFunction
        From 0 Hz; its ordinary coherence is None where there is a single hit, which has none.

    Raises
    ------
    ParameterError
        There are no hits, they differ in sampling rate or length, or the estimator is unknown.

    Examples
    --------
    >>> force = np.zeros(64)
    >>> force[3] = 1.0
    >>> hits = [Hit(force, 2.0 * force, 1e3), Hit(-force, -2.0 * force, 1e3)]
    >>> found = estimate_transfer_function(hits)
    >>> float(found.response[5].real.round(6)), float(found.coherence[5].round(6))
    (2.0, 1.0)
    """
    if not hits:
        raise ParameterError("there are no hits to average")
    if estimator not in ESTIMATORS:
        raise ParameterError(f"estimator = {estimator!r} must be {', '.join(ESTIMATORS)}")
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
    # Bins that hold nothing at all give zero, not a warning.
    found = cross / np.maximum(of_force, np.finfo(np.float64).tiny)
    power = np.abs(cross) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = power / (of_force * of_response)
        if estimator == "H2":
            found = np.where(power > 0.0, of_response / np.where(power > 0.0, cross.conj(), 1.0), 0)
        elif estimator == "Hv":
            found = found * np.where(ratio > 0.0, 1 / np.sqrt(ratio), 0.0)
    coherence = np.clip(np.where(np.isfinite(ratio), ratio, 0.0), 0.0, 1.0)
    return TransferFunction(
        frequencies, found, coherence if len(hits) > 1 else None, input_unit, output_unit, name
    )


def _lobe(signal: NDArray[np.float64], top: int, share: float) -> tuple[int, int]:
    """First sample and end of what stays above a share of the value at `top`."""
    below = signal < share * signal[top]
    before = np.flatnonzero(below[:top])
    after = np.flatnonzero(below[top:])
    return (
        int(before[-1]) + 1 if before.size else 0,
        top + int(after[0]) if after.size else signal.size,
    )


def _flat_top(signal: NDArray[np.float64]) -> int:
    """How many samples stand at the largest value, 0 where that is no clipping.

    What goes over its top passes through the values just below it, and comes near the very top
    less often than that, even where a converter rounds; what is clipped skips them.
    """
    peak = float(signal.max())
    if peak <= 0.0:
        return 0
    levels = np.unique(np.round(signal / peak, _DIGITS))
    step = float(np.diff(levels).min()) if levels.size > 1 else 0.0
    top = signal >= peak * (1 - 1e-12)
    close = (signal >= peak * (1 - max(NEAR, 1.5 * step))) & ~top
    n_top, n_close = int(top.sum()), int(close.sum())
    if n_top == 2 and n_close == 0 and step < _FINE:
        first, second = (int(i) for i in np.flatnonzero(top))
        flanks = signal[max(first - 1, 0)], signal[min(second + 1, signal.size - 1)]
        uneven = abs(flanks[0] - flanks[1]) > max(10.0 * step, _EVEN) * peak
        return n_top if second == first + 1 and uneven else 0
    return n_top if n_top > 2 and n_top > FLAT * n_close else 0
