"""Writer of WAV files: recordings with their sidecars, and sounds.

The same samples give the same bytes. Libraries do not serve here: soundfile pads the header or adds
the time of day, and supports no ``bext`` description; scipy needs all samples at once. Runs that do
not fit into memory are written in blocks, whose total length the header announces.
"""

from __future__ import annotations

import math
import os
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, naming
from models.recording import REFERENCE_PRESSURE, Recording
from noise.base.files import atomic
from noise.recordings.files import MIN_SAMPLES
from noise.recordings.formats import formats
from noise.recordings.sidecar import sidecar_text

_DESCRIPTION_CHUNK = 602  # byte (EBU Tech 3285); the first 256 are the description
_BLOCK = 1 << 16  # samples per channel


def write_recording(path: str | os.PathLike[str], recording: Recording) -> Path:
    """Write a recording as a 32-bit float WAV file with its sidecar, atomically.

    Parameters
    ----------
    path : path-like
        ``run07`` and ``run07.wav`` are equivalent; parent folders are made.
    recording : Recording
        Recording whose samples are written unscaled: full scale is one unit.

    Returns
    -------
    Path
        The WAV file.

    Raises
    ------
    ParameterError
        The recording cannot be written, or could not be read back.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> silence = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = write_recording(Path(folder) / "runs" / "none", silence)
    ...     sorted(file.name for file in Path(folder).glob("runs/*"))
    ['none.json', 'none.wav']
    """
    target, rate = _wav_path(Path(path)), recording.rate
    if recording.n_samples < MIN_SAMPLES:
        raise ParameterError(
            f"{target}: {recording.n_samples} samples, expected at least {MIN_SAMPLES}"
        )
    if not (1 <= rate < 1 << 31 and float(rate).is_integer()):
        raise ParameterError(
            f"{target}: the sampling rate is {rate!r} Hz, but WAV holds whole hertz only"
        )
    text = sidecar_text(recording)  # refuses values that could not be read back
    with naming(f"{target}: "):
        header = _header(recording.n_samples, int(rate), 32, n_channels=len(recording.channels))
    with atomic(target.with_suffix(".json")) as sidecar, atomic(target) as wav:
        with wav.open("wb") as file:
            file.write(header)
            for at in range(0, recording.n_samples, _BLOCK):
                with np.errstate(over="ignore"):
                    frames = recording.samples[:, at : at + _BLOCK].T.astype("<f4")
                finite = np.isfinite(frames).all(axis=0)
                if not finite.all():
                    name = recording.channel_names[int(np.argmin(finite))]
                    raise ParameterError(
                        f"{target}: channel {name!r} holds samples that are not finite in 32 bits"
                    )
                file.write(frames.tobytes())
        sidecar.write_text(text, encoding="utf-8")
        # A call that is killed here leaves samples without a sidecar, none with a wrong one.
        target.with_suffix(".json").unlink(missing_ok=True)
    return target


def _wav_path(path: Path) -> Path:
    """Return the path of the WAV file for an output name."""
    ending = path.suffix.lower()
    if not path.name:
        raise ParameterError(f"{str(path)!r} names no file to write a recording to")
    if ending == ".wav":
        return path
    if ending in formats() or ending == ".json":
        raise ParameterError(f"{path}: recordings are written as WAV; end the name in .wav")
    return path.with_name(path.name + ".wav")


def largest_sample(bits: int) -> float:
    """Return the largest sample that does not clip, as a fraction of full scale.

    Examples
    --------
    >>> largest_sample(32), largest_sample(16) * 2**15
    (1.0, 32767.0)
    """
    return 1.0 if bits == 32 else 1.0 - 2.0 ** (1 - bits)


def with_full_scale(full_scale: float) -> str:
    """Return a description that states the value of full scale [Pa], as sound level meters do.

    Examples
    --------
    >>> with_full_scale(2.0)
    '0dBFS = 100.000000 dBSPL (peak); full scale 2 Pa'
    """
    level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
    return f"0dBFS = {level:.6f} dBSPL (peak); full scale {full_scale:.9g} Pa"


def wav_bytes(
    fractions: NDArray[np.float64], rate: int, bits: int, *, description: str = ""
) -> bytes:
    """Encode a mono sound as a WAV file.

    Parameters
    ----------
    fractions : ndarray, shape (n_samples,)
        Samples as fractions of full scale [-], without clipping.
    rate : int
        Sampling rate [Hz].
    bits : int
        16 or 24 for integers, or 32 for floating point.
    description : str
        Text of the ``bext`` chunk, which is omitted if empty.

    Examples
    --------
    >>> wav_bytes(np.zeros(8), 48000, 16)[:4], len(wav_bytes(np.zeros(8), 48000, 16))
    (b'RIFF', 60)
    """
    header = _header(fractions.size, rate, bits, description=description)
    if bits == 32:
        return header + fractions.astype("<f4").tobytes()
    steps = np.round(fractions * 2.0 ** (bits - 1)).astype("<i4")
    samples = steps.view(np.uint8).reshape(-1, 4)[:, : bits // 8].tobytes()
    return header + samples + bytes(len(samples) % 2)


def _header(
    n_samples: int, rate: int, bits: int, *, n_channels: int = 1, description: str = ""
) -> bytes:
    """Return the header of a WAV file up to the samples (EBU Tech 3285)."""
    frame = n_channels * bits // 8
    size, floating = n_samples * frame, bits == 32
    kind = (3 if floating else 1, n_channels, rate, rate * frame, frame, bits)
    if max(size + 1024, rate * frame) >= 1 << 32 or frame >= 1 << 16:
        raise ParameterError(
            f"{n_channels} channels of {n_samples} samples at {rate} Hz do not fit into a WAV "
            f"file (4 GiB); write shorter recordings"
        )
    chunks = [(b"fmt ", struct.pack("<HHIIHH", *kind) + bytes(2 * floating))]
    if floating:
        chunks.append((b"fact", struct.pack("<I", n_samples)))
    if description:
        chunks.append((b"bext", description.encode("ascii").ljust(_DESCRIPTION_CHUNK, b"\0")))
    head = b"".join(name + struct.pack("<I", len(content)) + content for name, content in chunks)
    riff = struct.pack("<4sI4s", b"RIFF", 12 + len(head) + size + size % 2, b"WAVE")
    return riff + head + struct.pack("<4sI", b"data", size)
