"""Hammer hits on the modelled clamp and beams, to try the way from hits to a rig file on.

The bushing is out; the hammer strikes the clamp `ARM` from its axis.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from models.transfer_functions.filtering import convolve
from noise.base.files import atomic

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["ARM", "N_HITS", "write_hits"]

ARM = 0.05
"""Lever of the hammer [m]."""

N_HITS = 5

_SUPPORT = 2214.0  # Nm/rad
_RATE = 25_600  # Hz
_SECONDS = 0.8  # the response has died away by then
_START = 0.01  # of the blow [s]
_BLOW = 0.25e-3  # its length, with a hard tip [s]
_FORCE = (40.0, 90.0)  # N
_FORCE_NOISE, _ACCELERATION_NOISE = 0.02, 0.02  # rms, N and m/s2


def write_hits(folder: Path, rng: np.random.Generator) -> None:
    """Write `N_HITS` hits as NPY files of time [s], force [N] and acceleration [m/s2].

    Parameters
    ----------
    folder : Path
        Made if it is missing.
    rng : numpy.random.Generator
        Of how hard the hammer strikes, and of the sensors' noise.

    Raises
    ------
    ParameterError
        The folder cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_hits(Path(folder) / "hits", np.random.default_rng(0))
    ...     np.load(Path(folder) / "hits" / "hit-1.npy").shape
    (3, 20480)
    """
    paths = impulse_responses(load_material_rig("fluorocarbon"), 0.279e-3, _SUPPORT, _RATE)
    time = np.arange(round(_SECONDS * _RATE)) / _RATE
    during = (time >= _START) & (time < _START + _BLOW)
    blow = np.where(during, np.sin(np.pi * (time - _START) / _BLOW), 0.0)
    for number in range(1, N_HITS + 1):
        force = rng.uniform(*_FORCE) * blow
        acceleration = convolve(ARM * force, paths.torque_to_acceleration)
        force = force + _FORCE_NOISE * rng.standard_normal(time.size)
        acceleration = acceleration + _ACCELERATION_NOISE * rng.standard_normal(time.size)
        with atomic(folder / f"hit-{number}.npy") as target, target.open("wb") as file:
            np.save(file, np.stack([time, force, acceleration]))
