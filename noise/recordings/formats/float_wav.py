"""Writing samples as 32-bit float WAV.

The sound library adds the time of day to every float WAV file (in its PEAK chunk), so the same run
would never give the same bytes twice. The header without it is short, and written here.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

__all__ = ["float_wav_header", "write_float_wav"]

_IEEE_FLOAT = 3
_BYTES = 4
_HEADER = 58
_BLOCK = 1 << 16  # samples a channel


def write_float_wav(path: Path, samples: NDArray[np.float64], rate: int) -> None:
    """Write a WAV file of 32-bit floating-point samples; the same samples give the same bytes.

    Parameters
    ----------
    path : Path
        The file to write.
    samples : ndarray, shape (n_channels, n_samples)
        Finite in 32 bits.
    rate : int
        Sampling rate [Hz].

    Raises
    ------
    ParameterError
        The samples are more than a WAV file can hold, or the header's numbers do not fit.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "torque.wav"
    ...     write_float_wav(path, np.full((1, 16), 30.0), 30000)
    ...     path.read_bytes()[:4], path.stat().st_size
    (b'RIFF', 122)
    """
    n_channels, n_samples = samples.shape
    header = float_wav_header(n_channels, n_samples, rate)
    with path.open("wb") as file:
        file.write(header)
        for start in range(0, n_samples, _BLOCK):
            file.write(samples[:, start : start + _BLOCK].T.astype("<f4").tobytes())


def float_wav_header(n_channels: int, n_samples: int, rate: int) -> bytes:
    """Header of a WAV file; the samples follow it, interleaved, as little-endian 32-bit floats.

    Raises
    ------
    ParameterError
        The samples are more than a WAV file can hold, or the header's numbers do not fit.

    Examples
    --------
    >>> len(float_wav_header(4, 3600 * 30000, 30000))
    58
    """
    frame = n_channels * _BYTES
    size = n_samples * frame
    if max(size + _HEADER, rate * frame) >= 1 << 32 or frame >= 1 << 16:
        raise ParameterError(
            f"{n_channels} channels of {n_samples} samples at {rate} Hz do not fit into a WAV "
            f"file (4 GiB); write shorter recordings"
        )
    header = struct.pack("<4sI4s", b"RIFF", _HEADER - 8 + size, b"WAVE")
    header += struct.pack(
        "<4sIHHIIHHH",
        *(b"fmt ", 18, _IEEE_FLOAT, n_channels, rate, rate * frame, frame, 8 * _BYTES, 0),
    )
    header += struct.pack("<4sII", b"fact", 4, n_samples)
    header += struct.pack("<4sI", b"data", size)
    return header
