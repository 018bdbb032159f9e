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
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft
from scipy.linalg import solve_toeplitz
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import tukey

from models.condition import known_condition
from models.radiation.impulse_responses import ImpulseResponses
from models.transfer_functions.measured import impulse_response
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.simulated.transfer_functions import predict
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

_AMOUNT = Parameter(1.0, "", 0.0, 4.0, "over what was estimated")


@dataclass(frozen=True, eq=False)
class _Compared:
    """The torque of a recording, and what the outputs have that it should not have made of them."""

    free: bool
    torque: NDArray[np.float64]
    left: dict[str, NDArray[np.float64]]


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
    compared = [_compared(comparison, i) for i in chosen if rates[i] == rate]
    having = [c for c in compared if "acceleration" in c.left]
    free = [c for c in having if c.free]
    forms = [_form("on beams", _beside(free, rate, bolted=False))] if free else []
    if len(free) < len(having):
        forms.append(_form("however the clamp stands", _beside(having, rate, bolted=True)))
    return forms


def _form(what: str, chain: Callable[..., ImpulseResponses]) -> Effect:
    stage = EFFECTS[ESTIMATED].stage
    name = f"estimated {what}"
    return Effect(ESTIMATED, stage, (name,), {"amount": _AMOUNT}, "amount", chain=chain)


def _compared(comparison: CaseComparison, i: int) -> _Compared:
    recording = comparison.recordings[i]
    free = not math.isinf(known_condition(recording.condition).support_stiffness)
    rows = {kind: recording.first(kind) for kind in ("torque", "acceleration", "pressure")}
    if rows["torque"] is None:
        return _Compared(free, np.empty(0), {})
    torque, transfers = (
        recording.samples[rows.pop("torque")],
        comparison.runs.transfer_functions.whole(recording),
    )
    return _Compared(free, torque, {
        kind: recording.samples[row] - predict(torque, recording.rate, transfers[kind])
        for kind, row in rows.items()
        if row is not None
    })  # fmt: skip


def _beside(
    having: Sequence[_Compared], rate: float, *, bolted: bool
) -> Callable[..., ImpulseResponses]:
    kinds = [k for k in ("acceleration", "pressure") if all(k in c.left for c in having)]
    noise = [np.full(1, _NOISE**2)] * len(having)
    estimates = {
        kind: wiener_estimate(
            [(c.torque, c.left[kind]) for c in having], rate, _FREE, noise=lambda _f: noise
        )
        for kind in kinds
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

    return chain


def wiener_estimate(
    pairs: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
    rate: float,
    length: float,
    *,
    noise: Callable[[NDArray[np.float64]], Sequence[NDArray[np.float64]]] | None = None,
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
    noise : callable, optional
        What a line of the input must exceed to tell something: mean squares of each pair, by
        frequencies [Hz].

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
    least = np.zeros(n // 2 + 1)
    floors = [np.zeros(1)] * len(pairs) if noise is None else noise(frequency)
    for (x, r), floor in zip(pairs, floors, strict=True):
        window = tukey(x.size - cut, 0.1)
        of_x = rfft((x[cut:] - x[cut:].mean()) * window, n)
        of_r = rfft((r[cut:] - r[cut:].mean()) * window, n)
        weight = 1.0 / (float(np.mean(np.abs(of_x) ** 2)) + 1e-30)
        power += weight * np.abs(of_x) ** 2
        cross += weight * np.conj(of_x) * of_r
        least += weight * float(np.sum(window**2)) * floor
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
