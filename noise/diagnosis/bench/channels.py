"""Channels that are swapped, in another unit, turned, or run backwards.

Every threshold lies between what effects do and what a wrong bench does. A torque keeps between a
sixth and six times its size whatever is missing in the contact, a path's gain between a thirtieth
and thirty (impacts at slips make it seventeen); a unit is named where the factor is that of a usual
one, is the same in all recordings, and the channel follows from the torque in all else.

Measured are angle against the speed that was set, torque against the kinetic torque of the fit,
acceleration and sound against what the rig's own path makes of the recorded torque: ratios of
quantities that hold whatever the contact does, so that an effect moves them little and a wrong unit
much.
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
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache, predict

_EXACT = 0.16
"""Difference of logarithms up to which a factor is that of a unit [-]; gains err by as much;
assumed."""

_UNITS = {
    "acceleration": {1.0 / 9.80665: "g", 1e3: "mm/s^2", 1e3 / 9.80665: "mg", 1e-3: "km/s^2"},
    "pressure": {1e3: "mPa", 1e6: "uPa", 1e-3: "kPa", 1e-5: "bar", 1e-2: "hPa"},
    "torque": {
        1e3: "N mm", 1e2: "N cm", 1e-3: "kN m", 8.851: "lbf in", 10.197: "kgf cm",
        0.10197: "kgf m",
    },
    "angle": {180.0 / math.pi: "degrees", 0.5 / math.pi: "turns", 1e3: "mrad"},
    "speed": {30.0 / math.pi: "rpm", 180.0 / math.pi: "degree/s", 0.5 / math.pi: "turns/s"},
}  # fmt: skip
"""By channel: how many times too large a value in the unit reads."""


def unit_of(kind: str, factor: float, within: float = _EXACT) -> str:
    """Return the wrong unit that makes a quantity read so many times too large; empty if none.

    Parameters
    ----------
    kind : str
        Of the channel, or ``speed`` for the one that is stated.
    factor : float
        [-]
    within : float
        Difference of logarithms [-].

    Examples
    --------
    >>> unit_of("pressure", 1020.0), unit_of("acceleration", 0.1), unit_of("torque", 1.1)
    ('mPa', 'g', '')
    """
    if factor <= 0.0:
        return ""
    found = {abs(math.log(factor / f)): unit for f, unit in _UNITS[kind].items()}
    nearest = min(found)
    return found[nearest] if nearest <= within else ""


def length_unit(stated: float, low: float, high: float) -> str:
    """Return the unit in which a length was stated that is far from all that it can be.

    Parameters
    ----------
    stated, low, high : float
        The length, and between which it can be [m].

    Returns
    -------
    str
        Empty where no unit makes it one.

    Examples
    --------
    >>> length_unit(0.279e-6, 0.178e-3, 0.381e-3), length_unit(0.5e-3, 0.178e-3, 0.381e-3)
    ('m', '')
    """
    units = {"m": 1e3, "um": 1e-3, "inches": 25.4, "cm": 10.0}
    return next(
        (unit for unit, x in units.items() if low <= x * stated * 1.001 <= high * 1.002), ""
    )


def factor_words(factor: float) -> str:
    """Say how far a quantity is off.

    Examples
    --------
    >>> factor_words(1000.0), factor_words(0.102)
    ('1000 times too large', '9.8 times too small')
    """
    size = max(factor, 1.0 / factor)
    return (
        f"{size:.2g} times too {'large' if factor > 1.0 else 'small'}"
        if size < 100.0
        else (f"{float(f'{size:.2g}'):.0f} times too {'large' if factor > 1.0 else 'small'}")
    )


KINDS = ("torque", "acceleration", "pressure", "angle")

_BAND = (80.0, 6000.0)
"""In which a path is compared [Hz]; assumed."""

_LENGTH = 2048
"""Of a segment [samples]."""

_LEAD, _TAIL = 0.08, 0.01
"""Left out at the ends, where the structure rings from before and nothing follows [s]; as of
`noise.diagnosis.evidence.path_summary`."""

_HEARD = 1e-3
"""Share of the strongest line's power from which a prediction has a frequency [-]; assumed."""

_LONGEST_DELAY = 2.5e-3
"""Between channels, up to which signals are laid upon each other [s]; assumed."""


@dataclass(frozen=True)
class PathFit:
    """How a signal follows from another.

    Parameters
    ----------
    gain : float
        Of its coherent part, over the prediction's [-].
    explained : float
        Share of its power that is coherent [-].
    alike : float
        Correlation with the prediction as it stands, at the best delay [-].
    strength : float
        Of its amplitude over the prediction's, the middle one of the frequencies that the
        prediction has; noise adds to it, and delays and cut peaks do not change it [-].
    """

    gain: float
    explained: float
    alike: float
    strength: float


@dataclass(frozen=True, eq=False)
class Levels:
    """What is told of a recording against its rig, before any model is run.

    Parameters
    ----------
    speed : float
        As stated [rad/s].
    turned : float, optional
        Slope of the angle [rad/s]; None without one.
    torque : float, optional
        Mean over the kinetic torque of the fit, negative against the stated rotation [-].
    swing : float
        Standard deviation of the torque over the kinetic torque [-].
    falls : float
        Skewness of the torque's rate, negative where it rises slowly and falls fast [-].
    paths : mapping of (str, str) to PathFit
        From the torque, by the channel that was recorded and the path that it was compared with.
    backwards : mapping of str to PathFit
        The same of a channel and its own path, time turned about.
    """

    speed: float
    turned: float | None
    torque: float | None
    swing: float
    falls: float
    paths: Mapping[tuple[str, str], PathFit] = field(default_factory=dict)
    backwards: Mapping[str, PathFit] = field(default_factory=dict)


def levels_of(recording: Recording, rig: Rig, transfer_functions: TransferFunctionCache) -> Levels:
    """Compare the channels of a recording with its rig.

    Parameters
    ----------
    recording : Recording
        With a known condition.
    rig : Rig
    transfer_functions : TransferFunctionCache
        Of the rig.

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
    turned = _turning(signal["angle"], rate) if "angle" in signal else None
    if "torque" not in signal:
        return Levels(c.speed, turned, None, 0.0, 0.0)
    torque, kinetic = signal["torque"], rig.fit(c.interference).kinetic_torque
    paths: dict[tuple[str, str], PathFit] = {}
    backwards: dict[str, PathFit] = {}
    outputs = [kind for kind in ("acceleration", "pressure") if kind in signal]
    if outputs and float(np.ptp(torque)) > 0.0:
        functions = transfer_functions.whole(recording)
        for path in outputs:
            forth = predict(torque, rate, functions[path])
            for kind in outputs:
                paths[kind, path] = path_fit(forth, signal[kind], rate)
            back = predict(torque[::-1], rate, functions[path])
            backwards[path] = path_fit(back, signal[path][::-1], rate)
    return Levels(
        c.speed, turned, math.copysign(1.0, c.speed) * float(torque.mean()) / kinetic,
        float(torque.std()) / kinetic, _falling(torque, rate), paths, backwards,
    )  # fmt: skip


def path_fit(predicted: Array, measured: Array, rate: float) -> PathFit:
    """Say how a signal follows from its prediction.

    Parameters
    ----------
    predicted, measured : ndarray, shape (n,)
        [unit of the channel]
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
    heard = pp > _HEARD * float(pp.max())
    strength = math.sqrt(float(np.median(mm[heard] / (pp[heard] + tiny)))) if pp.any() else 0.0
    return PathFit(gain, coherent / (float(mm.sum()) + tiny), _alike(p, m, rate), strength)


def _alike(p: Array, m: Array, rate: float) -> float:
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


def _turning(angle: Array, rate: float) -> float:
    time = np.arange(angle.size) / rate
    time -= time.mean()
    return float(time @ (angle - angle.mean())) / float(time @ time)


def _falling(torque: Array, rate: float) -> float:
    """Skewness of the torque's rate over a third of a millisecond [-]."""
    block = max(1, int(3e-4 * rate))
    smooth = torque[: torque.size // block * block].reshape(-1, block).mean(axis=1)
    step = np.diff(smooth)
    step -= step.mean()
    spread = float(step.std())
    return float(np.mean(step**3)) / spread**3 if spread > 0.0 else 0.0


_RISE = 0.3
"""From its beginning to its end, over its mean, of what rises all the time [-]: an angle by twice
as much and more, whatever a torque drifts by; assumed."""

OUTPUTS = ("acceleration", "pressure")

_TORQUE = (1.0 / 6.0, 6.0)
"""Mean torque over the kinetic torque of the fit, whatever is missing [-]; assumed."""

_FAR = ("N mm", "kN m")
"""Units of torque that no rig is taken for, even where only its kind is known."""

_GAIN = (1.0 / 30.0, 30.0)
"""Gain of a path over the rig's, whatever is missing [-]; assumed."""

SWINGING = 0.02
"""Standard deviation of a torque that slips, over the kinetic torque [-]; below, nothing that a
path could be told from; assumed."""

_ALIKE = 0.7
"""Correlation from which a channel follows from the torque [-]; assumed."""

_STEADY = 0.3, 0.7
"""Difference of logarithms from the middle of the recordings within which a factor that is a
unit's lies, in what share of them [-]; clipping and impacts change from one condition to the next;
assumed."""

_STRENGTH = 0.1, 0.15, 0.8
"""The same of the strength alone, where a channel follows no prediction: difference from the
unit's factor, from the middle, and share of the recordings [-]; assumed."""

_SWINGING_WELL = 0.05
"""Swing over the kinetic torque from which strength is no noise [-]; assumed."""

_AGAINST = 0.9
"""Correlation from which a channel is the torque's with its sign turned [-]; assumed."""

_RISING = 0.5
"""Skewness of the torque's rate from which it rises fast and falls slowly [-]; assumed."""


def swapped_channels(recordings: Sequence[Recording], rig: Rig, levels: Sequence[Levels]) -> str:
    """Say which two channels are each other's; empty if none."""
    if misplaced := misplaced_torque(recordings, rig):
        return misplaced
    crossed, straight = [], []
    for one in _slipping(levels):
        if ("acceleration", "pressure") not in one.paths:
            continue
        crossed.append([one.paths[k] for k in _CROSSED])
        straight.append([one.paths[k] for k in _STRAIGHT])
    if not crossed:
        return ""
    log = np.abs(np.log([[fit.gain + 1e-12 for fit in pair] for pair in (*crossed, *straight)]))
    gains = np.median(log.max(axis=1).reshape(2, -1), axis=1)
    follows = np.median([min(abs(fit.alike) for fit in pair) for pair in crossed])
    if follows > _ALIKE and gains[0] < math.log(3.0) and gains[1] > math.log(6.0):
        return "channels acceleration and pressure look swapped"
    return ""


_CROSSED = (("acceleration", "pressure"), ("pressure", "acceleration"))
_STRAIGHT = (("acceleration", "acceleration"), ("pressure", "pressure"))


def misplaced_torque(recordings: Sequence[Recording], rig: Rig) -> str:
    """Say which channel holds the torque in its place; empty if none.

    Parameters
    ----------
    recordings : sequence of Recording
        With known conditions, whole: a start is looked for in torque and angle, and cut by them.
    rig : Rig
    """
    found = [_stands_for_torque(r, rig) for r in recordings]
    other = max(set(found), key=found.count) if found else ""
    if other and found.count(other) >= 0.8 * len(found):
        return f"channels torque and {other} look swapped"
    return ""


def _stands_for_torque(recording: Recording, rig: Rig) -> str:
    """Return the channel that has the mean and the steadiness of a torque that another lacks."""
    condition = recording.condition
    assert condition.interference is not None  # `usable` made it so
    kinetic = rig.fit(condition.interference).kinetic_torque
    found = []
    for kind in KINDS:
        row = recording.first(kind)
        if row is not None:
            x = np.asarray(recording.samples[row], dtype=np.float64)
            mean, spread = abs(float(x.mean())), float(x.std())
            n = max(1, x.size // 10)
            rise = abs(float(x[-n:].mean() - x[:n].mean()))
            ramp = rise > max(2.5 * spread, _RISE * mean)
            if kinetic / 2.0 < mean < 3.0 * kinetic and spread < 0.5 * mean and not ramp:
                found.append(kind)
    return found[0] if found and "torque" not in found else ""


def wrong_units(levels: Sequence[Levels], *, alike: float = 1.0) -> Iterator[str]:
    """Say which channels read a factor too much or too little.

    Parameters
    ----------
    levels : sequence of Levels
    alike : float
        How many times the kinetic torque may differ from the rig's, of a unit that is thousands of
        times another [-]: more where the rig is not known yet.

    Yields
    ------
    str
    """
    torque = [abs(one.torque) for one in levels if one.torque is not None]
    scale = 1.0
    if torque:
        factor = float(np.median(torque))
        far = unit_of("torque", factor, math.log(alike) + 1e-9)
        unit = unit_of("torque", factor) or (far if far in _FAR else "") or _torque_of_paths(levels)
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


def _torque_of_paths(levels: Sequence[Levels]) -> str:
    """Return the unit of a torque from which both other channels follow too weakly or strongly."""
    gains = [
        [fit.gain for one in levels if (fit := one.paths.get((kind, kind))) and _clear(fit)]
        for kind in OUTPUTS
    ]
    if not all(gains):
        return ""
    middle = [-math.log(float(np.median(each))) for each in gains]
    if abs(middle[0] - middle[1]) > _STEADY[0]:
        return ""
    return unit_of("torque", math.exp(sum(middle) / 2.0))


def is_told(kind: str, levels: Sequence[Levels]) -> bool:
    """Tell whether recordings say how large a channel should be: one that slips, two that follow.

    Parameters
    ----------
    kind : str
        Of the channel.
    levels : sequence of Levels
    """
    own = [(one, fit) for one in levels if (fit := one.paths.get((kind, kind)))]
    follow = sum(_clear(fit) for _, fit in own)
    return follow >= min(2, len(levels)) or any(one.swing > SWINGING for one, _ in own)


def _clear(fit: PathFit) -> bool:
    return min(fit.explained, abs(fit.alike)) > _ALIKE


def _unit_of_path(kind: str, levels: Sequence[Levels], scale: float) -> tuple[str, float]:
    """Return the unit and the factor of a channel that has another at every condition."""
    having = [(one, p) for one in levels if (p := one.paths.get((kind, kind)))]
    least = min(2, len(having))
    clear = {k: {i: f.gain for i, one in enumerate(levels)
                 if (f := one.paths.get((k, k))) and _clear(f)}
             for k in OUTPUTS}  # fmt: skip
    own = clear[kind]
    gains = [scale * np.array(list(own.values()))]
    (beside,) = (clear[k] for k in OUTPUTS if k != kind)
    both = [i for i in own if i in beside]
    if both and abs(math.log(scale * float(np.median([beside[i] for i in both])))) < math.log(3.0):
        gains.append(np.array([own[i] / beside[i] for i in both]))  # whatever the torque reads
    for each in gains:
        if each.size >= least > 0:
            factor = float(np.median(each))
            steady = np.mean(np.abs(np.log(each / factor)) < _STEADY[0]) >= _STEADY[1]
            if steady and (unit := unit_of(kind, factor)):
                return unit, factor
    swinging = [fit for one, fit in having if one.swing > _SWINGING_WELL * scale]
    if len(swinging) >= max(least, 1) + (len(having) > 2):
        strengths = scale * np.array([max(fit.strength, 1e-12) for fit in swinging])
        factor = float(np.median(strengths))
        steady = np.mean(np.abs(np.log(strengths / factor)) < _STRENGTH[1]) >= _STRENGTH[2]
        if steady and (unit := unit_of(kind, factor, _STRENGTH[0])):
            return unit, factor
    return "", 1.0


def _unit_words(kind: str, unit: str, factor: float, against: str) -> str:
    if unit:
        times = factor if factor > 1.0 else 1.0 / factor
        return f"channel {kind} looks like {unit}, not {CHANNEL_UNITS[kind]} (factor {times:.2g})"
    return f"channel {kind} is {factor_words(factor)} against {against}"


def turned_channels(levels: Sequence[Levels]) -> Iterator[str]:
    """Say which channels have their sign turned."""
    torque = [one.torque for one in levels if one.torque is not None]
    if torque and np.median(torque) < -_TORQUE[0]:
        yield "channel torque has its sign turned: it drives the rotation that it should brake"
        return
    for kind in OUTPUTS:
        alike = [p.alike for one in _slipping(levels) if (p := one.paths.get((kind, kind)))]
        if len(alike) > 2 and max(alike) < -_AGAINST:
            yield f"channel {kind} has its sign turned against what the torque makes of it"


def backwards(levels: Sequence[Levels]) -> str:
    """Say whether time runs backwards: a contact loads slowly and lets go at once."""
    looked = [one for one in _slipping(levels) if one.torque is not None]
    if not looked:
        return ""
    rises = [one.falls * math.copysign(1.0, one.torque or 1.0) for one in looked]
    if float(np.median(rises)) < _RISING:
        return ""
    forth = [abs(one.paths[k, k].alike) for one in looked for k in one.backwards]
    back = [abs(fit.alike) for one in looked for fit in one.backwards.values()]
    if forth and float(np.median(back)) < float(np.median(forth)):
        return ""
    return "time runs backwards: the torque rises at once and falls slowly"


def _slipping(levels: Sequence[Levels], scale: float = 1.0) -> list[Levels]:
    return [one for one in levels if one.swing > SWINGING * scale]
