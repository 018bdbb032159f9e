"""Calibration from the recorded tone of a sound calibrator.

Calibrators give 250 Hz or 1 kHz at a stated level, usually 94 or 114 dB re 20 uPa (IEC 60942). A
sine is fitted to blocks of a tenth of a second. A recording is refused if its frequency is not that
of a calibrator, if the level drifts (a microphone not yet seated, or taken out), or if other
components exceed the distortion that the standard allows a class 2 calibrator. The level is that of
the fundamental alone, so rumble and hiss do not count.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, RecordingError, naming
from models.recording import REFERENCE_PRESSURE
from noise.recordings.files import open_raw

FREQUENCIES = (250.0, 1000.0)
"""Frequencies of calibrators [Hz] (IEC 60942)."""

_FREQUENCY_TOLERANCE = 0.025
"""Largest relative deviation of the frequency [-]; pistonphones give 251.2 Hz."""

_SHORTEST = 0.5
"""Shortest recording [s]."""

_BLOCK = 0.1
"""Length of a block [s]."""

_DRIFT = 0.3
"""Largest difference between the levels of blocks [dB]."""

_RESIDUAL = 0.04
"""Largest rms of the residual over that of the tone [-] (IEC 60942, class 2): harmonics of overload
or clipping, other sound."""

_STEP = 2.0**-15
"""Quantisation step of 16-bit samples over full scale [-]."""


class CalibratorTone(NamedTuple):
    """Tone of a calibrator.

    Parameters
    ----------
    frequency : float
        [Hz]
    full_scale : float
        Pressure of a full-scale sample [Pa].
    """

    frequency: float
    full_scale: float


def read_calibrator(path: str | os.PathLike[str], level: float) -> CalibratorTone:
    """Read the recording of a calibrator and return the value of full scale.

    Parameters
    ----------
    path : path-like
        Recording of one track in any format; a calibration in it is ignored.
    level : float
        Level of the calibrator [dB re 20 uPa].

    Returns
    -------
    CalibratorTone

    Raises
    ------
    RecordingError
        The file cannot be read, has several tracks, or is not one stable tone; the message states
        the reason.
    ParameterError
        The level is not finite.

    Examples
    --------
    >>> import tempfile, soundfile
    >>> tone = 0.1 * np.sin(2.0 * np.pi * 1000.0 * np.arange(48_000) / 48e3)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     soundfile.write(Path(folder) / "tone.wav", tone, 48_000)
    ...     found = read_calibrator(Path(folder) / "tone.wav", 94.0)
    >>> round(found.frequency, 2), round(found.full_scale, 2)
    (1000.0, 14.18)
    """
    if not math.isfinite(level):
        raise ParameterError(f"level is {level!r} dB, expected a number")
    path = Path(path)
    with open_raw(path) as raw:
        samples = raw.whole()
    with naming(f"{path}: is no calibrator's tone: ", RecordingError):
        if raw.n_channels > 1:
            raise ParameterError(f"it has {raw.n_channels} tracks; give one with the tone alone")
        frequency, amplitude = _tone(samples[0], raw.rate, fractional=raw.fractional)
    pressure = REFERENCE_PRESSURE * 10.0 ** (level / 20.0)
    return CalibratorTone(frequency, pressure * math.sqrt(2.0) / amplitude)


def _tone(samples: NDArray[np.float64], rate: float, *, fractional: bool) -> tuple[float, float]:
    """Return frequency [Hz] and amplitude [stored unit] of the tone on a track."""
    if samples.size < _SHORTEST * rate:
        raise ParameterError(f"lasts {samples.size / rate:.3g} s; {_SHORTEST:g} s at least")
    if not np.isfinite(samples).all():
        raise ParameterError("holds samples that are no numbers")
    x = samples - samples.mean()
    peak = float(np.abs(x).max())
    if peak == 0.0 or rate < 2.5 * FREQUENCIES[-1]:
        raise ParameterError("is silent" if peak == 0.0 else f"is sampled at only {rate:g} Hz")
    frequency = _strongest(x, rate)
    if not any(abs(frequency - each) <= _FREQUENCY_TOLERANCE * each for each in FREQUENCIES):
        raise ParameterError(
            f"its strongest tone is at {frequency:.4g} Hz; calibrators give 250 or 1000 Hz"
        )
    if fractional and float(np.abs(samples).max()) >= 1.0 - _STEP:
        raise ParameterError("it reaches full scale and clips; turn the gain down")
    n = round(_BLOCK * rate)
    blocks = x[: x.size // n * n].reshape(-1, n).T
    phase = 2.0 * np.pi * frequency / rate * np.arange(n)
    basis = np.column_stack([np.cos(phase), np.sin(phase), np.ones(n)])
    coefficients = np.linalg.lstsq(basis, blocks, rcond=None)[0]
    tone = np.hypot(coefficients[0], coefficients[1])
    if not tone.min() > 0.0:
        raise ParameterError("its tone is interrupted")
    levels = 20.0 * np.log10(tone)
    drift = float(np.ptp(levels))
    if drift > _DRIFT:
        low, high = sorted(_BLOCK * np.array([levels.argmin(), levels.argmax()]))
        raise ParameterError(
            f"its level changes by {drift:.2g} dB between {low:.3g} and {high:.3g} s, more than "
            f"the allowed {_DRIFT:g} dB; cut it to the steady part"
        )
    amplitude = math.sqrt(float(np.mean(tone**2)))
    residual = math.sqrt(2.0 * float(np.mean((blocks - basis @ coefficients) ** 2))) / amplitude
    if residual > _RESIDUAL:
        raise ParameterError(
            f"other components are {residual:.1%} of the tone, more than the allowed "
            f"{_RESIDUAL:.0%}: overload, clipping, a badly seated microphone, or other sound"
        )
    return frequency, amplitude


def _strongest(x: NDArray[np.float64], rate: float) -> float:
    """Return the frequency of the strongest line [Hz], interpolated between bins."""
    spectrum = np.abs(np.fft.rfft(x * np.hanning(x.size)))
    k = int(np.clip(np.argmax(spectrum), 1, spectrum.size - 2))
    left, middle, right = np.log(spectrum[k - 1 : k + 2] + 1e-300)
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right) if middle > left else 0.0
    return float((k + shift) * rate / x.size)
