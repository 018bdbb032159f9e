"""Reading, checking and writing of transfer functions: NPZ, CSV and universal files by ending.

NPZ: ``frequency_hz``, ``response`` (complex), ``coherence`` (optional), ``input_unit``,
``output_unit``. CSV: columns ``frequency_hz, real, imag`` and optionally ``coherence``; units may
be stated in the headings, ``real (m/s^2/N)``, and are otherwise those that the reader expects.
Universal files (dataset 58) contain a frequency response, and its coherence as a separate function.
In every format lines must rise, numbers must be finite, and units are converted to the requested
ones.
"""

import csv
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.foreign_file import LARGEST_TEXT, read_arrays, read_table, reading
from models.transfer_functions.transfer_function import TransferFunction
from models.transfer_functions.uff import (
    COHERENCE,
    FREQUENCY_RESPONSE,
    UFF_ENDINGS,
    UffFunction,
    read_uff_functions,
    uff_library,
    write_uff_functions,
)
from models.units import quantity_of_unit, split_ratio

FEWEST_LINES = 8
"""Fewest lines of a response; fewer describe no resonance."""

_MOTION = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""Order of the time derivative of a motion."""

_LARGEST = 1e15
"""Largest magnitude of a response, in any unit, and of a frequency [Hz]."""

_LEAST_STEP = 1e-9
"""Least spacing of lines over the highest frequency [-]; less is lost in rounding."""


def check_transfer_function(transfer: TransferFunction) -> TransferFunction:
    """Return a response unchanged, or raise if it is unusable.

    Raises
    ------
    ParameterError
        Shapes do not fit, values are not finite, lines do not rise, a coherence lies outside 0 to
        1, or all values are zero.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> falling = TransferFunction(np.arange(9.0)[::-1], np.ones(9) + 0j, name="hit.csv")
    >>> check_transfer_function(falling)
    Traceback (most recent call last):
    models.errors.ParameterError: hit.csv: frequency_hz falls from 8 to 7 Hz at line 2; it must rise
    """
    f, name = transfer.frequencies, transfer.name
    if f.ndim != 1 or f.size < FEWEST_LINES:
        raise ParameterError(
            f"{name}: frequency_hz has shape {f.shape}; it must be at least {FEWEST_LINES} "
            "frequencies in a row"
        )
    coherence = np.ones(f.size) if transfer.coherence is None else transfer.coherence
    columns = {"frequency_hz": f, "response": transfer.response, "coherence": coherence}
    for key, values in columns.items():
        if values.shape != f.shape:
            raise ParameterError(
                f"{name}: {key} has shape {values.shape}, frequency_hz {f.shape}; they must be "
                "alike"
            )
        possible = np.abs(values) < _LARGEST  # False for NaN
        if not possible.all():
            first = int(np.argmin(possible))
            raise ParameterError(
                f"{name}: {key} is {values[first]} at line {first + 1}; it must be finite, and "
                f"below {_LARGEST:g}"
            )
    if f[0] < 0.0:
        raise ParameterError(f"{name}: frequency_hz starts at {f[0]:g} Hz; it must be 0 or more")
    steps = np.diff(f)
    rising = steps > _LEAST_STEP * f[-1]
    if not rising.all():
        first = int(np.argmin(rising))
        verb = "stays at" if steps[first] >= 0 else f"falls from {f[first]:g} to"
        raise ParameterError(
            f"{name}: frequency_hz {verb} {f[first + 1]:g} Hz at line {first + 2}; it must rise"
        )
    if not (coherence.min() >= 0.0 and coherence.max() <= 1 + 1e-9):
        raise ParameterError(
            f"{name}: coherence goes from {coherence.min():g} to {coherence.max():g}; it must lie "
            "between 0 and 1"
        )
    if not transfer.response.any():
        raise ParameterError(f"{name}: response is zero throughout")
    return transfer


def in_units(transfer: TransferFunction, input_unit: str, output_unit: str) -> TransferFunction:
    """Convert a response to other units of the same quantities, and motion to acceleration.

    A displacement per force (receptance) becomes an accelerance by the factor -(2 pi f)^2, a
    velocity (mobility) by 2 pi i f.

    Parameters
    ----------
    transfer : TransferFunction
    input_unit, output_unit : str
        Requested units.

    Returns
    -------
    TransferFunction
        In the requested units.

    Raises
    ------
    ParameterError
        A unit is unknown, or belongs to another quantity.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.arange(9.0)
    >>> mobility = TransferFunction(f, np.ones(9) + 0j, None, "kN", "m/s")
    >>> in_units(mobility, "N", "m/s^2").response[1].round(5)
    np.complex128(0.00628j)
    """
    factors = []
    for key, stated, wanted in (
        ("input_unit", transfer.input_unit, input_unit),
        ("output_unit", transfer.output_unit, output_unit),
    ):
        (have, value), (want, unit) = (quantity_of_unit(u) or ("", 1.0) for u in (stated, wanted))
        times = _MOTION.get(want, 0) - _MOTION.get(have, 0) if key == "output_unit" else 0
        moved = times > 0 and {have, want} <= set(_MOTION)
        if not have or (have != want and not moved):
            raise ParameterError(f"{transfer.name}: {key} is {stated!r}; it must be {wanted!r}")
        rise = (2j * np.pi * transfer.frequencies) ** times if moved else 1.0
        factors.append(np.asarray(value / unit * rise))
    return replace(
        transfer,
        response=np.asarray(factors[1] / factors[0] * transfer.response),
        input_unit=input_unit,
        output_unit=output_unit,
    )


ENDINGS = (".npz", ".csv", *UFF_ENDINGS)
"""Endings of the supported formats."""

_WHATS = {".npz": "NPZ file", ".csv": "CSV table", **dict.fromkeys(UFF_ENDINGS, "universal file")}
"""Name of the format in messages, by ending."""


def check_transfer_function_path(path: Path) -> None:
    """Raise if a path has no known format, or its library is not installed.

    Raises
    ------
    ParameterError

    Examples
    --------
    >>> from pathlib import Path
    >>> check_transfer_function_path(Path("hammer.mat"))
    Traceback (most recent call last):
    models.errors.ParameterError: hammer.mat: responses end in .npz, .csv, .uff or .unv
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise ParameterError(f"{path}: responses end in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}")
    if ending in UFF_ENDINGS:
        uff_library(path)


def read_transfer_function(path: Path, *, input_unit: str, output_unit: str) -> TransferFunction:
    """Read a transfer function.

    Parameters
    ----------
    path : Path
    input_unit, output_unit : str
        Requested units, assumed for the file if it states none.

    Returns
    -------
    TransferFunction
        In the requested units.

    Raises
    ------
    ParameterError
        The file cannot be read, or its content cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> f = np.arange(1.0, 11.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "beam.npz"
    ...     write_transfer_function(path, TransferFunction(f, 1j * f, None, "N m", "m/s^2"))
    ...     read_transfer_function(path, input_unit="N m", output_unit="m/s^2").response[1]
    np.complex128(2j)
    """
    check_transfer_function_path(path)
    ending = path.suffix.lower()
    with reading(path, _WHATS[ending], largest=LARGEST_TEXT):
        if ending == ".npz":
            transfer = _read_npz(path)
        elif ending == ".csv":
            transfer = _read_csv(path, input_unit, output_unit)
        else:
            transfer = _read_uff(path, input_unit, output_unit)
        return in_units(check_transfer_function(transfer), input_unit, output_unit)


def write_transfer_function(path: Path, transfer: TransferFunction) -> None:
    """Write a transfer function in the format of the ending.

    Parameters
    ----------
    path : Path
        A new file in an existing folder.
    transfer : TransferFunction

    Raises
    ------
    ParameterError
        The ending is unknown, or the library of the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> f = np.arange(1.0, 11.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "torque_to_acceleration.npz"
    ...     write_transfer_function(path, TransferFunction(f, 1j * f, None, "N m", "m/s^2"))
    ...     read_transfer_function(path, input_unit="N m", output_unit="m/s^2").spacing
    1.0
    """
    check_transfer_function_path(path)
    f, coherence = transfer.frequencies, transfer.coherence
    ending = path.suffix.lower()
    if ending == ".npz":
        arrays: dict[str, Any] = {"frequency_hz": f, "response": transfer.response}
        arrays |= {"input_unit": transfer.input_unit, "output_unit": transfer.output_unit}
        arrays["coherence"] = coherence
        np.savez(path, **{key: array for key, array in arrays.items() if array is not None})
    elif ending == ".csv":
        with path.open("w", encoding="utf-8", newline="") as file:
            write_transfer_function_csv(file, transfer)
    else:
        output, per = transfer.output_unit, transfer.input_unit
        response = transfer.response
        functions = [
            UffFunction(FREQUENCY_RESPONSE, f, response, output, per, "frequency response")
        ]
        if coherence is not None:
            functions.append(UffFunction(COHERENCE, f, coherence, "", "", "coherence"))
        write_uff_functions(path, functions)


def write_transfer_function_csv(file: TextIO, transfer: TransferFunction) -> None:
    """Write a transfer function as CSV to an open file.

    Examples
    --------
    >>> import sys
    >>> f = np.array([1.0, 2.0])
    >>> write_transfer_function_csv(sys.stdout, TransferFunction(f, 1j * f, None, "N m", "m/s^2"))
    frequency_hz,real,imag,coherence
    1.0,0.0,1.0,
    2.0,0.0,2.0,
    """
    f, response, coherence = transfer.frequencies, transfer.response, transfer.coherence
    values = [""] * f.size if coherence is None else coherence.tolist()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(("frequency_hz", "real", "imag", "coherence"))
    lines = zip(f.tolist(), response.real.tolist(), response.imag.tolist(), values, strict=True)
    writer.writerows(lines)


def _read_npz(path: Path) -> TransferFunction:
    arrays = read_arrays(path)
    for key in ("frequency_hz", "response", "input_unit", "output_unit"):
        if key not in arrays:
            raise ParameterError(f"{path}: has no {key}; it holds {', '.join(arrays) or 'nothing'}")
    response, coherence = arrays["response"], arrays.get("coherence")
    if not np.iscomplexobj(response):
        raise ParameterError(f"{path}: response has type {response.dtype}; it must be complex")
    return TransferFunction(
        arrays["frequency_hz"].astype(np.float64),
        response.astype(np.complex128),
        None if coherence is None else coherence.astype(np.float64),
        str(arrays["input_unit"].reshape(()).astype(str)),
        str(arrays["output_unit"].reshape(()).astype(str)),
        str(path),
    )


def _read_csv(path: Path, input_unit: str, output_unit: str) -> TransferFunction:
    table = read_table(path)
    names = [name.lower() for name in table.names]
    columns: dict[str, NDArray[np.float64]] = {}
    units: dict[str, str] = {}
    for name in ("frequency", "real", "imag", "coherence"):
        if name in names:
            number = names.index(name)
            columns[name], units[name] = table.values[:, number], table.units[number]
        elif name != "coherence":
            raise ParameterError(
                f"{path}: has no column {name}; expected frequency_hz, real, imag, coherence"
            )
    quantity, in_hz = quantity_of_unit(units["frequency"] or "Hz") or ("", 1.0)
    if quantity != "frequency" or units["real"] != units["imag"]:
        raise ParameterError(
            f"{path}: columns are in {units}, expected Hz and one unit of real, imag"
        )
    coherence = columns.get("coherence")
    if coherence is not None and np.isnan(coherence).all():
        coherence = None
    output, per = split_ratio(units["real"])
    return TransferFunction(
        in_hz * columns["frequency"],
        columns["real"] + 1j * columns["imag"],
        coherence,
        per or input_unit,
        output or output_unit,
        str(path),
    )


def _read_uff(path: Path, input_unit: str, output_unit: str) -> TransferFunction:
    functions = read_uff_functions(path, FREQUENCY_RESPONSE, COHERENCE)
    responses = [function for function in functions if function.kind == FREQUENCY_RESPONSE]
    if len(responses) > 1:
        wanted = quantity_of_unit(output_unit)
        responses = [each for each in responses if quantity_of_unit(each.unit) == wanted]
    if len(responses) != 1:
        raise ParameterError(
            f"{path}: holds {len(responses)} frequency response functions in {output_unit}; "
            "it must be one"
        )
    (response,) = responses
    if response.unclear:
        raise ParameterError(f"{path}: function {response.name!r} has unit {response.unclear}")
    if not response.unit or not response.denominator_unit:
        warnings.warn(
            f"{path}: does not state all units; missing ones are taken as {output_unit} per "
            f"{input_unit}",
            stacklevel=3,
        )
    coherences = [
        function.y.real
        for function in functions
        if function.kind == COHERENCE and np.array_equal(function.x, response.x)
    ]
    return TransferFunction(
        response.x,
        response.y.astype(np.complex128),
        coherences[0].astype(np.float64) if len(coherences) == 1 else None,
        response.denominator_unit or input_unit,
        response.unit or output_unit,
        str(path),
    )
