"""Recordings as audible sound: for listening, not for measuring.

Three decisions. Sound is resampled by a polyphase filter whose stop band begins where the lower of
both rates folds back: images and alias, which an ear would take for a squeal of the bushing, lie
100 dB down, and the filter's phase is linear, so that a slip stays a click. Level is one number,
the pressure at full scale; several sounds share it where they are to be compared. And that number
travels with the sound: in its sidecar, and in the file's own description, as sound level meters
write it, so that the WAV stays calibrated when the sidecar is lost. (Floating-point samples have
no other place for it, since a sidecar's ``scale`` is for integers.)
"""

from __future__ import annotations

import json
import math
import struct
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.atomic import atomic
from noise.recordings.sidecar import sidecar_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from models.recording import Channel, Recording

__all__ = [
    "BITS",
    "QUIETEST_FULL_SCALE",
    "audible",
    "common_full_scale",
    "least_full_scale",
    "write_audio",
]

QUIETEST_FULL_SCALE = 0.1
"""By default no calibrated sound is amplified beyond this full scale [Pa]: silence stays silent."""

BITS = (16, 24, 32)
"""Sizes of a sample: integer, integer, floating point."""

_FADE = 0.010  # s, half a Hann window at either end
_STOP_BAND = 100.0  # dB
_PASS_BAND = 0.95  # of the lower Nyquist frequency
_FINEST_RATIO = 1000  # terms of the ratio of the rates; the pitch is right within 1e-6
_LARGEST_FILE = 1 << 32  # byte


def audible(recording: Recording, rate: int = 48000) -> NDArray[np.float64]:
    """Return the sound of a recording's first pressure channel, ready to be listened to.

    Parameters
    ----------
    recording : Recording
    rate : int
        Sampling rate of the result [Hz].

    Returns
    -------
    ndarray, shape (n_samples,)
        Sound pressure [Pa], or in fractions of full scale where the recording is not calibrated;
        without its mean, faded in and out over 10 ms.

    Raises
    ------
    ParameterError
        The recording has no pressure channel.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> run = Recording(np.ones((1, 3000)), 30e3, (Channel("pressure"),))
    >>> audible(run).shape, audible(run, 44100).shape
    ((4800,), (4410,))
    """
    signal = recording[_pressure_channel(recording).name]
    sound = _resampled(signal - signal.mean(), recording.rate, rate)
    n = min(round(_FADE * rate), sound.size // 2)
    fade = np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / max(n, 1)) ** 2
    sound[:n] *= fade
    sound[sound.size - n :] *= fade[::-1]
    return sound


def common_full_scale(signals: Iterable[NDArray[np.float64]], headroom_db: float = 3.0) -> float:
    """Return the one full scale at which a set of sounds keeps its relative loudness.

    Parameters
    ----------
    signals : iterable of ndarray
        Sounds in the same unit.
    headroom_db : float
        How far below full scale the largest peak of all is put [dB].

    Returns
    -------
    float
        Value of a full-scale sample, in the sounds' unit; 1 where all are silent.

    Examples
    --------
    >>> quiet, loud = np.array([0.0, 0.1]), np.array([0.0, -2.0])
    >>> round(common_full_scale([quiet, loud], headroom_db=6.0), 3)
    3.991
    """
    peak = max((float(np.abs(signal).max(initial=0.0)) for signal in signals), default=0.0)
    return peak * 10.0 ** (headroom_db / 20.0) or 1.0


def least_full_scale(samples: NDArray[np.float64], bits: int) -> float:
    """Smallest full scale at which none of the samples clips, rounded up to four digits.

    Examples
    --------
    >>> least_full_scale(np.array([0.5, -1.23456]), 24)
    1.235
    """
    peak = float(np.abs(samples).max(initial=0.0)) / _largest(bits)
    if peak == 0.0:
        return 0.0
    digit = 10.0 ** (math.floor(math.log10(peak)) - 3)
    value = math.ceil(peak / digit) * digit
    rounded = float(f"{value:.4g}")
    return rounded if rounded >= peak else float(f"{value + digit:.4g}")


def write_audio(
    path: str | Path,
    samples: NDArray[np.float64],
    rate: int,
    *,
    full_scale: float,
    bits: int = 24,
    recording: Recording,
) -> Path:
    """Write sound as a WAV file for listening, with a sidecar; both whole or not at all.

    Parameters
    ----------
    path : path-like
        ``squeal`` and ``squeal.wav`` are the same; parent folders are made.
    samples : ndarray, shape (n_samples,)
        What `audible` gives.
    rate : int
        Sampling rate [Hz].
    full_scale : float
        Value of a full-scale sample, in the unit of `samples`.
    bits : int
        One of `BITS`; 32 is floating point, full scale being 1.
    recording : Recording
        Where the sound comes from: its condition, microphone and calibration go into the sidecar.

    Returns
    -------
    Path
        The WAV file. `noise.recordings.read_recording` reads it back calibrated, if the recording
        was.

    Raises
    ------
    ParameterError
        A sample would clip, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import read_recording
    >>> run = Recording(np.full((1, 480), 0.25), 48e3, (Channel("pressure"),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_audio(Path(folder) / "tone", run["pressure"], 48000, full_scale=2.0,
    ...                        recording=run)
    ...     float(read_recording(path)["pressure"].max())
    0.25
    """
    target = Path(path)
    if target.suffix.lower() != ".wav":
        target = target.with_name(target.name + ".wav")
    if bits not in BITS:
        raise ParameterError(f"{target}: samples of {bits} bit; there are 16, 24 and 32 (float)")
    if not 0.0 < full_scale < math.inf:
        raise ParameterError(f"{target}: full scale is {full_scale!r}, expected a positive number")
    least = least_full_scale(samples, bits)
    if not float(np.abs(samples).max(initial=0.0)) <= full_scale * _largest(bits):
        raise ParameterError(
            f"{target}: full scale {full_scale:g} would clip; the smallest that does not is "
            f"{least:g}"
        )
    with atomic(target) as wav, atomic(target.with_suffix(".json")) as sidecar:
        description = _description(full_scale) if recording.calibrated else ""
        wav.write_bytes(_wav(samples / full_scale, rate, bits, description))
        sidecar.write_text(_sidecar(recording, samples, rate, full_scale, bits), encoding="utf-8")
    return target


def _pressure_channel(recording: Recording) -> Channel:
    for channel in recording.channels:
        if channel.kind == "pressure":
            return channel
    have = ", ".join(recording.channel_names)
    raise ParameterError(
        f"recording {recording.name!r} has no pressure channel to be heard; it has {have}"
    )


def _resampled(signal: NDArray[np.float64], rate: float, new_rate: int) -> NDArray[np.float64]:
    from scipy.signal import firwin, kaiser_beta, resample_poly

    ratio = Fraction(new_rate / rate).limit_denominator(_FINEST_RATIO)
    if ratio == 1:
        return np.array(signal, dtype=float)
    up, down = ratio.numerator, ratio.denominator
    # Frequencies relative to the Nyquist frequency of the rate that both are divisors of.
    stop = 1.0 / max(up, down)
    n_taps = math.ceil((_STOP_BAND - 7.95) / (2.285 * math.pi * (1.0 - _PASS_BAND) * stop)) | 1
    window = ("kaiser", kaiser_beta(_STOP_BAND))
    taps = firwin(n_taps, 0.5 * (1.0 + _PASS_BAND) * stop, window=window)
    return np.asarray(resample_poly(signal, up, down, window=taps))


def _largest(bits: int) -> float:
    """Largest sample that does not clip, as a fraction of full scale."""
    return 1.0 if bits == 32 else 1.0 - 2.0 ** (1 - bits)


def _description(full_scale: float) -> str:
    return f"0dBFS = {20.0 * math.log10(full_scale / REFERENCE_PRESSURE):.6f} dBSPL"


def _wav(fractions: NDArray[np.float64], rate: int, bits: int, description: str) -> bytes:
    if bits == 32:
        code, data = 3, fractions.astype("<f4").tobytes()
    else:
        integers = np.round(fractions * 2.0 ** (bits - 1)).astype("<i4")
        code, data = 1, integers.view(np.uint8).reshape(-1, 4)[:, : bits // 8].tobytes()
    frame = bits // 8
    if fractions.size * frame >= _LARGEST_FILE - 1024:  # what stands before the samples
        raise ParameterError(f"{fractions.size} samples do not fit into a WAV file (4 GiB)")
    chunks = [(b"fmt ", struct.pack("<HHIIHH", code, 1, rate, rate * frame, frame, bits))]
    if bits == 32:
        chunks += [(b"fact", struct.pack("<I", fractions.size))]
    if description:
        # EBU Tech 3285: 602 bytes, of which the first 256 are the description.
        chunks += [(b"bext", description.encode("ascii").ljust(602, b"\0"))]
    chunks += [(b"data", data)]
    body = b"".join(
        name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)
        for name, content in chunks
    )
    return b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WAVE" + body


def _sidecar(
    recording: Recording, samples: NDArray[np.float64], rate: int, full_scale: float, bits: int
) -> str:
    channel = replace(_pressure_channel(recording), name="pressure")
    sound = replace(recording, samples=samples[np.newaxis], rate=float(rate), channels=(channel,))
    content = json.loads(sidecar_text(sound))
    if recording.calibrated and bits < 32:
        content["channels"][0]["scale"] = full_scale
    elif recording.calibrated:
        # Floating-point samples whose channels are named would be read as pascals; these are
        # fractions of full scale, and the file's description says what that is.
        del content["calibrated"]
        content["audio"] = content.pop("channels")[0] | {"scale": full_scale}
    return json.dumps(content, indent=1) + "\n"
