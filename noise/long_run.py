"""From an operating condition to a file, for runs too long to be held in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.recording import Recording
from noise.base.remarks import NEVER_SLIPS
from noise.recordings.wav import write_blocks

if TYPE_CHECKING:
    import os
    from pathlib import Path

    from sim.blocks import BlockRun

__all__ = ["write_run"]


def write_run(path: str | os.PathLike[str], run: BlockRun, notes: tuple[str, ...] = ()) -> Path:
    """Compute a run and write it, block by block, into a WAV file with its sidecar.

    Parameters
    ----------
    path : path-like
        ``run07`` and ``run07.wav`` are the same; parent folders are made.
    run : BlockRun
        Of `sim.blocks.simulate_blocks`; a WAV file holds 4 GiB, 2.4 h at 30 kHz.
    notes : tuple of str
        For the sidecar, which also says so where nothing ever slips.

    Returns
    -------
    Path
        The WAV file.

    Raises
    ------
    ParameterError
        The motion cannot be solved, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from models.rig_file import load_material_rig
    >>> from noise.recordings import read_recording
    >>> from sim.blocks import simulate_blocks
    >>> run = simulate_blocks(load_material_rig("PDMS"), 5.0, seconds=0.2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     read_recording(write_run(Path(folder) / "run07", run)).duration
    0.2
    """
    about = Recording(
        np.zeros((len(run.channels), 0)), run.rate, run.channels, run.condition, notes=notes
    )
    return write_blocks(
        path,
        run.blocks,
        run.n_samples,
        about,
        lambda: (NEVER_SLIPS,) if run.watch.never_slips else (),
    )
