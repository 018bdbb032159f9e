"""Diagnosis of a folder of recordings."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from models.rig import Rig
from models.rig_file import load_rig
from noise.base.user_effects import effect_library
from noise.diagnosis.case import read_case
from noise.diagnosis.diagnose import diagnose_case
from noise.diagnosis.outcome import Diagnosis, as_json


def diagnose(
    data: str | Path | Sequence[str | Path],
    rig: Rig | str | Path,
    *,
    quick: bool = False,
    effects: str | Path | Sequence[str | Path] = (),
    seed: int = 0,
) -> Diagnosis:
    """Compare recordings with the simulator and name the missing effects.

    Parameters
    ----------
    data : path or sequence of paths
        Recordings, or folders of them.
    rig : Rig or path
        Rig, or its file.
    quick : bool
        Whether to return the first answer, without fits.
    effects : path or sequence of paths
        Python files that define further effects. They are executed.
    seed : int
        Of simulated repeats and bootstraps.

    Returns
    -------
    Diagnosis
        Its ``improved`` is the improved rig, None if nothing closes the gap.

    Raises
    ------
    ParameterError
        Rig file, recordings or effects cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rig = Path(folder) / "rig.toml"
    ...     size = rig.write_text('name = "bench"', encoding="utf-8")
    ...     diagnose(folder, rig)
    Traceback (most recent call last):
    models.errors.ParameterError: ...
    """
    library = effect_library(_paths(effects))
    case = read_case(_paths(data), rig if isinstance(rig, Rig) else load_rig(rig))
    return diagnose_case(case, quick=quick, library=library, seed=seed)


def _paths(given: str | Path | Sequence[str | Path]) -> list[Path]:
    return [Path(given)] if isinstance(given, str | Path) else [Path(path) for path in given]


def diagnosis_json(data: Path, rig: Path, *, quick: bool = False) -> dict[str, Any]:
    """Return the content of ``diagnosis.json`` for a folder."""
    return as_json(diagnose(data, rig, quick=quick))
