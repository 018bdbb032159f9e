"""Gain error: a sensitivity that differs from the calibration.

With e the error times the channel's share:

- constant: (1 + e) x, a wrong calibration factor.
- drift: (1 + e t / T) x, from no error at the start of the recording to e at its end T: an
  amplifier or a strain gauge that warms up.
- shelf: x + e times its first-order high-pass at the `corner`: correct for slow signals, which a
  static calibration uses, and wrong by e far above, as for a microphone behind its grid or a charge
  amplifier on a long cable; H(s) = (1 + (1 + e) s / omega_c) / (1 + s / omega_c).

Shares are signed: with `torque=-1` the torque reads low where the others read high. A calibration
(ISO 16063-21 for accelerometers) leaves a few per cent; a wrong factor may have any size. Error
zero leaves the signal unchanged.

>>> values = {"error": 0.1, "corner": 1e3, "acceleration": 1.0, "pressure": 1.0, "torque": -0.5,
...           "angle": 0.0}
>>> read = _sensors({"torque": np.full(3, 8.0)}, 96e3, "constant", values,
...                 np.random.default_rng(0))
>>> read["torque"]
array([7.6, 7.6, 7.6])
"""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter, lfilter_zi

from sim.chain import change_channels, channel_shares
from sim.effects.effect import Effect, Parameter, Signals, Stage, Values


def _sensors(
    signals: Signals, rate: float, form: str, values: Values, _rng: np.random.Generator
) -> Signals:
    def misread(signal: NDArray[np.float64], error: float) -> NDArray[np.float64]:
        return signal + error * _excess(signal, form, values["corner"] / rate)

    return change_channels(signals, values, "error", misread)


def _excess(signal: NDArray[np.float64], form: str, corner: float) -> NDArray[np.float64]:
    """Return the excess of the reading at an error of one; `corner` in cycles per sample."""
    if form == "drift":
        return signal * np.linspace(0.0, 1.0, signal.size)
    if form == "shelf":
        b, a = butter(1, 2.0 * corner, "highpass")
        above, _ = lfilter(b, a, signal, zi=lfilter_zi(b, a) * signal[0])
        return np.asarray(above)
    return signal


EFFECT = Effect(
    name="gain_error",
    stage=Stage.MEASUREMENT,
    forms=("constant", "drift", "shelf"),
    parameters={
        "error": Parameter(0.1, "", -0.9, 2.0, "relative error of the gain"),
        "corner": Parameter(1e3, "Hz", 10.0, 20e3, "corner frequency of the shelf"),
        **channel_shares("error", acceleration=1.0, pressure=1.0, torque=1.0, angle=0.0),
    },
    strength="error",
    sensors=_sensors,
)
