"""A WAV file for listening, byte by byte.

The sound library writes neither dither nor a description with the value of full scale, and adds
the time of day to float files, so that the same sound would never give the same bytes twice.
"""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BITS", "integers", "largest_sample", "wav_bytes", "with_full_scale"]

BITS = (16, 24, 32)
"""Sizes of a sample: integer, integer, floating point."""

_LARGEST_FILE = 1 << 32  # byte
_BEFORE_SAMPLES = 1024  # byte, at most
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

    Raises
    ------
    ParameterError
        The samples do not fit into a WAV file.

    Notes
    -----
    EBU Tech 3285 (Broadcast Wave Format). On the dither: S. P. Lipshitz, R. A. Wannamaker and
    J. Vanderkooy, Quantization and dither: a theoretical survey, J. Audio Eng. Soc. 40 (1992)
    355-375.

    Examples
    --------
    >>> wav_bytes(np.zeros(8), 48000, 16)[:4], len(wav_bytes(np.zeros(8), 48000, 16))
    (b'RIFF', 60)
    """
    frame = bits // 8
    if fractions.size * frame >= _LARGEST_FILE - _BEFORE_SAMPLES:
        raise ParameterError(f"{fractions.size} samples do not fit into a WAV file (4 GiB)")
    if bits == 32:
        code, data = 3, fractions.astype("<f4").tobytes()
    else:
        code, data = 1, integers(fractions, bits, dither)
    chunks = [(b"fmt ", struct.pack("<HHIIHH", code, 1, rate, rate * frame, frame, bits))]
    if bits == 32:
        chunks += [(b"fact", struct.pack("<I", fractions.size))]
    if description:
        chunks += [(b"bext", description.encode("ascii").ljust(_DESCRIPTION_CHUNK, b"\0"))]
    chunks += [(b"data", data)]
    body = b"".join(
        name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)
        for name, content in chunks
    )
    return b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WAVE" + body


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
