"""Forms of effects estimated from recordings: an impulse response, a static curve, a spectrum.

What a structure or a room does to a signal is linear, whatever its modes are: with x what went in
and r what came out too much beside the rig file, its impulse response is that of least squares
(Wiener 1949), of the length that it may have; both signals are made white before, so that all bands
count, but not the noise of sensors. What an overloaded channel reads is a curve over what it should
read, and noise is what bands have too much.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft
from scipy.linalg import solve_toeplitz
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import tukey

from models.condition import known_condition
from models.transfer_functions.filtering import impulse_response
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.gap.signature import EDGES, KINDS, NAMES
from noise.diagnosis.simulated.transfer_functions import predict
from sim.chain import filter_pressure, padded_sum
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Signals, Values
from sim.parameters import Parameter

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses
    from noise.diagnosis.fit.case_comparison import CaseComparison

_NOISE = {"torque": 0.005, "acceleration": 0.03, "pressure": 1e-3}
"""White noise of a channel, rms in its unit; assumed."""

_FREE = 0.06
"""How long beams ring [s]; assumed."""

_ROOMS = (0.05, 0.2)
"""How long a room rings [s]; assumed."""

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

_KNOTS, _FEWEST = 61, 5
"""Of an overload's curve, from the lowest to the highest reading; samples that make one known."""

_SURE, _UNSTEADY = 2.0, 0.1
"""An excess of noise counts from so many standard errors; relative error of a band's power;
assumed."""

_AMOUNT = Parameter(1.0, "", 0.0, 4.0, "over what was estimated")


@dataclass(frozen=True, eq=False)
class _Compared:
    """A recording, and what its torque should have made of the other channels."""

    rate: float
    free: bool
    measured: dict[str, NDArray[np.float64]]
    expected: dict[str, NDArray[np.float64]]
    transfer_functions: Mapping[str, TransferFunction]


def estimated_forms(comparison: CaseComparison, chosen: Sequence[int], name: str) -> list[Effect]:
    """Estimate forms of an effect.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to estimate from; those of the usual sampling rate are taken.
    name : str
        Of the effect.

    Returns
    -------
    list of Effect
        Each of one number, ``amount``; none where nothing can be estimated.
    """
    if name == "background_noise":
        return _noise_forms(comparison, chosen)
    if name not in _BY_TORQUE:
        return []
    usual = Counter(comparison.recordings[i].rate for i in chosen).most_common(1)[0][0]
    compared = [_compared(comparison, i) for i in chosen]
    return _BY_TORQUE[name](name, [c for c in compared if c.rate == usual])


def _form(name: str, what: str, **acting: object) -> Effect:
    stage = EFFECTS[name].stage
    return Effect(name, stage, (f"estimated {what}",), {"amount": _AMOUNT}, "amount", **acting)  # type: ignore[arg-type]


def _compared(comparison: CaseComparison, i: int) -> _Compared:
    recording = comparison.recordings[i]
    measured = {
        kind: recording.samples[row].astype(np.float64)
        for kind in KINDS
        if (row := recording.first(kind)) is not None
    }
    transfers: Mapping[str, TransferFunction] = {}
    if "torque" in measured:
        transfers = comparison.runs.transfer_functions.whole(recording)
    expected: dict[str, NDArray[np.float64]] = {
        kind: predict(measured["torque"], recording.rate, transfers[kind])
        for kind in ("acceleration", "pressure")
        if transfers and kind in measured
    }
    support = known_condition(recording.condition).support_stiffness
    return _Compared(recording.rate, not math.isinf(support), measured, expected, transfers)


def _radiation_forms(name: str, compared: Sequence[_Compared]) -> list[Effect]:
    """Estimate what the sound has too much of the expected one."""
    forms = []
    for length in _ROOMS:
        found = _relative(compared, "pressure", length)
        if found is not None:
            forms.append(_form(name, f"{1e3 * length:.0f} ms", chain=_through(found, length)))
    return forms


def _through(found: TransferFunction, length: float) -> Callable[..., ImpulseResponses]:
    def chain(
        paths: ImpulseResponses, _form: str, values: Values, _rng: np.random.Generator
    ) -> ImpulseResponses:
        taps = values["amount"] * impulse_response(found, paths.rate, round(length * paths.rate))
        taps[0] += 1.0
        return filter_pressure(paths, taps)

    return chain


def _beam_forms(name: str, compared: Sequence[_Compared]) -> list[Effect]:
    """Estimate what torque makes of acceleration and sound beside what was expected."""
    having = [c for c in compared if "acceleration" in c.expected]
    free = [c for c in having if c.free]
    forms = [_form(name, "on beams", chain=_beside(free, bolted=False))] if free else []
    if len(free) < len(having):
        forms.append(_form(name, "however the clamp stands", chain=_beside(having, bolted=True)))
    return forms


def _beside(having: Sequence[_Compared], *, bolted: bool) -> Callable[..., ImpulseResponses]:
    kinds = [k for k in ("acceleration", "pressure") if all(k in c.expected for c in having)]
    noise = [np.full(1, _NOISE["torque"] ** 2)] * len(having)
    found = {
        kind: wiener_estimate(
            [(c.measured["torque"], c.measured[kind] - c.expected[kind]) for c in having],
            having[0].rate, _FREE, noise=lambda _f: noise,
        )
        for kind in kinds
    }  # fmt: skip

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
            for kind, transfer in found.items()
        }  # fmt: skip
        return replace(paths, **more)

    return chain


def _relative(compared: Sequence[_Compared], kind: str, length: float) -> TransferFunction | None:
    """Estimate what a channel has too much of what was expected of it."""
    having = [c for c in compared if kind in c.expected]
    if not having:
        return None

    def noise(frequency: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """Of the channel, and of the torque through the path that made the input of it."""
        ways = [c.transfer_functions[kind].at(frequency, falls_below=True) for c in having]
        return [_NOISE[kind] ** 2 + np.abs(_NOISE["torque"] * way) ** 2 for way in ways]

    pairs = [(c.expected[kind], c.measured[kind] - c.expected[kind]) for c in having]
    return wiener_estimate(pairs, having[0].rate, length, noise=noise)


def _limit_forms(name: str, compared: Sequence[_Compared]) -> list[Effect]:
    """Estimate the curve of acceleration and sound over what the torque lets expect."""
    kinds = [k for k in ("acceleration", "pressure") if all(k in c.expected for c in compared)]
    curves = {
        k: np.median([_curve(c.expected[k], c.measured[k], c.rate) for c in compared], axis=0)
        for k in kinds
    }
    sets = [(kind,) for kind in kinds] + ([tuple(kinds)] if len(kinds) > 1 else [])
    return [
        _form(name, f"of {' and '.join(one)}", sensors=_bent({k: curves[k] for k in one}))
        for one in sets
    ]


def _bent(curves: Mapping[str, NDArray[np.float64]]) -> Callable[..., Signals]:
    def sensors(
        signals: Signals, _rate: float, _form: str, values: Values, _rng: np.random.Generator
    ) -> Signals:
        read = dict(signals)
        for kind, curve in curves.items():
            away, peak = _scaled(signals[kind])
            bent = np.interp(away, np.linspace(-1.0, 1.0, _KNOTS), curve)
            read[kind] = signals[kind] + values["amount"] * peak * (bent - away)
        return read

    return sensors


def _scaled(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    away = x - x.mean()
    peak = float(np.abs(away).max()) or 1.0
    return np.asarray(away / peak), peak


def _curve(
    expected: NDArray[np.float64], measured: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    cut = round(_LEAD * rate)
    x, peak = _scaled(expected[cut:])
    y = (measured[cut:] - measured[cut:].mean()) / peak
    place = np.clip(((x + 1.0) * 0.5 * (_KNOTS - 1)).round().astype(int), 0, _KNOTS - 1)
    count = np.bincount(place, minlength=_KNOTS)
    total = np.bincount(place, y, minlength=_KNOTS)
    known, knots = count >= _FEWEST, np.linspace(-1.0, 1.0, _KNOTS)
    return np.interp(knots, knots[known], total[known] / count[known])


_BY_TORQUE: dict[str, Callable[[str, Sequence[_Compared]], list[Effect]]] = {
    "beam_modes": _beam_forms,
    "plate_modes": _radiation_forms,
    "room_reflections": _radiation_forms,
    "clipping": _limit_forms,
}


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


def _noise_forms(comparison: CaseComparison, chosen: Sequence[int]) -> list[Effect]:
    """Estimate stationary noise: power that bands surely have too much, channel by channel."""
    references = [comparison.references[i] for i in chosen]
    measured = np.exp(2.0 * np.array([comparison.signatures[i] for i in chosen]))
    nominal = np.exp(2.0 * np.array([one.mean for one in references]))
    scale = np.array([one.scale for one in references])
    weight = 1.0 / ((2.0 * scale * nominal) ** 2 + (_UNSTEADY * measured) ** 2)
    total = np.nansum(weight, axis=0)
    excess = np.nansum(weight * (measured - nominal), axis=0) / total
    excess = np.where(excess > _SURE / np.sqrt(total), excess, 0.0)
    densities = {
        kind: excess[[i for i, name in enumerate(NAMES) if name.startswith(kind)]] / np.diff(EDGES)
        for kind in KINDS
    }
    densities = {kind: density for kind, density in densities.items() if density.any()}
    if not densities:
        return []

    def sensors(
        signals: Signals, rate: float, _form: str, values: Values, rng: np.random.Generator
    ) -> Signals:
        noisy = dict(signals)
        for kind, density in densities.items():
            more = _noise(noisy[kind].size, rate, density, rng)
            noisy[kind] = noisy[kind] + values["amount"] * more
        return noisy

    return [_form("background_noise", "by its bands", sensors=sensors)]


def _noise(
    n: int, rate: float, density: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    length = next_fast_len(n, real=True)
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    place = np.clip(np.digitize(frequency, EDGES) - 1, 0, density.size - 1)
    inside = (frequency > 0.5 * EDGES[0]) & (frequency < EDGES[-1])
    size = np.sqrt(0.5 * rate * density[place] * inside)
    return np.asarray(irfft(size * rfft(rng.standard_normal(length)), length)[:n])
