"""The beams' table of a rig file, read and checked.

Anchors are rigid unless the file says otherwise, as the thesis assumes (3.1.1), and the plate alone
is heard: what is fitted to recordings of the shipped rig rests on both.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from models.checks import a_number, refuse_unknown
from models.errors import ParameterError
from models.rig import Beams

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["read_beams"]

_RIGID = "rigid"

_NUMBERS = {
    "width": "width_m",
    "thickness": "thickness_m",
    "lever": "lever_m",
    "youngs_modulus": "youngs_modulus_Pa",
    "density": "density_kgm3",
    "damping_ratio": "damping_ratio",
    "accelerometer": "accelerometer",
}

_ANCHORS = {
    "anchor_rotation": "anchor_rotation_Nm_rad",
    "anchor_translation": "anchor_translation_N_m",
}

_OPTIONAL = {"strike": "strike", "height": "height_m", "clamp_width": "clamp_width_m"}
"""Each at most 1."""


def read_beams(table: Mapping[str, Any], where: str) -> Beams:
    """Beams of a table that TOML gives.

    Parameters
    ----------
    table : mapping
        Lengths in m, moduli in Pa, stiffnesses of the anchors in Nm/rad and N/m or ``"rigid"``.
    where : str
        File and table, for what is refused.

    Returns
    -------
    Beams

    Raises
    ------
    ParameterError
        For a key that is unknown or missing, or a value that cannot be used.

    Examples
    --------
    >>> table = {"width_m": 0.0254, "thickness_m": 0.003175, "lever_m": 0.0449,
    ...          "youngs_modulus_Pa": 2e11, "density_kgm3": 8000.0, "damping_ratio": 0.005,
    ...          "accelerometer": 0.75, "anchor_rotation_Nm_rad": 500.0}
    >>> beams = read_beams(table, "bench, beams")
    >>> beams.anchor_rotation, beams.anchor_translation, beams.radiating
    (500.0, inf, False)
    """
    known = {*_NUMBERS.values(), *_ANCHORS.values(), *_OPTIONAL.values(), "radiate"}
    refuse_unknown(table, known, where)
    values = {field: a_number(table, key, where) for field, key in _NUMBERS.items()}
    a_number(table, "damping_ratio", where, high=1.0)
    a_number(table, "accelerometer", where, high=1.0, closed=True)
    for field, key in _ANCHORS.items():
        given = table.get(key, _RIGID)
        if isinstance(given, str) and given != _RIGID:
            raise ParameterError(f'{where}: {key} = {given!r} must be a number above 0, or "rigid"')
        values[field] = math.inf if given == _RIGID else a_number(table, key, where)
    for field, key in _OPTIONAL.items():
        if key in table:
            values[field] = a_number(table, key, where, high=1.0)
    radiating = table.get("radiate", False)
    if not isinstance(radiating, bool):
        raise ParameterError(f"{where}: radiate = {radiating!r} must be true or false")
    return Beams(**values, radiating=radiating)
