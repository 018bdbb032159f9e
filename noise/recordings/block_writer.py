"""Writing a recording that is never in memory as a whole: the file grows block by block.

The header says at once how long the file will be, so what arrives must be just as much. Until it
has, nothing stands under the file's own name.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.recording import Recording
from noise.base.atomic import atomic
from noise.recordings.files import MIN_SAMPLES, _wav_path
from noise.recordings.formats.float_wav import float_wav_header
from noise.recordings.sidecar import sidecar_text

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from models.condition import Condition
    from models.recording import Channel

__all__ = ["write_blocks"]


def write_blocks(
    path: str | os.PathLike[str],
    blocks: Iterable[NDArray[np.float64]],
    *,
    n_samples: int,
    rate: float,
    channels: tuple[Channel, ...],
    condition: Condition,
) -> Path:
    """Write blocks as one 32-bit float WAV with its sidecar, both whole or not at all.

    Parameters
    ----------
    path : path-like
        ``run07`` and ``run07.wav`` are the same; parent folders are made.
    blocks : iterable of ndarray, shape (n_channels, n)
        In the units of the channels.
    n_samples : int
        Of all blocks together.
    rate : float
        Sampling rate, a whole number [Hz].
    channels : tuple of Channel
    condition : Condition

    Returns
    -------
    Path
        The WAV file.

    Raises
    ------
    ParameterError
        The recording cannot be written there or could not be read back, or the blocks hold
        another number of samples.

    Examples
    --------
    >>> import tempfile
    >>> from models.condition import Condition
    >>> from models.recording import Channel
    >>> from noise.recordings import read_recording
    >>> halves = (np.full((1, 400), value) for value in (20.0, 30.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_blocks(
    ...         Path(folder) / "run07", halves, n_samples=800, rate=30e3,
    ...         channels=(Channel("torque"),), condition=Condition(speed=5.0),
    ...     )
    ...     float(read_recording(path)["torque"].mean())
    25.0
    """
    target = _wav_path(Path(path))
    if n_samples < MIN_SAMPLES:
        raise ParameterError(f"{target}: {n_samples} samples, expected at least {MIN_SAMPLES}")
    if not (1 <= rate < 1 << 31 and float(rate).is_integer()):
        raise ParameterError(
            f"{target}: the sampling rate is {rate!r} Hz, but WAV holds whole hertz only"
        )
    empty = np.zeros((len(channels), 0))
    text = sidecar_text(Recording(empty, rate, channels, condition, name=target.name))
    try:
        header = float_wav_header(len(channels), n_samples, int(rate))
    except ParameterError as error:
        raise ParameterError(f"{target}: {error}") from error
    # The sidecar is moved into place first: samples are never seen without what they mean.
    with atomic(target) as wav, atomic(target.with_suffix(".json")) as sidecar:
        with wav.open("wb") as file:
            file.write(header)
            written = 0
            for block in blocks:
                file.write(_frames(target, block, channels).tobytes())
                written += block.shape[1]
        if written != n_samples:
            raise ParameterError(f"{target}: {written} samples arrived, expected {n_samples}")
        sidecar.write_text(text, encoding="utf-8")
    return target


def _frames(
    target: Path, block: NDArray[np.float64], channels: tuple[Channel, ...]
) -> NDArray[np.float32]:
    if block.ndim != 2 or block.shape[0] != len(channels):
        raise ParameterError(
            f"{target}: a block has shape {block.shape}, expected ({len(channels)}, n_samples)"
        )
    with np.errstate(over="ignore"):
        frames = block.T.astype("<f4")
    finite = np.isfinite(frames).all(axis=0)
    if not finite.all():
        name = channels[int(np.argmin(finite))].name
        raise ParameterError(
            f"{target}: channel {name!r} holds samples that are not finite in 32 bits"
        )
    return frames
