"""A WAV file, byte by byte: the same samples give the same bytes.

The sound library pads the header or adds the time of day to it, and writes neither dither nor a
description with the value of full scale; scipy wants all samples at once.
"""

from __future__ import annotations

import math
import struct

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE

BITS = (16, 24, 32)
"""Sizes of a sample: integer, integer, floating point."""

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
    size = fractions.size
    if bits == 32:
        return wav_header(size, rate, bits, description=description) + (
            fractions.astype("<f4").tobytes()
        )
    samples = integers(fractions, bits, dither)
    padding = bytes(len(samples) % 2)
    return wav_header(size, rate, bits, description=description) + samples + padding


def wav_header(
    n_samples: int, rate: int, bits: int, *, n_channels: int = 1, description: str = ""
) -> bytes:
    """Return what stands before the samples of a WAV file.

    Parameters
    ----------
    n_samples : int
        Of each channel.
    rate : int
        Sampling rate [Hz].
    bits, description
        As in `wav_bytes`.
    n_channels : int

    Raises
    ------
    ParameterError
        The samples are more than a WAV file can hold, or the header's numbers do not fit.

    Notes
    -----
    EBU Tech 3285 (Broadcast Wave Format).

    Examples
    --------
    >>> len(wav_header(3600 * 30000, 30000, 32, n_channels=4)), len(wav_header(8, 48000, 16))
    (58, 44)
    """
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
