"""Clipping: an amplifier saturates below the peak of the signal.

With the largest magnitude M of a channel and the magnitude m of its mean, the peak is read as
M - a (M - m), in every form, so that an amount is the same overload whatever the form, level and
offset; for a sound that is (1 - a) M, and a torque keeps its mean.

- hard: min(max(x, -L), L) with L = M - a (M - m), an amplifier at its supply.
- soft: L tanh(x / L), with the L that gives the peak its reading; tanh is the transfer curve of a
  differential pair (Gray & Meyer, Analysis and Design of Analog Integrated Circuits, 3.5).
- asymmetric: as hard, but on the side of M alone: a sensor with its supply on the signal's wire
  whose bias has wandered.

Amount zero leaves the signal unchanged. Clipping comes before the anti-alias filter, which rounds
the corners; `sim.acquisition` clips at the converter's range. The angle is never clipped.

>>> values = {"amount": 0.25, "acceleration": 1.0, "pressure": 1.0, "torque": 1.0}
>>> signals = {"pressure": np.array([-2.5, -1.5, 4.0])}
>>> _sensors(signals, 96e3, "hard", values, np.random.default_rng(0))["pressure"]
array([-2.5, -1.5,  3. ])
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from sim.chain import change_channels, channel_shares
from sim.effects.effect import Effect, Parameter, Signals, Stage, Values


def _sensors(
    signals: Signals, _rate: float, form: str, values: Values, _rng: np.random.Generator
) -> Signals:
    return change_channels(
        signals, values, "amount", lambda signal, amount: _clipped(signal, form, amount)
    )


def _clipped(signal: NDArray[np.float64], form: str, amount: float) -> NDArray[np.float64]:
    if not signal.any():
        return signal
    peak = float(signal[np.argmax(np.abs(signal))])
    cut = amount * (1.0 - abs(float(np.mean(signal)) / peak))
    if form == "soft":
        limit = abs(peak) / _overdrive(cut)
        return limit * np.tanh(signal / limit)
    limit = (1.0 - cut) * abs(peak)
    if form == "asymmetric":
        return np.minimum(signal, limit) if peak > 0.0 else np.maximum(signal, -limit)
    return np.clip(signal, -limit, limit)


def _overdrive(cut: float) -> float:
    """Return M / L of the soft form: the root u of tanh(u) / u = 1 - cut."""
    remaining = 1.0 - max(cut, 1e-9)  # below 1e-9 rounding hides the root
    most = 1.0 / remaining
    if np.tanh(most) >= remaining * most:  # the root equals the bound to rounding
        return most
    return float(brentq(lambda u: np.tanh(u) - remaining * u, 1e-6, most))


EFFECT = Effect(
    name="clipping",
    stage=Stage.MEASUREMENT,
    forms=("hard", "soft", "asymmetric"),
    parameters={
        "amount": Parameter(0.3, "", 0.0, 0.95, "share of the peak above the mean that is cut off"),
        **channel_shares("amount", low=0.0, acceleration=1.0, pressure=1.0, torque=1.0),
    },
    strength="amount",
    sensors=_sensors,
)
