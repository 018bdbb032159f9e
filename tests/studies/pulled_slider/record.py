"""Force records of a slider pulled through a spring: MATLAB files named by spring and speed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.io import loadmat

from models.errors import RecordingError
from models.recording import Channel, Recording

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["PulledRecord", "read_pulled_record"]

_NAME = re.compile(r"k(?P<stiffness>\d+(?:\.\d+)?)Nm_v(?P<speed>\d+(?:\.\d+)?)")
_MICRO = 1e-6


@dataclass(frozen=True, eq=False)
class PulledRecord:
    """A force record with the spring and the speed it was pulled with.

    Parameters
    ----------
    recording : Recording
        Channel ``force`` in shares of the slider's weight, so not `calibrated`.
    stiffness : float
        Of the spring [N/m].
    pull : float
        Speed of its far end [m/s].
    """

    recording: Recording
    stiffness: float
    pull: float

    @property
    def name(self) -> str:
        """What the record is called in tables."""
        return self.recording.name


def read_pulled_record(path: Path) -> PulledRecord:
    """Read ``k<N/m>Nm_v<um/s>.mat`` with the variables ``t`` [s] and ``Fnorm`` (force over weight).

    Raises
    ------
    RecordingError
        If the name does not give the setting, the file is no MATLAB file, a variable is missing,
        the two differ in length, or the times are not evenly spaced.
    """
    setting = _NAME.fullmatch(path.stem)
    if setting is None:
        raise RecordingError(
            f"{path.name}: the name must give spring and speed, as in k168Nm_v42.mat"
        )
    try:
        held = loadmat(path, variable_names=["t", "Fnorm"])
    except (OSError, ValueError, NotImplementedError, TypeError) as error:
        raise RecordingError(f"{path.name}: is no MATLAB file up to version 7: {error}") from error
    for name in ("t", "Fnorm"):
        if name not in held:
            raise RecordingError(f"{path.name}: has no variable {name}; it needs t and Fnorm")
    time = np.asarray(held["t"], dtype=np.float64).ravel()
    force = np.asarray(held["Fnorm"], dtype=np.float64).ravel()
    if len(time) != len(force) or len(time) < 2:
        raise RecordingError(
            f"{path.name}: t has {len(time)} values and Fnorm {len(force)}; they must be as many"
        )
    if not np.all(np.isfinite(force)):
        raise RecordingError(f"{path.name}: Fnorm has values that are not finite; remove them")
    interval = float(time[-1] - time[0]) / (len(time) - 1)
    if not interval > 0.0 or np.ptp(np.diff(time)) > 0.01 * interval:
        raise RecordingError(f"{path.name}: t must grow in equal steps")
    recording = Recording(
        force[np.newaxis], 1.0 / interval, (Channel("force"),), calibrated=False, name=path.stem
    )
    return PulledRecord(recording, float(setting["stiffness"]), _MICRO * float(setting["speed"]))
