"""A sound calibrator's recorded tone: what a full-scale sample is worth in pascals.

Calibrators sound at 250 Hz or 1 kHz with a stated level, most often 94 or 114 dB re 20 uPa
(IEC 60942). The tone is fitted in blocks of a tenth of a second; what is not one stable tone is
refused, with the reason: a frequency of no calibrator, a level that drifts (a microphone not yet
seated, or taken out), or anything beside the tone beyond the distortion that the standard allows a
calibrator of class 2. The level is that of the fundamental alone, so that rumble and hiss do not
count.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, RecordingError, naming
from models.recording import REFERENCE_PRESSURE
from noise.recordings.files import open_raw

FREQUENCIES = (250.0, 1000.0)
"""Of calibrators [Hz] (IEC 60942)."""

_OFF = 0.025
"""By which a tone may be off, as a share of its frequency; pistonphones sound at 251.2 Hz."""

_SHORTEST = 0.5
"""[s]"""

_BLOCK = 0.1
"""[s]"""

_DRIFT = 0.3
"""Between the loudest and the quietest block [dB]."""

_BESIDE = 0.04
"""Rms of what is not the tone, over that of the tone (IEC 60942, class 2): harmonics of overload or
of tops cut off, other sound."""

_STEP = 2.0**-15
"""Of integer samples, over full scale; finer ones have no need of it."""


@dataclass(frozen=True)
class CalibratorTone:
    """The tone on one track.

    Parameters
    ----------
    frequency : float
        [Hz]
    full_scale : float
        Pressure of a full-scale sample [Pa].
    """

    frequency: float
    full_scale: float


def read_calibrator(path: str | os.PathLike[str], level: float) -> tuple[CalibratorTone, ...]:
    """Read a recording of a calibrator.

    Parameters
    ----------
    path : path-like
        As `noise.recordings.read_recording` takes it; a calibration of its own is passed over.
    level : float
        That the calibrator gives [dB re 20 uPa].

    Returns
    -------
    tuple of CalibratorTone
        One a track.

    Raises
    ------
    RecordingError
        It cannot be read, or is not one stable tone; the message says why.
    ParameterError
        The level is no number.

    Examples
    --------
    >>> import tempfile, soundfile
    >>> tone = 0.1 * np.sin(2.0 * np.pi * 1000.0 * np.arange(48_000) / 48e3)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     soundfile.write(Path(folder) / "tone.wav", tone, 48_000)
    ...     found = read_calibrator(Path(folder) / "tone.wav", 94.0)
    >>> round(found[0].frequency, 2), round(found[0].full_scale, 2)
    (1000.0, 14.18)
    """
    if not math.isfinite(level):
        raise ParameterError(f"level is {level!r} dB, expected a number")
    path = Path(path)
    with open_raw(path) as raw:
        samples = raw.whole()
    pressure = REFERENCE_PRESSURE * 10.0 ** (level / 20.0)
    found = []
    for number, row in enumerate(samples, start=1):
        where = str(path) if raw.n_channels == 1 else f"{path}: track {number}"
        with naming(f"{where}: is no calibrator's tone: ", RecordingError):
            frequency, amplitude = _tone(row, raw.rate, fractional=raw.fractional)
        found.append(CalibratorTone(frequency, pressure * math.sqrt(2.0) / amplitude))
    return tuple(found)


def _tone(samples: NDArray[np.float64], rate: float, *, fractional: bool) -> tuple[float, float]:
    """Frequency [Hz] and amplitude of the one stable tone of a track."""
    if samples.size < _SHORTEST * rate:
        raise ParameterError(f"lasts {samples.size / rate:.3g} s; {_SHORTEST:g} s at least")
    if not np.isfinite(samples).all():
        raise ParameterError("holds samples that are no numbers")
    x = samples - samples.mean()
    peak = float(np.abs(x).max())
    if peak == 0.0 or rate < 2.5 * FREQUENCIES[-1]:
        raise ParameterError("is silent" if peak == 0.0 else f"is sampled at {rate:g} Hz alone")
    frequency = _strongest(x, rate)
    if not any(abs(frequency - each) <= _OFF * each for each in FREQUENCIES):
        raise ParameterError(
            f"its strongest tone is at {frequency:.4g} Hz, and calibrators sound at 250 or 1000 Hz"
        )
    if fractional and float(np.abs(samples).max()) >= 1.0 - _STEP:
        raise ParameterError("it reaches full scale, where it is cut off; turn the gain down")
    n = round(_BLOCK * rate)
    blocks = x[: x.size // n * n].reshape(-1, n).T
    phase = 2.0 * np.pi * frequency / rate * np.arange(n)
    basis = np.column_stack([np.cos(phase), np.sin(phase), np.ones(n)])
    found = np.linalg.lstsq(basis, blocks, rcond=None)[0]
    tone = np.hypot(found[0], found[1])
    if not tone.min() > 0.0:
        raise ParameterError("its tone is not there all the time")
    levels = 20.0 * np.log10(tone)
    drift = float(np.ptp(levels))
    if drift > _DRIFT:
        low, high = sorted(_BLOCK * np.array([levels.argmin(), levels.argmax()]))
        raise ParameterError(
            f"its level changes by {drift:.2g} dB between {low:.3g} and {high:.3g} s, and may by "
            f"{_DRIFT:g}; cut it to where it is steady"
        )
    amplitude = math.sqrt(float(np.mean(tone**2)))
    beside = math.sqrt(2.0 * float(np.mean((blocks - basis @ found) ** 2))) / amplitude
    if beside > _BESIDE:
        raise ParameterError(
            f"what is not the tone is {beside:.1%} of it, and may be {_BESIDE:.0%}: it is "
            "overloaded, badly seated, its tops are cut off, or there is other sound"
        )
    return frequency, amplitude


def _strongest(x: NDArray[np.float64], rate: float) -> float:
    """Frequency of the strongest line [Hz], between the lines of a transform."""
    spectrum = np.abs(np.fft.rfft(x * np.hanning(x.size)))
    k = int(np.clip(np.argmax(spectrum), 1, spectrum.size - 2))
    left, middle, right = np.log(spectrum[k - 1 : k + 2] + 1e-300)
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right) if middle > left else 0.0
    return float((k + shift) * rate / x.size)
