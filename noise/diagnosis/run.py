"""The diagnosis of a folder, as a notebook and the blind check call it."""

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
    """Diagnose recordings against the simulator.

    Parameters
    ----------
    data : path or sequence of paths
        Recordings, or folders of them.
    rig : Rig or path
        Rig, or its file.
    quick : bool
        Whether to give the first answer alone, without fits.
    effects : path or sequence of paths
        Python files that define effects of the user's own, fitted beside the probable ones, and
        known by their names where the rig file lists them. They are run.
    seed : int
        Of simulated repeats and bootstraps.

    Returns
    -------
    Diagnosis
        Its ``improved`` is the rig with what closes the gap, None where nothing does.

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
    """Diagnose a folder; return what ``diagnosis.json`` holds."""
    return as_json(diagnose(data, rig, quick=quick))
