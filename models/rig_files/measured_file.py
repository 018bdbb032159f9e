"""The ``[[measured_response]]`` entries of a rig file, with the files that they name.

An entry names a support and the file of its response from the torque that the bushing puts into
clamp and beams, bushing removed, to the acceleration, to the sound, or both.

A response must be usable from 100 to 5000 Hz: slips repeat above 100 Hz where they sound as a tone,
the clamp on its beams resonates at 140 Hz and above, and a torque that breaks loose has nothing
left to say at 5 kHz.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from models.checks import a_support, a_table, a_text, refuse_unknown
from models.errors import ParameterError
from models.transfer_functions.coherence import check_band
from models.transfer_functions.files import read_transfer_function
from models.transfer_functions.measured import MeasuredResponse, measured_with

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from models.transfer_functions.transfer_function import TransferFunction

__all__ = ["measured_responses"]

LOWEST, HIGHEST = 100.0, 5000.0
"""Band that a measured response must span [Hz]."""

_OUTPUTS = {"torque_to_acceleration": "m/s^2", "torque_to_pressure": "Pa"}


def measured_responses(tables: Any, folder: Path, where: str) -> tuple[MeasuredResponse, ...]:
    """Read what the ``[[measured_response]]`` entries of a rig file name.

    Parameters
    ----------
    tables : list of mapping
        As the TOML file holds them.
    folder : Path
        Of the rig file; names of files are relative to it.
    where : str
        What messages call the rig file.

    Raises
    ------
    ParameterError
        An entry, or a file that it names, cannot be used.

    Examples
    --------
    >>> from pathlib import Path
    >>> measured_responses([{"torque_to_pressure": "a.npz"}], Path("."), "rig file r.toml")
    Traceback (most recent call last):
    models.errors.ParameterError: rig file r.toml, measured_response 1: support_stiffness_Nm_rad ...
    """
    if not isinstance(tables, list):
        raise ParameterError(
            f"{where}: measured_response must be given as [[measured_response]] tables"
        )
    entries = tuple(
        _entry(table, folder, f"{where}, measured_response {i}")
        for i, table in enumerate(tables, 1)
    )
    for i, entry in enumerate(entries):
        if measured_with(entries[:i], entry.support_stiffness) is not None:
            raise ParameterError(
                f"{where}, measured_response {i + 1}: support_stiffness_Nm_rad = "
                f"{entry.support_stiffness:g} has an entry already; give one a support"
            )
    return entries


def _entry(table: Any, folder: Path, where: str) -> MeasuredResponse:
    table = a_table(table, "measured_response", where)
    refuse_unknown(table, {"support_stiffness_Nm_rad", *_OUTPUTS}, where)
    support = _support(table, where)
    given = {key: _transfer_function(table, key, folder, where) for key in _OUTPUTS if key in table}
    if not given:
        raise ParameterError(f"{where}: names no response; give {' or '.join(_OUTPUTS)}")
    return MeasuredResponse(support, **given)


def _support(table: Mapping[str, Any], where: str) -> float:
    value = table.get("support_stiffness_Nm_rad")
    if value is None or isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ParameterError(
            f'{where}: support_stiffness_Nm_rad = {value!r} must be a number in Nm/rad, or "fixed"'
        )
    return a_support(str(value), "support_stiffness_Nm_rad", where)


def _transfer_function(
    table: Mapping[str, Any], key: str, folder: Path, where: str
) -> TransferFunction:
    path = folder / a_text(table[key], key, where)
    try:
        transfer = read_transfer_function(path, input_unit="N m", output_unit=_OUTPUTS[key])
        check_band(transfer, LOWEST, HIGHEST)
    except ParameterError as error:
        raise ParameterError(f"{where}: {key}: {error}") from None
    return transfer
