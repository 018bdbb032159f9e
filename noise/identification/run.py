"""The identification of a folder, as a notebook calls it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from noise.identification.identify import identify_rig
from noise.identification.measured import known_beforehand, read_measurements
from noise.identification.outcome import Identification, as_json


def identify(
    data: str | Path | Sequence[str | Path],
    rig: str | Path | None = None,
) -> Identification:
    """Identify a rig from recordings.

    Parameters
    ----------
    data : path or sequence of paths
        Recordings of torque and angle, or folders of them.
    rig : path, optional
        Rig file that states what is known, the two inertias above all.

    Returns
    -------
    Identification

    Raises
    ------
    ParameterError
        Rig file or recordings cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     identify(folder)
    Traceback (most recent call last):
    models.errors.ParameterError: ...
    """
    paths = [Path(data)] if isinstance(data, str | Path) else [Path(path) for path in data]
    beforehand = known_beforehand(None if rig is None else Path(rig))
    calibrations = beforehand.rig.sensors.calibrations
    return identify_rig(read_measurements(paths, calibrations), beforehand)


def identification_json(data: Path, rig: Path) -> dict[str, Any]:
    """Identify a folder's rig; return what ``identification.json`` holds."""
    return as_json(identify(data, rig))
