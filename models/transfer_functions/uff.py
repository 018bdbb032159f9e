"""Functions in universal files (dataset 58), read and written through pyuff.

The format keeps the step of an even axis with six digits: 1/51200 s reads back as 51199.87 Hz. A
step is therefore taken to be that of the whole number of hertz, or the whole fraction of a hertz,
which rounds to the digits stored, where there is one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import ParameterError, not_installed
from models.foreign_file import LARGEST_TEXT, reading

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = [
    "COHERENCE",
    "FREQUENCY_RESPONSE",
    "TIME_RESPONSE",
    "UFF_ENDINGS",
    "UffFunction",
    "check_uff_library",
    "read_uff_functions",
    "write_uff_functions",
]

UFF_ENDINGS = (".uff", ".unv")

TIME_RESPONSE, FREQUENCY_RESPONSE, COHERENCE = 1, 4, 6
"""Function types of dataset 58."""

_DATA_TYPES = {
    "": 0,
    "Pa": 15,
    "m/s^2": 12,
    "N": 13,
    "N m": 13,
}
"""Specific data type by unit; others are 1, general."""

_TIME, _FREQUENCY = 17, 18
_DIGITS = 0.51e-5  # half a unit of the sixth digit, relative to the first
_ROTATION = 4  # of the reference's direction: about x


@dataclass(frozen=True, eq=False)
class UffFunction:
    """One function of a universal file.

    Parameters
    ----------
    kind : int
        Function type: `TIME_RESPONSE`, `FREQUENCY_RESPONSE`, `COHERENCE` or another one.
    x : ndarray, shape (n,)
        Abscissa: time [s] or frequency [Hz].
    y : ndarray, shape (n,)
        Ordinate, real or complex [`unit`].
    unit, denominator_unit : str
        Unit labels of the ordinate; empty where there are none.
    name : str
        First ID line.
    data_type : int
        Specific data type of the ordinate (12 acceleration, 13 excitation force, 15 pressure ...).
    """

    kind: int
    x: NDArray[np.float64]
    y: NDArray[np.float64] | NDArray[np.complex128]
    unit: str
    denominator_unit: str = ""
    name: str = ""
    data_type: int = 0


def check_uff_library(path: Path) -> None:
    """Refuse to begin what could not be read or written for want of the library.

    Raises
    ------
    ParameterError
        pyuff is not installed.
    """
    _pyuff(path)


def read_uff_functions(path: Path) -> list[UffFunction]:
    """Read all functions (dataset 58, text or binary) of a universal file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    list of UffFunction
        At least one, in the order of the file.

    Raises
    ------
    ParameterError
        pyuff is not installed, the file is damaged, or holds no function.
    """
    pyuff = _pyuff(path)
    with reading(path, "universal file", largest=LARGEST_TEXT):
        file = pyuff.UFF(str(path))
        wanted = [i for i, kind in enumerate(file.get_set_types()) if kind == 58]
        sets = [file.read_sets(i) for i in wanted]
        functions = [_function(data) for data in sets]
    if not functions:
        raise ParameterError(f"{path}: is no universal file, or holds no function (dataset 58)")
    return functions


def write_uff_functions(path: Path, functions: Iterable[UffFunction]) -> None:
    """Write functions as datasets 58 in text, twelve digits a value.

    The binary form is smaller, but the library announces half the bytes of a complex function,
    which other readers go by.

    Parameters
    ----------
    path : Path
        A file that does not exist yet.
    functions : iterable of UffFunction

    Raises
    ------
    ParameterError
        pyuff is not installed.
    """
    file = _pyuff(path).UFF(str(path))
    for function in functions:
        file.write_sets(_dataset(function), mode="add", force_double=True)


def _pyuff(path: Path) -> Any:
    try:
        import pyuff
    except ImportError:
        raise ParameterError(
            not_installed(f"{path}: universal files need", "pyuff", "uff")
        ) from None
    return pyuff


def _function(data: dict[str, Any]) -> UffFunction:
    y = np.asarray(data["data"])
    x: NDArray[np.float64] = np.asarray(data["x"], dtype=np.float64)
    if int(data["abscissa_spacing"]) == 1:
        start, step = _whole(float(data["abscissa_min"])), _whole(float(data["abscissa_inc"]))
        x = (start + step * np.arange(y.size)).astype(np.float64)
    if x.shape != y.shape or y.size != int(data["num_pts"]):
        raise ValueError(f"{data['num_pts']} values announced, {y.size} found")
    return UffFunction(
        kind=int(data["func_type"]),
        x=x,
        y=y.astype(np.complex128) if np.iscomplexobj(y) else y.astype(np.float64),
        unit=_label(data["ordinate_axis_units_lab"]),
        denominator_unit=_label(data["orddenom_axis_units_lab"]),
        name=_label(data["id1"]),
        data_type=int(data["ordinate_spec_data_type"]),
    )


def _label(text: object) -> str:
    plain = str(text).strip()
    return "" if plain.upper() == "NONE" else plain


def _whole(step: float) -> float:
    """Undo the rounding to six digits of a step that is, or divides, a whole number."""
    if step <= 0.0 or not math.isfinite(step):
        return step
    slack = _DIGITS * 10.0 ** math.floor(math.log10(step))
    divisor = round(1.0 / step)
    return 1.0 / divisor if divisor > 0 and abs(1.0 / divisor - step) <= slack else step


def _dataset(function: UffFunction) -> dict[str, Any]:
    n = function.x.size
    spectral = function.kind != TIME_RESPONSE
    step = float((function.x[-1] - function.x[0]) / (n - 1))
    even = np.allclose(np.diff(function.x), step, rtol=1e-6, atol=0.0)
    rotation = function.denominator_unit == "N m"
    data: dict[str, Any] = {
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
        "abscissa_spec_data_type": _FREQUENCY if spectral else _TIME,
        "abscissa_axis_lab": "frequency" if spectral else "time",
        "abscissa_axis_units_lab": "Hz" if spectral else "s",
        "ordinate_spec_data_type": _DATA_TYPES.get(function.unit, 1),
        "ordinate_axis_units_lab": function.unit or "NONE",
        "orddenom_spec_data_type": _DATA_TYPES.get(function.denominator_unit, 1),
        "orddenom_axis_units_lab": function.denominator_unit or "NONE",
    }
    return data
