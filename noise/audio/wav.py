"""A WAV file for listening, byte by byte.

The sound library writes neither dither nor a description with the value of full scale, and adds
the time of day to float files, so that the same sound would never give the same bytes twice.
"""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

import numpy as np

from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "BITS",
    "integers",
    "largest_sample",
    "wav_bytes",
    "wav_end",
    "wav_header",
    "wav_samples",
    "with_full_scale",
]

BITS = (16, 24, 32)
"""Sizes of a sample: integer, integer, floating point."""

_LARGEST_FILE = 1 << 32  # byte
_BEFORE_SAMPLES = 1024  # byte, at most
_IN_DS64 = (1 << 32) - 1  # stands for a size that the chunk ds64 tells
_DESCRIPTION_CHUNK = 602  # byte (EBU Tech 3285); the first 256 are the description


def largest_sample(bits: int) -> float:
    """Largest sample that does not clip, as a fraction of full scale.

    Examples
    --------
    >>> largest_sample(32), largest_sample(16) * 2**15
    (1.0, 32767.0)
    """
    return 1.0 if bits == 32 else 1.0 - 2.0 ** (1 - bits)


def with_full_scale(full_scale: float) -> str:
    """Say in a description what full scale is worth [Pa], as sound level meters do.

    Examples
    --------
    >>> with_full_scale(2.0)
    '0dBFS = 100.000000 dBSPL (peak); full scale 2 Pa'
    """
    level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
    return f"0dBFS = {level:.6f} dBSPL (peak); full scale {full_scale:.9g} Pa"


def wav_bytes(
    fractions: NDArray[np.float64],
    rate: int,
    bits: int,
    *,
    description: str = "",
    dither: np.random.Generator | None = None,
) -> bytes:
    """Encode a sound.

    Parameters
    ----------
    fractions : ndarray, shape (n_samples,)
        Over full scale [-]; none may clip.
    rate : int
        Sampling rate [Hz].
    bits : int
        One of `BITS`.
    description : str
        For the ``bext`` chunk, which is left out where there is none.
    dither : numpy.random.Generator, optional
        Where given, integer samples are dithered with a triangular distribution of two steps'
        width before they are rounded, so that what a quiet sound loses is noise and no distortion.

    Notes
    -----
    On the dither: S. P. Lipshitz, R. A. Wannamaker and
    J. Vanderkooy, Quantization and dither: a theoretical survey, J. Audio Eng. Soc. 40 (1992)
    355-375.

    Examples
    --------
    >>> wav_bytes(np.zeros(8), 48000, 16)[:4], len(wav_bytes(np.zeros(8), 48000, 16))
    (b'RIFF', 60)
    """
    header = wav_header(fractions.size, rate, bits, description=description)
    return header + wav_samples(fractions, bits, dither) + wav_end(fractions.size, bits)


def wav_header(n_samples: int, rate: int, bits: int, *, description: str = "") -> bytes:
    """Return what stands before the samples of a WAV file, an RF64 file from 4 GiB on.

    Parameters
    ----------
    n_samples : int
    rate : int
        Sampling rate [Hz].
    bits, description
        As in `wav_bytes`.

    Notes
    -----
    EBU Tech 3285 (Broadcast Wave Format), EBU Tech 3306 (RF64).

    Examples
    --------
    >>> wav_header(8, 48000, 16)[:4], wav_header(1 << 31, 48000, 16)[:4]
    (b'RIFF', b'RF64')
    """
    frame = bits // 8
    size, code = n_samples * frame, 3 if bits == 32 else 1
    large = size >= _LARGEST_FILE - _BEFORE_SAMPLES
    chunks = [(b"fmt ", struct.pack("<HHIIHH", code, 1, rate, rate * frame, frame, bits))]
    if bits == 32:
        chunks += [(b"fact", struct.pack("<I", min(n_samples, _IN_DS64)))]
    if description:
        chunks += [(b"bext", description.encode("ascii").ljust(_DESCRIPTION_CHUNK, b"\0"))]
    head = b"".join(name + struct.pack("<I", len(content)) + content for name, content in chunks)
    head += b"data" + struct.pack("<I", _IN_DS64 if large else size)
    riff = 4 + len(head) + size + size % 2
    if not large:
        return b"RIFF" + struct.pack("<I", riff) + b"WAVE" + head
    sizes = struct.pack("<IQQQI", 28, riff + 36, size, n_samples, 0)
    return b"RF64" + struct.pack("<I", _IN_DS64) + b"WAVEds64" + sizes + head


def wav_samples(
    fractions: NDArray[np.float64], bits: int, dither: np.random.Generator | None = None
) -> bytes:
    """Return samples as they stand in the file; arguments as of `wav_bytes`.

    Parameters
    ----------
    fractions : ndarray, shape (n,)
        Over full scale [-].
    bits, dither
        As in `wav_bytes`.

    Examples
    --------
    >>> len(wav_samples(np.zeros(8), 24))
    24
    """
    if bits == 32:
        return fractions.astype("<f4").tobytes()
    return integers(fractions, bits, dither)


def wav_end(n_samples: int, bits: int) -> bytes:
    r"""Return what stands behind the samples: their bytes are an even number.

    Examples
    --------
    >>> wav_end(3, 24), wav_end(4, 24)
    (b'\x00', b'')
    """
    return b"\0" * (n_samples * bits // 8 % 2)


def integers(
    fractions: NDArray[np.float64], bits: int, dither: np.random.Generator | None
) -> bytes:
    r"""Return samples as little-endian integers, rounded and dithered as in `wav_bytes`.

    Examples
    --------
    >>> integers(np.array([0.5, -0.5]), 16, None)
    b'\x00@\x00\xc0'
    """
    steps = fractions * 2.0 ** (bits - 1)
    if dither is not None:
        steps += dither.random(steps.size) - dither.random(steps.size)
        most = 2.0 ** (bits - 1) - 1.0
        np.clip(steps, -most, most, out=steps)  # dither alone may not carry a sample beyond
    integers = np.round(steps).astype("<i4")
    return integers.view(np.uint8).reshape(-1, 4)[:, : bits // 8].tobytes()
