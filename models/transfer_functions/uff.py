"""Reading and writing of functions in universal files (dataset 58) by pyuff.

Values are read in SI. The unit follows from the axis' label or, without one, from its specific data
type and the units of the file (dataset 164). Contradictory statements are reported, not resolved.

The format stores the step of an even axis with six digits: 1/51200 s reads back as 51199.87 Hz. So
a step is snapped to the integer rate, or integer fraction of a hertz, that rounds to the stored
digits.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, not_installed
from models.foreign_file import LARGEST_TEXT, reading
from models.units import SI_UNITS, quantity_of_unit, split_ratio

UFF_ENDINGS = (".uff", ".unv")

TIME_RESPONSE, FREQUENCY_RESPONSE, COHERENCE = 1, 4, 6
"""Function types of dataset 58."""

_DATA_TYPES = {"": 0, "Pa": 15, "m/s^2": 12, "N": 13, "N m": 13}
"""Specific data type by unit; 1 (general) for others."""

_TIME, _FREQUENCY = 17, 18
_DIGITS = 0.51e-5  # half a unit of the sixth digit, relative to the first
_ROTATION = 4  # first rotational direction: about x

_QUANTITIES = {
    8: ("displacement", "angle"),
    9: ("force", "torque"),
    11: ("velocity", "speed"),
    12: ("acceleration", "angular acceleration"),
    13: ("force", "torque"),
    15: ("pressure", "pressure"),
    _TIME: ("time", "time"),
    _FREQUENCY: ("frequency", "frequency"),
}
"""Quantity of a specific data type along and about a direction."""

_LENGTH_AND_FORCE = {
    "displacement": (1, 0),
    "velocity": (1, 0),
    "acceleration": (1, 0),
    "force": (0, 1),
    "torque": (1, 1),
    "pressure": (-2, 1),
}
"""Exponents of the file's units of length and force in the unit of a quantity."""

_LOST_SIGNS = "²µ°·"
"""Signs in labels that may be in another encoding than UTF-8."""

_FILLER = 6
"""Surplus values allowed at the end of the last line of a text."""


@dataclass(frozen=True, eq=False)
class UffFunction:
    """Function of a universal file.

    Parameters
    ----------
    kind : int
        Function type: `TIME_RESPONSE`, `FREQUENCY_RESPONSE`, `COHERENCE` or another one.
    x : ndarray, shape (n,)
        Abscissa: time [s] or frequency [Hz].
    y : ndarray, shape (n,)
        Ordinate, real or complex [`unit`].
    unit, denominator_unit : str
        Units of the ordinate: in SI, else the file's label; empty if not stated.
    name : str
        First ID line.
    unclear : str
        Contradiction in the file about the ordinate's unit; empty if there is none.
    """

    kind: int
    x: NDArray[np.float64]
    y: NDArray[np.float64] | NDArray[np.complex128]
    unit: str
    denominator_unit: str = ""
    name: str = ""
    unclear: str = ""


def read_uff_functions(path: Path, *kinds: int) -> list[UffFunction]:
    """Read functions (dataset 58, text or binary) from a universal file.

    Parameters
    ----------
    path : Path
    *kinds : int
        Function types to read; others are skipped.

    Returns
    -------
    list of UffFunction
        In the order of the file.

    Raises
    ------
    ParameterError
        pyuff is not installed, the file is damaged or has no functions, or an abscissa is neither
        time nor, for a spectrum, frequency.
    """
    pyuff = uff_library(path)
    with reading(path, "universal file", largest=LARGEST_TEXT):
        file = pyuff.UFF(str(path))
        types = [int(kind) for kind in file.get_set_types()]
        if 58 not in types:
            raise ParameterError(f"{path}: is no universal file, or holds no function (dataset 58)")
        units: Mapping[str, float] = {}
        functions = []
        for number, kind in enumerate(types):
            if kind == 164:
                units = file.read_sets(number)
            elif kind == 58:
                data = file.read_sets(number)
                if int(data["func_type"]) in kinds:
                    functions.append(_function(data, units, path))
    return functions


def write_uff_functions(path: Path, functions: Iterable[UffFunction]) -> None:
    """Write functions of frequency as datasets 58 in text, with twelve digits per value.

    The binary form is smaller, but the library announces half the bytes of a complex function,
    which other readers rely on.

    Parameters
    ----------
    path : Path
        A new file.
    functions : iterable of UffFunction

    Raises
    ------
    ParameterError
        pyuff is not installed.
    """
    file = uff_library(path).UFF(str(path))
    for function in functions:
        file.write_sets(_dataset(function), mode="add", force_double=True)


def uff_library(path: Path) -> Any:
    """Return the module pyuff.

    Raises
    ------
    ParameterError
        pyuff is not installed.
    """
    try:
        import pyuff
    except ImportError:
        raise ParameterError(
            not_installed(f"{path}: universal files need", "pyuff", "uff")
        ) from None
    return pyuff


def _function(data: Mapping[str, Any], units: Mapping[str, float], path: Path) -> UffFunction:
    kind, name = int(data["func_type"]), _label(data["id1"])
    y, n = np.asarray(data["data"]), int(data["num_pts"])
    axis = "time" if kind == TIME_RESPONSE else "frequency"
    unit, factor, unclear = _unit(data, "abscissa", {})
    if (typed := int(data["abscissa_spec_data_type"])) not in (0, 1, _TIME, _FREQUENCY):
        unclear = f"data type {typed}"
    if unclear or (unit or SI_UNITS[axis]) != SI_UNITS[axis]:
        raise ParameterError(
            f"{path}: function {name!r} goes over {unclear or unit}, expected {axis} in "
            f"{SI_UNITS[axis]}"
        )
    if not n <= y.size < n + _FILLER:
        raise ValueError(f"{n} values announced, {y.size} found")
    y = y[:n]
    x: NDArray[np.float64] = factor * np.asarray(data["x"], dtype=np.float64)[:n]
    if int(data["abscissa_spacing"]) == 1:
        start, step = factor * data["abscissa_min"], _whole(factor * data["abscissa_inc"])
        x = (start + step * np.arange(n)).astype(np.float64)
    unit, factor, unclear = _unit(data, "ordinate", units)
    per_unit, per_factor, per_unclear = _unit(data, "orddenom", units)
    output, per = split_ratio(unit)
    if kind == FREQUENCY_RESPONSE and per:  # both in one label
        unit, per_unit, per_factor = output, per, 1.0
    if kind != COHERENCE:
        y = (factor / per_factor) * y
    return UffFunction(
        kind=kind,
        x=x,
        y=y.astype(np.complex128) if np.iscomplexobj(y) else y.astype(np.float64),
        unit=unit,
        denominator_unit=per_unit,
        name=name,
        unclear=unclear or per_unclear,
    )


def _unit(data: Mapping[str, Any], axis: str, units: Mapping[str, float]) -> tuple[str, float, str]:
    """Return an axis' unit, its size, and any contradiction in the file.

    The unit is in SI if known, else the label; empty if not stated.
    """
    label = _label(data[f"{axis}_axis_units_lab"])
    about = abs(int(data.get("ref_dir" if axis == "orddenom" else "rsp_dir") or 0)) >= _ROTATION
    typed = _QUANTITIES.get(int(data[f"{axis}_spec_data_type"]), ())
    spellings = (label.replace("\ufffd", sign) for sign in _LOST_SIGNS)
    labelled = next(filter(None, map(quantity_of_unit, spellings)), None)
    if labelled is None and (label or not typed):
        return label, 1.0, ""
    quantity, factor = labelled or (typed[about], math.nan)
    if quantity not in SI_UNITS:
        return "", 1.0, ""
    of_file = factor if labelled else 1.0
    if units and quantity in _LENGTH_AND_FORCE:
        length, force = _LENGTH_AND_FORCE[quantity]
        of_file = float(units["length"]) ** -length * float(units["force"]) ** -force
    unclear = ""
    if labelled and typed and quantity not in typed:
        unclear = f"{label!r}, but has the data type of {typed[about]}"
    elif labelled and not math.isclose(of_file, factor, rel_tol=1e-3):
        unclear = (
            f"{label!r}, but by the units of the file (dataset 164) 1 is {of_file:g} "
            f"{SI_UNITS[quantity]}"
        )
    return SI_UNITS[quantity], of_file, unclear


def _label(text: object) -> str:
    plain = str(text).strip()
    return "" if plain.upper() == "NONE" else plain


def _whole(step: float) -> float:
    """Return a step without the rounding to six digits, if its reciprocal is an integer."""
    if step <= 0.0 or not math.isfinite(step):
        return step
    slack = _DIGITS * 10.0 ** math.floor(math.log10(step))
    divisor = round(1.0 / step)
    return 1.0 / divisor if divisor > 0 and abs(1.0 / divisor - step) <= slack else step


def _dataset(function: UffFunction) -> dict[str, Any]:
    n = function.x.size
    step = float((function.x[-1] - function.x[0]) / (n - 1))
    even = np.allclose(np.diff(function.x), step, rtol=1e-6, atol=0.0)
    rotation = function.denominator_unit == "N m"
    return {
        "type": 58,
        "binary": 0,
        "func_type": function.kind,
        "id1": function.name[:80] or "NONE",
        "rsp_node": 1,
        "rsp_dir": 0 if function.unit in ("", "Pa") else 3,
        "ref_node": 2 if function.denominator_unit else 0,
        "ref_dir": (_ROTATION if rotation else 3) if function.denominator_unit else 0,
        "data": function.y,
        "x": function.x,
        "abscissa_spacing": int(even),
        "abscissa_min": float(function.x[0]),
        "abscissa_inc": step,
        "abscissa_spec_data_type": _FREQUENCY,
        "abscissa_axis_lab": "frequency",
        "abscissa_axis_units_lab": "Hz",
        "ordinate_spec_data_type": _DATA_TYPES.get(function.unit, 1),
        "ordinate_axis_units_lab": function.unit or "NONE",
        "orddenom_spec_data_type": _DATA_TYPES.get(function.denominator_unit, 1),
        "orddenom_axis_units_lab": function.denominator_unit or "NONE",
    }
