"""From an operating condition to a file, for runs too long to be held in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.recordings.writing import write_blocks
from sim.long_run import simulate_blocks

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np

    from models.rig import Rig
    from sim.acquisition import Acquisition
    from sim.effects import Effect
    from sim.shaft import ShaftMotion

__all__ = ["simulate_to_file"]


def simulate_to_file(
    path: str | os.PathLike[str],
    rig: Rig,
    shaft: ShaftMotion | float,
    *,
    seconds: float,
    interference: float = 0.279e-3,
    support_stiffness: float = 2214.0,
    temperature: float = 23.0,
    acquisition: Acquisition | None = None,
    settling: float | None = None,
    library: Mapping[str, Effect] | None = None,
    rng: np.random.Generator | None = None,
    block_seconds: float = 0.5,
) -> Path:
    """Simulate one run of the rig into a WAV file with its sidecar.

    Parameters
    ----------
    path : path-like
        ``run07`` and ``run07.wav`` are the same; parent folders are made.
    rig, shaft, interference, support_stiffness, temperature, acquisition, settling, library, rng
        As for `sim.run.simulate`.
    seconds : float
        Length of the recording [s]; a WAV file holds 4 GiB, 2.4 h at 30 kHz.
    block_seconds : float
        How much is held in memory [s].

    Returns
    -------
    Path
        The WAV file.

    Raises
    ------
    ParameterError
        A value cannot be used, an effect needs the whole run at once, or the file cannot be
        written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from models.rig_files.rig_file import load_material_rig
    >>> from noise.recordings import read_recording
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = simulate_to_file(
    ...         Path(folder) / "run07", load_material_rig("PDMS"), 5.0, seconds=0.2
    ...     )
    ...     read_recording(path).duration
    0.2
    """
    run = simulate_blocks(
        rig,
        shaft,
        interference=interference,
        support_stiffness=support_stiffness,
        temperature=temperature,
        seconds=seconds,
        acquisition=acquisition,
        settling=settling,
        library=library,
        rng=rng,
        block_seconds=block_seconds,
    )
    return write_blocks(
        path,
        run.blocks,
        n_samples=run.n_samples,
        rate=run.rate,
        channels=run.channels,
        condition=run.condition,
    )
