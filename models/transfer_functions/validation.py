"""Checks of a transfer function that was read from a file.

They are made here once, whatever the format, so that all that follows may trust it: lines rise,
numbers are finite, units are those asked for or are converted to them. Values are never guessed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.units import quantity_of_unit

if TYPE_CHECKING:
    from models.transfer_functions.transfer_function import TransferFunction

FEWEST_LINES = 8
"""Fewer lines describe no resonance."""

_MOTION = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""Times that a motion is differentiated."""

_LARGEST = 1e15
"""Of a response, in any unit, and of a frequency [Hz]."""

_LEAST_STEP = 1e-9
"""Between two lines, of the highest frequency [-]; less is lost in rounding."""


def check_transfer_function(transfer: TransferFunction) -> TransferFunction:
    """Refuse a response that nothing can be done with.

    Raises
    ------
    ParameterError
        Shapes that do not fit, values that are not finite, lines that do not rise, a coherence
        outside 0 to 1, or nothing but zeros.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> falling = TransferFunction(np.arange(9.0)[::-1], np.ones(9) + 0j, name="hit.csv")
    >>> check_transfer_function(falling)
    Traceback (most recent call last):
    models.errors.ParameterError: hit.csv: frequency_hz falls from 8 to 7 Hz at line 2; it must rise
    """
    f, n = transfer.frequencies, transfer.frequencies.size
    if transfer.frequencies.ndim != 1 or n < FEWEST_LINES:
        raise ParameterError(
            f"{transfer.name}: frequency_hz has shape {f.shape}; it must be at least "
            f"{FEWEST_LINES} frequencies in a row"
        )
    columns = {"frequency_hz": f, "response": transfer.response}
    if transfer.coherence is not None:
        columns["coherence"] = transfer.coherence
    for key, values in columns.items():
        if values.shape != (n,):
            raise ParameterError(
                f"{transfer.name}: {key} has shape {values.shape}, frequency_hz {f.shape}; "
                "they must be alike"
            )
        possible = np.abs(values) < _LARGEST  # no NaN is
        if not possible.all():
            first = int(np.argmin(possible))
            raise ParameterError(
                f"{transfer.name}: {key} is {values[first]} at line {first + 1}; it must be "
                f"finite, and below {_LARGEST:g}"
            )
    if f[0] < 0.0:
        raise ParameterError(
            f"{transfer.name}: frequency_hz starts at {f[0]:g} Hz; it must be 0 or more"
        )
    steps = np.diff(f)
    rising = steps > _LEAST_STEP * f[-1]
    if not rising.all():
        first = int(np.argmin(rising))
        verb = "stays at" if steps[first] >= 0 else f"falls from {f[first]:g} to"
        raise ParameterError(
            f"{transfer.name}: frequency_hz {verb} {f[first + 1]:g} Hz at line {first + 2}; "
            "it must rise"
        )
    coherence = transfer.coherence
    if coherence is not None and not (coherence.min() >= 0.0 and coherence.max() <= 1 + 1e-9):
        raise ParameterError(
            f"{transfer.name}: coherence goes from {coherence.min():g} to {coherence.max():g}; "
            "it must lie between 0 and 1"
        )
    if not transfer.response.any():
        raise ParameterError(f"{transfer.name}: response is zero throughout")
    return transfer


def in_units(transfer: TransferFunction, input_unit: str, output_unit: str) -> TransferFunction:
    """Convert a response to other units of the same quantities; motion becomes acceleration.

    A displacement per force (receptance) becomes an accelerance by the factor -(2 pi f)^2, a
    velocity (mobility) by 2 pi i f.

    Parameters
    ----------
    transfer : TransferFunction
    input_unit, output_unit : str
        Those wanted.

    Returns
    -------
    TransferFunction
        With the units as they are spelled here.

    Raises
    ------
    ParameterError
        A unit is not known, or is that of another quantity.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.arange(9.0)
    >>> mobility = TransferFunction(f, np.ones(9) + 0j, None, "kN", "m/s")
    >>> in_units(mobility, "N", "m/s^2").response[1].round(5)
    np.complex128(0.00628j)
    """
    factors = []
    for key, found, wanted in (
        ("input_unit", transfer.input_unit, input_unit),
        ("output_unit", transfer.output_unit, output_unit),
    ):
        (have, value), (want, unit) = (quantity_of_unit(u) or ("", 1.0) for u in (found, wanted))
        times = _MOTION.get(want, 0) - _MOTION.get(have, 0) if key == "output_unit" else 0
        moved = times > 0 and {have, want} <= set(_MOTION)
        if not have or (have != want and not moved):
            raise ParameterError(f"{transfer.name}: {key} is {found!r}; it must be {wanted!r}")
        rise = (2j * np.pi * transfer.frequencies) ** times if moved else 1.0
        factors.append(np.asarray(value / unit * rise))
    return replace(
        transfer,
        response=np.asarray(factors[1] / factors[0] * transfer.response),
        input_unit=input_unit,
        output_unit=output_unit,
    )
