"""The plate and microphone tables of a rig file: read and checked key by key.

[plate]
edges = "free"                                  # or ["clamped", "free", "free", "free"]
loss_factor = { "100" = 0.05, "1000" = 0.03 }   # by frequency in Hz, or one number

[microphone]
floor = { normal = "y", position_m = -0.8, reflection = 0.9 }
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from models.checks import a_number, a_table, a_text, a_vector, refuse_unknown
from models.errors import ParameterError
from models.rig import EDGES, HIGHEST_PLATE_FREQUENCY, Floor, Microphone, Plate

__all__ = ["a_microphone", "a_plate"]

FEWEST_MODES, MOST_MODES = 5, 5000
"""Of the plate: fewer radiate no band, more take minutes."""

MOST_SOLVED_MODES, MOST_UNLIKE_MODES = 1500, 600
"""Where modes are solved for, and where opposite edges are unlike as well: 4 to 8 seconds."""


def a_plate(table: Mapping[str, Any], where: str) -> Plate:
    """Build the plate.

    Raises
    ------
    ParameterError
        If a key is unknown, missing or holds what no plate has.

    Examples
    --------
    >>> steel = {
    ...     "length_m": 0.9, "width_m": 0.6, "thickness_m": 8e-3, "youngs_modulus_Pa": 2e11,
    ...     "density_kgm3": 7850, "poisson_ratio": 0.3, "loss_factor": 0.03,
    ...     "clamp_position_m": [0, 0], "edges": "glued",
    ... }
    >>> a_plate(steel, "plate")
    Traceback (most recent call last):
    models.errors.ParameterError: plate: edges = 'glued' must be one of free, simply_supported,
    clamped, or a list of four of them
    """
    fields = {
        "length": "length_m",
        "width": "width_m",
        "thickness": "thickness_m",
        "youngs_modulus": "youngs_modulus_Pa",
        "density": "density_kgm3",
        "poisson_ratio": "poisson_ratio",
    }
    refuse_unknown(table, {*fields.values(), "loss_factor", "clamp_position_m", "edges"}, where)
    values = {field: a_number(table, key, where) for field, key in fields.items()}
    a_number(table, "poisson_ratio", where, high=0.5)
    x, y = a_vector(table, "clamp_position_m", 2, where)
    if abs(x) >= 0.5 * values["length"] or abs(y) >= 0.5 * values["width"]:
        raise ParameterError(f"{where}: clamp_position_m = [{x:g}, {y:g}] lies off the plate")
    plate = Plate(
        **values,
        loss_factor=_loss_factor(table, where),
        clamp_position=(x, y),
        edges=_edges(table.get("edges", "simply_supported"), where),
    )
    modes = plate.expected_modes(HIGHEST_PLATE_FREQUENCY)
    left, right, front, back = plate.sides
    most, kind = MOST_MODES, "a plate"
    if set(plate.sides) != {"simply_supported"}:
        most, kind = MOST_SOLVED_MODES, "one whose edges are not all simply_supported"
    if left != right or front != back:
        most, kind = MOST_UNLIKE_MODES, "one whose opposite edges are unlike"
    if not FEWEST_MODES <= modes <= most:
        raise ParameterError(
            f"{where}: a plate of {plate.length:g} x {plate.width:g} x {plate.thickness:g} m has "
            f"about {modes:.3g} modes up to 16 kHz; {kind} must have {FEWEST_MODES} to {most}"
        )
    return plate


def a_microphone(table: Mapping[str, Any], plate: Plate, where: str) -> Microphone:
    """Build the microphone over the plate.

    Raises
    ------
    ParameterError
        If it lies in or behind the plate, or its floor cannot reflect what it hears.

    Examples
    --------
    >>> steel = Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> a_microphone({"position_m": [0, 0, 1]}, steel, "microphone").position
    (0.0, 0.0, 1.0)
    """
    refuse_unknown(table, {"position_m", "floor"}, where)
    x, y, z = a_vector(table, "position_m", 3, where)
    if z < 0.01:
        inside = abs(x) <= plate.length / 2 and abs(y) <= plate.width / 2 and z >= -plate.thickness
        if inside:
            place = "inside the plate or all but on it"
        else:
            place = "level with the plate's surface or behind it"
        raise ParameterError(
            f"{where}: position_m = [{x:g}, {y:g}, {z:g}] is {place}; "
            "its z must be at least 0.01 m above the plate"
        )
    microphone = Microphone((x, y, z), _floor(table["floor"], where) if "floor" in table else None)
    try:
        microphone.images(plate)
    except ParameterError as error:
        raise ParameterError(f"{where}, {error}") from None
    return microphone


def _floor(value: Any, where: str) -> Floor:
    table = a_table(value, "floor", where)
    where = f"{where}, floor"
    refuse_unknown(table, {"normal", "position_m", "reflection"}, where)
    normal = a_text(table.get("normal"), "normal", where)
    if normal not in ("x", "y", "z"):
        raise ParameterError(f'{where}: normal = {normal!r} must be "x", "y" or "z"')
    reflection = {"reflection": table.get("reflection", 1.0)}
    return Floor(
        normal,
        a_number(table, "position_m", where, low=-math.inf),
        a_number(reflection, "reflection", where, low=-1.0, high=1.0, closed=True),
    )


def _loss_factor(table: Mapping[str, Any], where: str) -> float | tuple[tuple[float, float], ...]:
    given = table.get("loss_factor")
    if not isinstance(given, Mapping):
        return a_number(table, "loss_factor", where, high=1.0)
    if not given:
        raise ParameterError(f"{where}: loss_factor is empty")
    losses = []
    for key in given:
        try:
            frequency = float(key)
        except ValueError:
            frequency = math.nan
        if not 0.0 < frequency < math.inf:
            raise ParameterError(
                f"{where}: loss_factor has the entry {key!r}; entries are frequencies in Hz above 0"
            )
        losses.append((frequency, a_number(given, key, f"{where}, loss_factor", high=1.0)))
    losses.sort()
    if len({frequency for frequency, _ in losses}) < len(losses):
        raise ParameterError(f"{where}: loss_factor has two entries for the same frequency")
    return tuple(losses)


def _edges(value: Any, where: str) -> str | tuple[str, str, str, str]:
    sides = [value] * 4 if isinstance(value, str) else value
    if not (isinstance(sides, list) and len(sides) == 4 and all(side in EDGES for side in sides)):
        raise ParameterError(
            f"{where}: edges = {value!r} must be one of {', '.join(EDGES)}, or a list of four "
            "of them"
        )
    return value if isinstance(value, str) else (sides[0], sides[1], sides[2], sides[3])
