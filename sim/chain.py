"""Effects on the linear path from torque to sound, and helpers that effects share.

An effect of structure or radiation changes the impulse responses and not the signals. So it acts
alike on a run in memory and on a run in blocks, and such effects can be combined in any order. They
draw their random numbers from a stream of their own, for the same reason.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve, lfilter

from models.radiation.impulse_responses import ImpulseResponses
from models.recording import REFERENCE_PRESSURE
from models.structure.modal import DECAY_EXPONENT
from sim.effects.effect import ActiveEffect, Signals
from sim.parameters import Parameter

HIGHEST_SHARE = 0.45
"""Modes above this share of the sampling rate are left out."""

_LONGEST = 2.0
"""Longest impulse response of a resonance [s]."""


def apply_chain_effects(
    paths: ImpulseResponses, effects: Sequence[ActiveEffect], rng: np.random.Generator
) -> ImpulseResponses:
    """Apply all effects on the path from torque to sound.

    Parameters
    ----------
    paths : ImpulseResponses
        Impulse responses of the plain model.
    effects : sequence of ActiveEffect
        Effects that do not act on the path are ignored.
    rng : numpy.random.Generator
        Generator of effects that scatter.

    Returns
    -------
    ImpulseResponses

    Examples
    --------
    >>> from models.radiation.impulse_responses import ImpulseResponses
    >>> from sim.effects import EFFECTS
    >>> one = np.ones(1)
    >>> plain = ImpulseResponses(48e3, one, one, one, one)
    >>> floor = EFFECTS["room_reflections"].active({"form": "floor"})
    >>> changed = apply_chain_effects(plain, [floor], np.random.default_rng(0))
    >>> changed.torque_to_acceleration.size, changed.torque_to_pressure.size
    (1, 254)
    """
    for active in effects:
        if active.effect.chain is not None:
            paths = active.effect.chain(paths, active.form, active.values, rng)
    return paths


def resonance(
    numerator: Sequence[float], frequency: float, damping_ratio: float, rate: float
) -> NDArray[np.float64]:
    """Return the impulse response of a mode until it has decayed.

    Parameters
    ----------
    numerator : sequence of 3 floats
        In falling powers of s / omega [-], over s^2 / omega^2 + 2 zeta s / omega + 1.
    frequency : float
        Undamped natural frequency, below half of `rate` [Hz].
    damping_ratio : float
        [-]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [-], exact at the natural frequency (bilinear transform).

    Examples
    --------
    >>> ringing = resonance([1.0, 0.0, 0.0], 1000.0, 0.05, 96e3)
    >>> turn = np.exp(-2j * np.pi * 1000.0 / 96e3 * np.arange(ringing.size))
    >>> round(float(abs(ringing @ turn)), 3)
    10.0
    """
    share = frequency / rate
    c = 1.0 / math.tan(math.pi * share)
    b, a = _bilinear(numerator, c), _bilinear((1.0, 2.0 * damping_ratio, 1.0), c)
    decay = DECAY_EXPONENT / (2.0 * np.pi * share * damping_ratio)
    unit = np.zeros(int(min(decay, _LONGEST * rate)) + 2)
    unit[0] = 1.0
    return np.asarray(lfilter(b, a, unit))


def _bilinear(p: Sequence[float], c: float) -> list[float]:
    """Return a polynomial of second order in s times (z + 1)^2, for s = c (z - 1) / (z + 1)."""
    high, middle, low = p[0] * c * c, p[1] * c, p[2]
    return [high + middle + low, 2.0 * (low - high), high - middle + low]


def padded_sum(signals: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the sum of responses of different lengths, each of shape (n,) and in one [unit].

    Examples
    --------
    >>> padded_sum([np.ones(3), np.ones(1)])
    array([2., 1., 1.])
    """
    listed = list(signals)
    added = np.zeros(max(signal.size for signal in listed))
    for signal in listed:
        added[: signal.size] += signal
    return added


def filter_pressure(paths: ImpulseResponses, taps: NDArray[np.float64]) -> ImpulseResponses:
    """Return impulse responses whose pressure is filtered further.

    Parameters
    ----------
    paths : ImpulseResponses
    taps : ndarray, shape (n,)
        Impulse response of the filter, at the rate of the paths [-].

    Returns
    -------
    ImpulseResponses
        Pressures longer by n - 1 samples.

    Examples
    --------
    >>> from models.radiation.impulse_responses import ImpulseResponses
    >>> one = np.ones(1)
    >>> plain = ImpulseResponses(48e3, one, one, one, one)
    >>> filter_pressure(plain, np.array([1.0, 0.5])).torque_to_pressure
    array([1. , 0.5])
    """
    return replace(
        paths,
        torque_to_pressure=fftconvolve(paths.torque_to_pressure, taps),
        pulse_to_pressure=fftconvolve(paths.pulse_to_pressure, taps),
    )


def channel_level(name: str, values: Mapping[str, float]) -> float:
    """Return the root mean square of a disturbance in a channel, in its unit; 0 if none is stated.

    Parameters
    ----------
    name : str
        Name of the channel; ``torque_2`` is of the kind ``torque``.
    values : mapping of str to float
        ``pressure_level`` [dB re 20 uPa], ``acceleration``, ``torque`` and ``angle``.

    Examples
    --------
    >>> values = {"pressure_level": 94.0, "acceleration": 1.0, "torque": 0.1, "angle": 0.0}
    >>> round(channel_level("pressure_2", values), 2), channel_level("speed", values)
    (1.0, 0.0)
    """
    kind = name.partition("_")[0]
    if kind == "pressure":
        return REFERENCE_PRESSURE * float(10.0 ** (values["pressure_level"] / 20.0))
    return values[kind] if kind in ("acceleration", "torque", "angle") else 0.0


def channel_shares(what: str, low: float = -1.0, **shares: float) -> dict[str, Parameter]:
    """Return the parameters for the share of an effect's strength on each kind of channel.

    Parameters
    ----------
    what : str
        The strength in words.
    low : float
        Lowest share allowed [-]; the highest is 1.
    **shares : float
        Default by kind of channel [-].

    Examples
    --------
    >>> channel_shares("delay", torque=0.5)["torque"].meaning
    'share of the delay on torques'
    """
    return {
        kind: Parameter(share, "", low, 1.0, f"share of the {what} on {kind}s")
        for kind, share in shares.items()
    }


def change_channels(
    signals: Signals,
    values: Mapping[str, float],
    strength: str,
    change: Callable[[NDArray[np.float64], float], NDArray[np.float64]],
) -> Signals:
    """Change each channel by its share of an effect's strength.

    Parameters
    ----------
    signals : dict of str to ndarray, shape (n,)
        By channel, in its unit; ``torque_2`` is of the kind ``torque``.
    values : mapping of str to float
        The strength, and shares by kind of channel [-].
    strength : str
        Name of the strength.
    change : callable
        ``change(signal, strength)``; not called where the strength is zero.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        In the channel's unit.

    Examples
    --------
    >>> import numpy as np
    >>> values = {"error": 0.5, "torque": 1.0}
    >>> signals = {"torque_2": np.ones(1), "angle": np.ones(1)}
    >>> change_channels(signals, values, "error", lambda signal, error: (1.0 + error) * signal)
    {'torque_2': array([1.5]), 'angle': array([1.])}
    """
    changed = {}
    for name, signal in signals.items():
        own = values[strength] * values.get(name.partition("_")[0], 0.0)
        changed[name] = signal if own == 0.0 else change(signal, own)
    return changed
