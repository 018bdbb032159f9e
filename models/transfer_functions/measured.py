"""Responses measured on the user's own rig, in place of those of modelled structure and plate.

An entry of a rig file names a support and the file of its response from the torque that the
bushing puts into clamp and beams, bushing removed, to the acceleration, to the sound, or both.
What is not given stays modelled, as does all that the pulses of the anchors excite.

A response must be usable from 100 to 5000 Hz: slips repeat above 100 Hz where they sound as a tone,
the clamp on its beams resonates at 140 Hz and above, and a torque that breaks loose has nothing
left to say at 5 kHz. What it lacks beyond is filled as `models.transfer_functions.causal` argues,
below by the square of frequency, above by the least that causality admits, and said in a warning.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from models.checks import a_support, a_table, a_text, refuse_unknown
from models.errors import ParameterError
from models.rig import HIGHEST_PLATE_FREQUENCY
from models.transfer_functions.causal import causal_impulse_response
from models.transfer_functions.files import read_frf
from models.transfer_functions.transfer_function import (
    Frf,
    check_band,
    check_units,
    same_unit,
    trusted_band,
)

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from models.radiation.impulse_responses import Response

__all__ = ["MeasuredResponse", "measured_impulse_response", "measured_responses", "with_measured"]

LOWEST, HIGHEST = 100.0, 5000.0
"""Band that a measured response must span [Hz]."""

BAND = 0.45
"""Share of the sampling rate up to which lines are used, as modes are."""

LARGEST_MISFIT = 0.5
"""Share of a response that may come before its cause; more is no noise but an error of sign."""

SAME_SUPPORT = 1e-3
"""Relative difference up to which two support stiffnesses are the same."""

_OUTPUTS = {"torque_to_acceleration": "m/s^2", "torque_to_pressure": "Pa"}


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """What was measured with one support.

    Parameters
    ----------
    support_stiffness : float
        [Nm/rad], or `models.condition.FIXED`.
    torque_to_acceleration, torque_to_pressure : Frf, optional
        [m/s2 and Pa per Nm]; None where it was not measured.

    Examples
    --------
    >>> MeasuredResponse(2214.0).torque_to_pressure is None
    True
    """

    support_stiffness: float
    torque_to_acceleration: Frf | None = None
    torque_to_pressure: Frf | None = None


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
        if any(_same(entry.support_stiffness, other.support_stiffness) for other in entries[:i]):
            raise ParameterError(
                f"{where}, measured_response {i + 1}: support_stiffness_Nm_rad = "
                f"{entry.support_stiffness:g} has an entry already; give one a support"
            )
    return entries


def with_measured(
    modelled: Response, measured: tuple[MeasuredResponse, ...], support_stiffness: float
) -> Response:
    """Put the measured responses of a support in place of the modelled ones.

    Parameters
    ----------
    modelled : Response
    measured : tuple of MeasuredResponse
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`; where nothing was measured with it, `modelled` is
        returned as it is.

    Raises
    ------
    ParameterError
        A response cannot be made causal.

    Warns
    -----
    UserWarning
        A response that ends within the band that the model fills, with the band it has; or
        nothing was measured with this support, but with others.

    Examples
    --------
    >>> from models.radiation.impulse_responses import Response
    >>> chain = Response(48e3, np.ones(9), np.ones(9), np.ones(9), np.ones(9))
    >>> with_measured(chain, (), 2214.0) is chain
    True
    """
    for entry in measured:
        if not _same(entry.support_stiffness, support_stiffness):
            continue
        rate = modelled.rate
        acceleration, pressure = modelled.torque_to_acceleration, modelled.torque_to_pressure
        if (frf := entry.torque_to_acceleration) is not None:
            acceleration = measured_impulse_response(frf, rate, acceleration.size)
        if (frf := entry.torque_to_pressure) is not None:
            pressure = measured_impulse_response(frf, rate, pressure.size)
        return replace(modelled, torque_to_acceleration=acceleration, torque_to_pressure=pressure)
    if measured:
        known = ", ".join(_named(entry.support_stiffness) for entry in measured)
        warnings.warn(
            f"no response was measured with the support {_named(support_stiffness)}, only with "
            f"{known}; it is modelled",
            stacklevel=2,
        )
    return modelled


@lru_cache(maxsize=16)
def measured_impulse_response(frf: Frf, rate: float, n_samples: int) -> NDArray[np.float64]:
    """Impulse response of a measured response, nil before time zero.

    Parameters
    ----------
    frf : Frf
        Lines count as far as their coherence goes; those outside its trusted band are left out.
    rate : float
        Sampling rate [Hz].
    n_samples : int

    Returns
    -------
    ndarray, shape (n_samples,)
        For convolution with samples; read-only.

    Raises
    ------
    ParameterError
        More than half of the response comes before its cause.

    Warns
    -----
    UserWarning
        The response ends below 16 kHz, up to which plates are modelled, and what the rate carries.

    Examples
    --------
    >>> f = np.arange(10.0, 5001.0, 10.0)
    >>> pure_delay = Frf(f, np.exp(-2j * np.pi * f * 1e-3), None, "N m", "Pa")
    >>> h = measured_impulse_response(pure_delay, 10e3, 500)
    >>> int(np.argmax(h)), round(float(h.max()), 1)
    (10, 0.9)
    """
    first, last = trusted_band(frf)
    top = min(last, BAND * rate)
    inside = (frf.frequency >= first) & (frf.frequency <= top)
    wanted = min(BAND * rate, HIGHEST_PLATE_FREQUENCY)
    if last < wanted:
        warnings.warn(
            f"{frf.name}: measured from {first:.5g} to {last:.5g} Hz; what lies above, up to "
            f"{wanted:.5g} Hz, is missing from the simulated "
            f"{'sound' if same_unit(frf.output_unit, 'Pa') else 'acceleration'}",
            stacklevel=2,
        )
    weight = np.ones(frf.frequency.size) if frf.coherence is None else frf.coherence
    response, misfit = causal_impulse_response(
        frf.frequency[inside], frf.response[inside], weight[inside], rate, n_samples
    )
    if misfit > LARGEST_MISFIT:
        raise ParameterError(
            f"{frf.name}: {100 * misfit:.0f} % of the response comes before its cause; the phase "
            "must be that of exp(+i omega t), and both signals must start at the same time"
        )
    response.flags.writeable = False  # shared by all that ask for the same response
    return response


def _entry(table: Any, folder: Path, where: str) -> MeasuredResponse:
    table = a_table(table, "measured_response", where)
    refuse_unknown(table, {"support_stiffness_Nm_rad", *_OUTPUTS}, where)
    support = _support(table, where)
    given = {key: _frf(table, key, folder, where) for key in _OUTPUTS if key in table}
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


def _frf(table: Mapping[str, Any], key: str, folder: Path, where: str) -> Frf:
    path = folder / a_text(table[key], key, where)
    try:
        frf = read_frf(path, input_unit="N m", output_unit=_OUTPUTS[key])
        check_units(frf, "N m", _OUTPUTS[key])
        check_band(frf, LOWEST, HIGHEST)
    except ParameterError as error:
        raise ParameterError(f"{where}: {key}: {error}") from None
    return frf


def _named(support_stiffness: float) -> str:
    return "fixed" if math.isinf(support_stiffness) else f"{support_stiffness:g} Nm/rad"


def _same(one: float, other: float) -> bool:
    return one == other or math.isclose(one, other, rel_tol=SAME_SUPPORT)
