"""Detection of channels that are swapped, in a wrong unit or inverted.

The angle is compared with the stated speed, the torque with the kinetic torque of the fit,
acceleration and sound with the prediction of the rig's path from the recorded torque. These ratios
depend little on the contact: an effect changes them little and a wrong unit changes them much.

Every threshold lies between the influence of effects and that of a wrong bench. Effects change the
torque by a factor of at most 6 and the gain of a path by a factor of at most 30 (impacts at slips
reach 17). A unit is named if the factor is that of a common unit, is the same in all recordings,
and the channel otherwise follows from the torque.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from features.kernels.spectra import segment_spectra
from models.condition import known_condition
from models.recording import Recording
from models.rig import Rig
from models.units import CHANNEL_UNITS
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import USABLE
from noise.diagnosis.prepare import measured_speed
from noise.diagnosis.simulated.transfer_functions import (
    OUTPUTS,
    TransferFunctionCache,
    predict,
)

_EXACT = 0.16
"""Largest difference of logarithms between a factor and that of a unit [-], which is the error of
gains; assumed."""

_UNITS = {
    "acceleration": {1.0 / 9.80665: "g", 1e3: "mm/s^2"},
    "pressure": {1e3: "mPa", 1e6: "uPa", 1e-3: "kPa"},
    "torque": {1e3: "N mm", 1e2: "N cm", 1e-3: "kN m"},
    "angle": {180.0 / math.pi: "degrees", 0.5 / math.pi: "turns", 1e3: "mrad"},
    "speed": {30.0 / math.pi: "rpm", 180.0 / math.pi: "degree/s"},
}
"""Wrong units by channel and by the factor by which they enlarge a value."""


def unit_of(kind: str, factor: float, within: float = _EXACT) -> str:
    """Return the wrong unit that explains a factor of a quantity; empty if none does.

    Parameters
    ----------
    kind : str
        Kind of the channel, or ``speed`` for the stated speed.
    factor : float
        Ratio of the read value to the true one [-].
    within : float
        Largest difference of logarithms [-].

    Examples
    --------
    >>> unit_of("pressure", 1020.0), unit_of("acceleration", 0.1), unit_of("torque", 1.1)
    ('mPa', 'g', '')
    """
    if factor <= 0.0:
        return ""
    units = {abs(math.log(factor / f)): unit for f, unit in _UNITS[kind].items()}
    nearest = min(units)
    return units[nearest] if nearest <= within else ""


def factor_words(factor: float) -> str:
    """Return the words for a quantity that is wrong by a factor [-].

    Examples
    --------
    >>> factor_words(1000.0), factor_words(0.102)
    ('1000 times too large', '9.8 times too small')
    """
    size = float(f"{max(factor, 1.0 / factor):.2g}")
    return f"{size:g} times too {'large' if factor > 1.0 else 'small'}"


KINDS = ("torque", "acceleration", "pressure", "angle")

_BAND = (80.0, 6000.0)
"""Frequency range of the comparison of a path [Hz]; assumed."""

_LENGTH = 2048
"""Length of a segment [samples]."""

_LEAD, _TAIL = 0.08, 0.01
"""Time omitted at the start, where the structure still rings from earlier, and at the end [s]; as
in `noise.diagnosis.evidence.channel_summary`."""

_STRONG = 1e-3
"""Least power of a spectral line of the prediction, as a share of the strongest line [-];
assumed."""

_LONGEST_DELAY = 2.5e-3
"""Largest delay between channels in their correlation [s]; assumed."""


@dataclass(frozen=True)
class PathFit:
    """Comparison of a measured signal with its prediction.

    Parameters
    ----------
    gain : float
        Amplitude of the coherent part over that of the prediction [-].
    explained : float
        Share of the measured power that is coherent with the prediction [-].
    alike : float
        Correlation with the prediction at the best delay [-].
    strength : float
        Median over the prediction's frequencies of the ratio of the amplitudes [-]; noise increases
        it, delays and clipped peaks do not change it.
    """

    gain: float
    explained: float
    alike: float
    strength: float


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of a recording relative to its rig, without a simulation.

    Parameters
    ----------
    speed : float
        Stated speed [rad/s].
    turned : float, optional
        Mean speed of the angle [rad/s]; None without an angle.
    torque : float, optional
        Mean torque over the kinetic torque of the fit, negative if it drives the stated
        rotation [-]; None without a torque.
    swing : float
        Standard deviation of the torque over the kinetic torque [-].
    paths : mapping of (str, str) to PathFit
        Fits of the prediction from the torque, by recorded channel and by path of the prediction.
    """

    speed: float
    turned: float | None
    torque: float | None
    swing: float
    paths: Mapping[tuple[str, str], PathFit] = field(default_factory=dict)


def levels_of(recording: Recording, rig: Rig, transfer_functions: TransferFunctionCache) -> Levels:
    """Compare the channels of a recording with its rig.

    Parameters
    ----------
    recording : Recording
        Recording with a known condition.
    rig : Rig
    transfer_functions : TransferFunctionCache
        Transfer functions of the rig.

    Returns
    -------
    Levels
    """
    c, rate = known_condition(recording.condition), recording.rate
    signal = {
        kind: np.asarray(recording.samples[row], dtype=np.float64)
        for kind in KINDS
        if (row := recording.first(kind)) is not None
    }
    turned = measured_speed(signal["angle"], rate) if "angle" in signal else None
    if "torque" not in signal:
        return Levels(c.speed, turned, None, 0.0)
    torque, kinetic = signal["torque"], rig.fit(c.interference).kinetic_torque
    paths: dict[tuple[str, str], PathFit] = {}
    outputs = [kind for kind in OUTPUTS if kind in signal]
    if outputs and float(np.ptp(torque)) > 0.0:
        functions = transfer_functions.whole(recording)
        for path in outputs:
            predicted = predict(torque, rate, functions[path])
            for kind in outputs:
                paths[kind, path] = path_fit(predicted, signal[kind], rate)
    braking = math.copysign(1.0, c.speed) * float(torque.mean()) / kinetic
    return Levels(c.speed, turned, braking, float(torque.std()) / kinetic, paths)


def path_fit(predicted: Array, measured: Array, rate: float) -> PathFit:
    """Compare a measured signal with its prediction.

    Parameters
    ----------
    predicted, measured : ndarray, shape (n,)
        Signals [unit of the channel].
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> sound = np.random.default_rng(0).normal(size=30_000)
    >>> fit = path_fit(sound, 9.81 * sound, 30e3)
    >>> round(fit.gain, 2), round(fit.explained, 2), round(fit.alike, 2)
    (9.81, 1.0, 1.0)
    """
    ends = slice(int(_LEAD * rate), predicted.size - int(_TAIL * rate))
    p, m = predicted[ends], measured[ends]
    frequency = np.fft.rfftfreq(_LENGTH, 1.0 / rate)
    inside = (frequency > _BAND[0]) & (frequency < min(_BAND[1], USABLE * rate))
    of_p, of_m = segment_spectra(p, _LENGTH)[:, inside], segment_spectra(m, _LENGTH)[:, inside]
    pp, mm = (np.abs(of_p) ** 2).mean(axis=0), (np.abs(of_m) ** 2).mean(axis=0)
    pm = (np.conj(of_p) * of_m).mean(axis=0)
    tiny = 1e-300
    coherent = float((np.abs(pm) ** 2 / (pp + tiny)).sum())
    gain = math.sqrt(coherent / (float(pp.sum()) + tiny))
    strong = pp > _STRONG * float(pp.max())
    strength = math.sqrt(float(np.median(mm[strong] / (pp[strong] + tiny)))) if pp.any() else 0.0
    return PathFit(gain, coherent / (float(mm.sum()) + tiny), _alike(p, m, rate), strength)


def _alike(p: Array, m: Array, rate: float) -> float:
    """Return the correlation of two signals, shape (n,), at the delay of largest magnitude [-]."""
    n = p.size
    size = 2 * n
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    inside = (frequency > _BAND[0]) & (frequency < min(_BAND[1], USABLE * rate))
    of_p, of_m = np.fft.rfft(p - p.mean(), size) * inside, np.fft.rfft(m - m.mean(), size) * inside
    power = float((np.abs(of_p) ** 2).sum()) * float((np.abs(of_m) ** 2).sum())
    if power <= 0.0:
        return 0.0
    correlation = np.fft.irfft(np.conj(of_p) * of_m, size) * 0.5 * size / math.sqrt(power)
    most = int(_LONGEST_DELAY * rate)
    near = np.concatenate([correlation[-most:], correlation[: most + 1]])
    return float(near[np.argmax(np.abs(near))])


_RISE = 0.3
"""Rise of a channel from its start to its end, over its mean, above which it is a ramp such as an
angle [-]; an angle rises by at least twice this, and a torque drifts less; assumed."""

_TORQUE = (1.0 / 6.0, 6.0)
"""Range of the mean torque over the kinetic torque of the fit, with any effect [-]; assumed."""

_GAIN = (1.0 / 30.0, 30.0)
"""Range of the gain of a path over the rig's, with any effect [-]; assumed."""

SWINGING = 0.02
"""Least standard deviation of the torque over the kinetic torque for slipping [-]; a smaller one
excites no path; assumed."""

_ALIKE = 0.7
"""Least correlation of a channel that follows from the torque [-]; assumed."""

_STEADY = 0.3, 0.7
"""Largest difference of logarithms between a unit's factor in a recording and the median, and least
share of recordings within it [-]; clipping and impacts vary with the condition; assumed."""

_STRENGTH = 0.1, 0.15, 0.8
"""Limits for the strength of a channel that does not follow its prediction [-]: largest difference
of logarithms to the unit's factor and to the median, and least share of recordings; assumed."""

_SWINGING_WELL = 0.05
"""Least swing over the kinetic torque at which strength is not dominated by noise [-]; assumed."""

_AGAINST = 0.9
"""Least magnitude of the negative correlation of an inverted channel [-]; assumed."""


def swapped_outputs(levels: Sequence[Levels]) -> str:
    """Return a finding if acceleration and pressure are swapped; otherwise empty."""
    paths = [one.paths for one in _slipping(levels) if _CROSSED[0] in one.paths]
    if not paths:
        return ""
    own, other = (
        float(np.median([max(abs(math.log(p[k].gain + 1e-12)) for k in keys) for p in paths]))
        for keys in (_STRAIGHT, _CROSSED)
    )
    follows = np.median([min(abs(p[k].alike) for k in _CROSSED) for p in paths])
    if follows > _ALIKE and other < math.log(3.0) and own > math.log(6.0):
        return "channels acceleration and pressure look swapped"
    return ""


_CROSSED = (("acceleration", "pressure"), ("pressure", "acceleration"))
_STRAIGHT = (("acceleration", "acceleration"), ("pressure", "pressure"))


def misplaced_torque(recordings: Sequence[Recording], rig: Rig) -> str:
    """Return a finding if another channel contains the torque; otherwise empty.

    Parameters
    ----------
    recordings : sequence of Recording
        Whole recordings with known conditions; the start is not cut off yet, because torque and
        angle determine it.
    rig : Rig
    """
    kinds = [_stands_for_torque(r, rig) for r in recordings]
    other = max(set(kinds), key=kinds.count) if kinds else ""
    if other and kinds.count(other) >= 0.8 * len(kinds):
        return f"channels torque and {other} look swapped"
    return ""


def _stands_for_torque(recording: Recording, rig: Rig) -> str:
    """Return the channel that looks like the torque if the torque channel does not; else empty."""
    condition = recording.condition
    assert condition.interference is not None  # ensured by `usable`
    kinetic = rig.fit(condition.interference).kinetic_torque
    torque_like = []
    for kind in KINDS:
        row = recording.first(kind)
        if row is not None:
            x = np.asarray(recording.samples[row], dtype=np.float64)
            mean, spread = abs(float(x.mean())), float(x.std())
            n = max(1, x.size // 10)
            rise = abs(float(x[-n:].mean() - x[:n].mean()))
            ramp = rise > max(2.5 * spread, _RISE * mean)
            if kinetic / 2.0 < mean < 3.0 * kinetic and spread < 0.5 * mean and not ramp:
                torque_like.append(kind)
    return torque_like[0] if torque_like and "torque" not in torque_like else ""


def wrong_units(levels: Sequence[Levels], *, alike: float = 1.5) -> Iterator[str]:
    """Yield findings on channels that are wrong by a factor.

    Parameters
    ----------
    levels : sequence of Levels
    alike : float
        Largest ratio of the kinetic torque to the rig's [-]; larger if only the kind of the rig is
        known.

    Yields
    ------
    str
        Finding on one channel.
    """
    torque = [abs(one.torque) for one in levels if one.torque is not None]
    scale = 1.0
    if torque:
        factor = float(np.median(torque))
        unit = unit_of("torque", factor, math.log(alike))
        if not _TORQUE[0] < factor < _TORQUE[1]:
            yield _unit_words("torque", unit, factor, "the kinetic torque of the rig file")
            scale = factor if unit else 1.0
    for kind in OUTPUTS:
        unit, factor = _unit_of_path(kind, levels, scale)
        fits = [p for one in _slipping(levels, scale) if (p := one.paths.get((kind, kind)))]
        follows = bool(fits) and float(np.median([fit.explained for fit in fits])) > 0.5
        if not unit and follows:
            factor = scale * float(np.median([fit.gain for fit in fits]))
        if unit or (follows and not _GAIN[0] < factor < _GAIN[1]):
            yield _unit_words(kind, unit, factor, "what the torque makes of it on this rig")


def _clear(fit: PathFit) -> bool:
    """Return whether a channel follows its prediction."""
    return min(fit.explained, abs(fit.alike)) > _ALIKE


def _unit_of_path(kind: str, levels: Sequence[Levels], scale: float) -> tuple[str, float]:
    """Return the wrong unit of a channel and its factor [-]; empty and 1 if there is none."""
    having = [(one, p) for one in levels if (p := one.paths.get((kind, kind)))]
    least = max(min(2, len(having)), 1)
    gains = scale * np.array([fit.gain for _, fit in having if _clear(fit)])
    swinging = [fit.strength for one, fit in having if one.swing > _SWINGING_WELL * scale]
    strengths = scale * np.maximum(swinging, 1e-12)
    for each, fewest, exact, steady, share in (
        (gains, least, _EXACT, *_STEADY),
        (strengths, least + (len(having) > 2), *_STRENGTH),
    ):
        if each.size >= fewest:
            factor = float(np.median(each))
            is_steady = np.mean(np.abs(np.log(each / factor)) < steady) >= share
            if is_steady and (unit := unit_of(kind, factor, exact)):
                return unit, factor
    return "", 1.0


def _unit_words(kind: str, unit: str, factor: float, against: str) -> str:
    """Return the finding on a channel in a wrong unit, or wrong by a factor [-] without one."""
    if unit:
        times = factor if factor > 1.0 else 1.0 / factor
        return f"channel {kind} looks like {unit}, not {CHANNEL_UNITS[kind]} (factor {times:.2g})"
    return f"channel {kind} is {factor_words(factor)} against {against}"


def turned_channels(levels: Sequence[Levels]) -> Iterator[str]:
    """Yield findings on channels with an inverted sign."""
    torque = [one.torque for one in levels if one.torque is not None]
    if torque and np.median(torque) < -_TORQUE[0]:
        yield "channel torque has its sign turned: it drives the rotation that it should brake"
        return
    for kind in OUTPUTS:
        alike = [p.alike for one in _slipping(levels) if (p := one.paths.get((kind, kind)))]
        if len(alike) > 2 and max(alike) < -_AGAINST:
            yield f"channel {kind} has its sign turned against what the torque makes of it"


def _slipping(levels: Sequence[Levels], scale: float = 1.0) -> list[Levels]:
    """Return the levels of recordings that slip; `scale` is the factor of a wrong unit [-]."""
    return [one for one in levels if one.swing > SWINGING * scale]
