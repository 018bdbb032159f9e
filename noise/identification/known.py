"""What is known of a rig before it is identified: the keys that a rig file really has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.change import changed_rig
from models.rig import Rig
from models.rig_file import read_toml, rig_from, shipped_name
from noise.identification.bushing_fit import Known

_STATED_ERROR = 0.02
"""Relative standard error of what is stated: what bushings scatter by; assumed."""

_GUESSED_ERROR = 0.5
"""And of one that is not; assumed."""


@dataclass(frozen=True)
class Beforehand:
    """What is known beforehand.

    Parameters
    ----------
    rig : Rig
        Of the file, the shipped bench where it says nothing.
    known : Known
    stated : frozenset of str
        Keys that the file has, or one that it builds on.
    structure : str, optional
        The file, where it may have a structure of its own.
    """

    rig: Rig
    known: Known
    stated: frozenset[str]
    structure: str | None = None

    @property
    def inertias_stated(self) -> bool:
        """Whether both inertias are."""
        return {"elastomer_inertia_kgm2", "clamp_inertia_kgm2"} <= self.stated


def known_beforehand(
    path: Path | None, change: Mapping[str, str | float] | None = None
) -> Beforehand:
    """Read a rig file for what it states.

    Parameters
    ----------
    path : Path, optional
        Without one, nothing is known but what the recordings' sidecars say.
    change : mapping of str to str or float, optional
        As ``[change]`` of the file.

    Raises
    ------
    ParameterError
        The file cannot be used.

    Examples
    --------
    >>> known_beforehand(None).inertias_stated
    False
    """
    where = f"rig file {path}"
    content = {} if path is None else read_toml(path, where)
    folder = Path() if path is None else path.parent
    rig = changed_rig(rig_from(content, folder, where), change or {}, "--change")
    stated = frozenset(_stated(content, folder) | _stated({"change": change or {}}, folder))
    shared = "elastomer_damping_share" in stated
    share = rig.elastomer_damping_share if shared else 0.5
    both = {"elastomer_inertia_kgm2", "clamp_inertia_kgm2"} <= stated
    error = _STATED_ERROR if both else _GUESSED_ERROR
    return Beforehand(
        rig,
        Known(
            rig.elastomer_inertia,
            rig.clamp_inertia,
            error,
            share,
            _STATED_ERROR if shared else _GUESSED_ERROR,
        ),
        stated,
        str(path.resolve().as_posix()) if path is not None and stated & _STRUCTURE else None,
    )


_STRUCTURE = {"base", "beams", "plate", "microphone", "measured_response"}


def _stated(content: Mapping[str, Any], folder: Path) -> set[str]:
    """Keys of a file, of its changes, and of the files below it."""
    changed = {
        f"{key}_kgm2" if key.endswith("inertia") else key for key in content.get("change", {})
    }
    base = content.get("base")
    if base is None or shipped_name(base) is not None:
        return {*content, *changed}
    path = folder / base
    return {*content, *changed, *_stated(read_toml(path, f"rig file {path}"), path.parent)}
