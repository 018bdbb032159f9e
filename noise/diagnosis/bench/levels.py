"""How large each channel is against what the rig file and the conditions would make of it.

Angle against the speed that was set, torque against the kinetic torque of the fit, acceleration and
sound against what the rig's own path makes of the recorded torque: ratios of quantities that hold
whatever the contact does, so that an effect moves them little and a wrong unit much.

Factors by which a number in a usual wrong unit is off, so that a finding can name the unit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.spectra import segment_spectra
from models.condition import known_condition
from models.rig import Rig
from noise.diagnosis.evidence.bands import USABLE
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache, predict

if TYPE_CHECKING:
    from models.recording import Recording


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
    straight : float
        What the angle has besides its slope, over the way it turns [-].
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
    straight: float
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
    turned, straight = _turning(signal["angle"], rate) if "angle" in signal else (None, 0.0)
    if "torque" not in signal:
        return Levels(c.speed, turned, straight, None, 0.0, 0.0)
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
        c.speed, turned, straight, math.copysign(1.0, c.speed) * float(torque.mean()) / kinetic,
        float(torque.std()) / kinetic, _falling(torque, rate), paths, backwards,
    )  # fmt: skip


def path_fit(predicted: NDArray[np.float64], measured: NDArray[np.float64], rate: float) -> PathFit:
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


def _alike(p: NDArray[np.float64], m: NDArray[np.float64], rate: float) -> float:
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


def _turning(angle: NDArray[np.float64], rate: float) -> tuple[float, float]:
    time = np.arange(angle.size) / rate
    time -= time.mean()
    slope = float(time @ (angle - angle.mean())) / float(time @ time)
    rest = float((angle - angle.mean() - slope * time).std())
    return slope, rest / (abs(slope) * angle.size / rate + 1e-300)


def _falling(torque: NDArray[np.float64], rate: float) -> float:
    """Skewness of the torque's rate over a third of a millisecond [-]."""
    block = max(1, int(3e-4 * rate))
    smooth = torque[: torque.size // block * block].reshape(-1, block).mean(axis=1)
    step = np.diff(smooth)
    step -= step.mean()
    spread = float(step.std())
    return float(np.mean(step**3)) / spread**3 if spread > 0.0 else 0.0
