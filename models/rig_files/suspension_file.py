"""The ``[suspension]`` table of a rig file: a stabilizer bar in two of the rig's bushings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.checks import a_number, a_table, a_text, refuse_unknown
from models.errors import ParameterError
from models.rig_files.rig_file import read_toml, rig_from
from models.rig_files.shipped import suspension_file
from models.suspension import Bar, Suspension

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

__all__ = ["find_suspension", "load_suspension"]

_BAR = {
    "bar_diameter_mm": ("diameter", 1e-3),
    "bar_wall_mm": ("wall", 1e-3),
    "bar_length_mm": ("length", 1e-3),
    "arm_length_mm": ("arm_length", 1e-3),
    "arm_inertia_kgm2": ("arm_inertia", 1.0),
    "bar_damping_ratio": ("damping_ratio", 1.0),
    "shear_modulus_Pa": ("shear_modulus", 1.0),
    "density_kgm3": ("density", 1.0),
}
_LINKS = {
    "bushing_spacing_mm": ("spacing", 1e-3),
    "link_stiffness_N_m": ("link_stiffness", 1.0),
    "link_damping_Ns_m": ("link_damping", 1.0),
}
_MAY_VANISH = {"bar_damping_ratio", "link_damping_Ns_m"}


def find_suspension(named: Path) -> Path | None:
    """Return the file that ``--rig`` names if it holds a suspension, else None.

    Parameters
    ----------
    named : Path
        A file, or ``suspension`` for the shipped example where no file has this name.

    Examples
    --------
    >>> from pathlib import Path
    >>> find_suspension(Path("suspension")).name
    'suspension.toml'
    """
    if str(named) == "suspension" and not named.exists():
        return suspension_file()
    try:
        content = read_toml(named, "")
    except ParameterError:
        return None  # who reads it next says why
    return named if "suspension" in content else None


def load_suspension(path: Path) -> Suspension:
    """Read a file with a suspension.

    Parameters
    ----------
    path : Path
        As of `find_suspension`.

    Returns
    -------
    Suspension

    Raises
    ------
    ParameterError
        It holds what cannot be used; the message names the key.

    Examples
    --------
    >>> load_suspension(suspension_file()).wheels
    'opposite'
    """
    where = f"rig file {path}"
    content = dict(read_toml(path, where))
    table = a_table(content.pop("suspension"), "suspension", where)
    rig = rig_from(content, path.parent, where)
    where = f"{where}, suspension"
    refuse_unknown(table, {*_BAR, *_LINKS, "wheels"}, where)

    def numbers(keys: dict[str, tuple[str, float]]) -> dict[str, Any]:
        return {
            field: unit * a_number(table, key, where, closed=key in _MAY_VANISH)
            for key, (field, unit) in keys.items()
        }

    try:
        return Suspension(
            rig, Bar(**numbers(_BAR)), **numbers(_LINKS),
            wheels=a_text(table.get("wheels"), "wheels", where),
        )  # fmt: skip
    except ParameterError as error:
        text = str(error)
        raise ParameterError(text if text.startswith("rig file") else f"{where}: {text}") from None
