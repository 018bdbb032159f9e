"""Beam modes estimated from recordings: the impulse response of what the rig file lacks.

What a structure does to a torque is linear, whatever its modes are: with x what went in and r what
came out too much beside the rig file, its impulse response is that of least squares (Wiener 1949),
of the length that it may have; both signals are made white before, so that all bands count, but not
the noise of sensors. Rooms, plates, limits and noise are fitted in the simulator's own forms: on
development cases estimates of these closed no more on recordings held out.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.linalg import solve_toeplitz
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import tukey

from models.condition import known_condition
from models.radiation.impulse_responses import ImpulseResponses
from models.transfer_functions.measured import impulse_response
from models.transfer_functions.transfer_function import TransferFunction
from noise.base.arrays import Array
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.simulated.transfer_functions import OUTPUTS, predict
from sim.chain import padded_sum
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Values
from sim.parameters import Parameter

ESTIMATED = "beam_modes"
"""The effect of which forms are estimated."""

_NOISE = 0.005
"""White noise of the torque, rms [Nm]; assumed."""

_FREE = 0.06
"""How long beams ring [s]; assumed."""

_LEAD = 0.08
"""Left out at the start, where what rings on from before is missing [s]; assumed."""

_NEIGHBOURHOOD = 60.0
"""Over which spectra are smoothed to make signals white [Hz]; assumed."""

_LEAST = 3e-3
"""White noise added to the whitened input, over its power; assumed."""

_USABLE = (0.40, 0.45)
"""Shares of the sampling rate between which a transfer function fades; assumed."""

_FADE = 0.25
"""Of an impulse response, as a share of its length; assumed."""


def estimated_forms(comparison: CaseComparison, chosen: Sequence[int]) -> list[Effect]:
    """Estimate forms of `ESTIMATED`.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to estimate from; those of the usual sampling rate are taken.

    Returns
    -------
    list of Effect
        Each of one number, ``amount``; none where nothing can be estimated.
    """
    rates = {i: comparison.recordings[i].rate for i in chosen}
    rate = Counter(rates.values()).most_common(1)[0][0]
    free: list[dict[str, tuple[Array, Array]]] = []
    bolted: list[dict[str, tuple[Array, Array]]] = []
    for i in chosen:
        if rates[i] == rate and "acceleration" in (pairs := _pairs(comparison, i)):
            support = known_condition(comparison.recordings[i].condition).support_stiffness
            (bolted if math.isinf(support) else free).append(pairs)
    forms = [_form("on beams", free, rate, bolted=False)] if free else []
    if bolted:
        forms.append(_form("however the clamp stands", [*free, *bolted], rate, bolted=True))
    return forms


def _pairs(comparison: CaseComparison, i: int) -> dict[str, tuple[Array, Array]]:
    """Return a recording's torque with what each output has that it should not have made of it."""
    recording = comparison.recordings[i]
    row = recording.first("torque")
    if row is None:
        return {}
    torque = recording.samples[row]
    transfers = comparison.runs.transfer_functions.whole(recording)
    return {
        kind: (torque, recording.samples[out] - predict(torque, recording.rate, transfers[kind]))
        for kind in OUTPUTS
        if (out := recording.first(kind)) is not None
    }


def _form(
    what: str, having: Sequence[Mapping[str, tuple[Array, Array]]], rate: float, *, bolted: bool
) -> Effect:
    """Return a form of beam modes by what recordings have too much."""
    estimates = {
        kind: wiener_estimate([pairs[kind] for pairs in having], rate, _FREE, noise=_NOISE)
        for kind in OUTPUTS
        if all(kind in pairs for pairs in having)
    }

    def chain(
        paths: ImpulseResponses, _form: str, values: Values, _rng: np.random.Generator
    ) -> ImpulseResponses:
        if not bolted and not np.any(paths.pulse_to_acceleration):
            return paths  # the clamp is bolted down
        n = round(_FREE * paths.rate)
        more: dict[str, Any] = {
            f"torque_to_{kind}": padded_sum([
                getattr(paths, f"torque_to_{kind}"),
                values["amount"] * impulse_response(transfer, paths.rate, n),
            ])
            for kind, transfer in estimates.items()
        }  # fmt: skip
        return replace(paths, **more)

    amount = Parameter(1.0, "", 0.0, 4.0, "over what was estimated")
    stage = EFFECTS[ESTIMATED].stage
    return Effect(
        ESTIMATED, stage, (f"estimated {what}",), {"amount": amount}, "amount", chain=chain
    )


def wiener_estimate(
    pairs: Sequence[tuple[Array, Array]], rate: float, length: float, *, noise: float = 0.0
) -> TransferFunction:
    """Estimate what makes the second of each pair from the first.

    Parameters
    ----------
    pairs : sequence of (ndarray of shape (n,), ndarray of shape (n,))
        What went in and what came out, of one recording each, all at one rate [any units].
    rate : float
        Sampling rate [Hz].
    length : float
        How long the impulse response is [s].
    noise : float
        White noise of the input, rms, which a line must exceed to tell something [any unit].

    Returns
    -------
    TransferFunction
        0 towards its last line.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> x = rng.standard_normal(8000)
    >>> late = np.concatenate([np.zeros(5), 0.5 * x[:-5]])
    >>> found = wiener_estimate([(x, late)], 8e3, 0.01)
    >>> round(float(abs(found.at(np.array([1000.0]))[0])), 1)
    0.5
    """
    cut = round(_LEAD * rate)
    n = next_fast_len(2 * max(x.size for x, _ in pairs), real=True)
    frequency = np.asarray(np.fft.rfftfreq(n, 1.0 / rate), np.float64)
    power, cross = np.zeros(n // 2 + 1), np.zeros(n // 2 + 1, complex)
    least = 0.0
    for x, r in pairs:
        window = tukey(x.size - cut, 0.1)
        of_x = rfft((x[cut:] - x[cut:].mean()) * window, n)
        of_r = rfft((r[cut:] - r[cut:].mean()) * window, n)
        weight = 1.0 / (float(np.mean(np.abs(of_x) ** 2)) + 1e-30)
        power += weight * np.abs(of_x) ** 2
        cross += weight * np.conj(of_x) * of_r
        least += weight * float(np.sum(window**2)) * noise**2
    width = max(3, round(_NEIGHBOURHOOD * n / rate))
    white = 1.0 / (uniform_filter1d(power, width, mode="nearest") + least + 1e-30)
    m = min(round(length * rate), n // 4)
    alike, common = irfft((power + least) * white, n), irfft(cross * white, n)
    first = alike[:m].copy()
    first[0] *= 1.0 + _LEAST
    taps = solve_toeplitz(first, common[:m])
    taps *= np.clip((m - np.arange(m)) / max(_FADE * m, 1.0), 0.0, 1.0)
    low, high = (share * rate for share in _USABLE)
    fading = np.clip((high - frequency) / (high - low), 0.0, 1.0)
    return TransferFunction(frequency, np.asarray(rfft(taps, n) * fading))
