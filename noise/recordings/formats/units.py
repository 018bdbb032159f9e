"""Units that measuring programs write, and the channel each of them belongs to.

A unit names its quantity, so it decides what a channel is: loggers' channel names are free text.
Only units that can mean one thing are listed. A volt or a degree Celsius is no channel's.
"""

from __future__ import annotations

import math

from models.recording import CHANNEL_UNITS

__all__ = ["kind_of_unit", "known_units"]

_STANDARD_GRAVITY = 9.80665  # m/s^2, by definition
_DEGREE = math.pi / 180.0
_TURN = 2.0 * math.pi

_IN_SI = {
    "torque": {"Nm": 1.0, "Nmm": 1e-3, "Ncm": 1e-2, "mNm": 1e-3, "kNm": 1e3},
    "acceleration": {
        "m/s2": 1.0,
        "m/s/s": 1.0,
        "ms-2": 1.0,
        "mm/s2": 1e-3,
        **dict.fromkeys(("g", "gn", "g_n"), _STANDARD_GRAVITY),
        "mg": 1e-3 * _STANDARD_GRAVITY,
    },
    "pressure": {"Pa": 1.0, "uPa": 1e-6, "mPa": 1e-3, "hPa": 1e2, "kPa": 1e3},
    "angle": {
        "rad": 1.0,
        "mrad": 1e-3,
        "rev": _TURN,
        **dict.fromkeys(("deg", "degree", "degrees", "°"), _DEGREE),
    },
    "speed": {
        "rad/s": 1.0,
        "deg/s": _DEGREE,
        "°/s": _DEGREE,
        "rev/s": _TURN,
        **dict.fromkeys(("rpm", "RPM", "r/min", "rev/min", "1/min", "min-1"), _TURN / 60.0),
    },
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
}
"""Kind of channel -> spelling of a unit, without signs of multiplication -> its value in SI."""

_BY_SPELLING = {
    spelling: (kind, value) for kind, units in _IN_SI.items() for spelling, value in units.items()
}

_SIGNS = str.maketrans({"²": "2", "µ": "u", "μ": "u", **dict.fromkeys(" ^·*.()")})


def kind_of_unit(unit: str) -> tuple[str, float] | None:
    """Kind of channel that a unit belongs to, and the unit's value in that channel's SI unit.

    Parameters
    ----------
    unit : str
        As a file spells it; signs of multiplication and powers, dots and blanks do not matter.

    Returns
    -------
    tuple of (str, float), optional
        Kind, and the value [SI unit]; None for a unit that is no channel's.

    Examples
    --------
    >>> kind_of_unit("N·mm"), kind_of_unit("m/s²"), kind_of_unit("V")
    (('torque', 0.001), ('acceleration', 1.0), None)
    """
    return _BY_SPELLING.get(unit.strip().translate(_SIGNS))


def known_units() -> str:
    """SI units of all channels, for a message.

    Examples
    --------
    >>> known_units()
    'N m, m/s^2, Pa, rad, rad/s, N'
    """
    return ", ".join(CHANNEL_UNITS.values())
