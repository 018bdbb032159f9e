"""Measures of how irregular the creak of a simulated bushing is.

They are of two seconds of sound at the microphone without room and noise, the
loudest second: *jitter*, the coefficient of variation of the intervals between pulses above 2 kHz;
*harmonicity*, the highest autocorrelation at a lag of 1/1500 to 1/20 s; *flatness*, the geometric
over the arithmetic mean of the autospectrum from 20 Hz to 14.25 kHz.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import butter, find_peaks, hilbert, sosfiltfilt

from features.kernels.harmonics import strongest_period
from features.kernels.spectra import autospectrum, spectral_shape

LONG, TIGHT = 2214.0, 0.381e-3
SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0)

_PULSES_FROM, _PULSES_TO = 2_000.0, 500.0
"""Where pulses sound, and up to where their envelope is followed [Hz]."""

_LEAST_PULSE = 0.25
"""How far a pulse stands out, re the 99th percentile of the envelope [-]."""


def creak_measures(pressure, rate):
    """Jitter [-], harmonicity [-] and flatness [dB] of the loudest second of a creak."""
    n, step = round(rate), round(0.25 * rate)
    starts = range(0, max(pressure.size - n, 0) + 1, step)
    first = max(starts, key=lambda start: float(np.sum(pressure[start : start + n] ** 2)))
    sound = pressure[first : first + n] - pressure[first : first + n].mean()
    period = strongest_period(sound, rate, lowest=20.0, highest=1500.0, whiten=False)
    shape = spectral_shape(autospectrum(sound, rate), low=20.0, high=14_250.0)
    return _jitter(sound, rate), period.strength, 10.0 * math.log10(shape.flatness)


def _jitter(sound, rate):
    """Coefficient of variation of the intervals between pulses, up to some 500 a second.

    `features.kernels.slips` smooths over longer, and loses those above 150 a second.
    """
    high = sosfiltfilt(butter(4, _PULSES_FROM, "highpass", fs=rate, output="sos"), sound)
    low = butter(2, _PULSES_TO, fs=rate, output="sos")
    envelope = sosfiltfilt(low, np.abs(hilbert(high)))
    least = _LEAST_PULSE * float(np.quantile(envelope, 0.99))
    intervals = np.diff(find_peaks(envelope, prominence=least)[0])
    return float(intervals.std() / intervals.mean()) if intervals.size > 1 else math.nan
