"""Units of measured quantities: spellings in files, quantity and value in SI.

A unit implies its quantity, so it determines the kind of a channel; loggers' channel names are free
text. Only unambiguous units are listed; a further spelling is an entry here.
"""

import math
import re

ABSOLUTE_ZERO = -273.15
"""Absolute zero [degree Celsius]."""

STANDARD_GRAVITY = 9.80665
"""Standard gravity by definition [m/s^2]."""

_DEGREE = math.pi / 180.0
_TURN = 2.0 * math.pi
_POUND_FORCE, _INCH = 4.4482216152605, 0.0254

CHANNEL_UNITS = {
    "torque": "N m",
    "acceleration": "m/s^2",
    "pressure": "Pa",
    "angle": "rad",
    "speed": "rad/s",
    "force": "N",
}
"""SI unit of the samples by kind of channel."""

SI_UNITS = {**CHANNEL_UNITS, "time": "s", "frequency": "Hz", "displacement": "m", "velocity": "m/s"}
"""SI unit by quantity."""

_IN_SI = {
    "torque": {
        "Nm": 1.0, "Nmm": 1e-3, "Ncm": 1e-2, "mNm": 1e-3, "kNm": 1e3,
        "lbfin": _POUND_FORCE * _INCH, "lbfft": _POUND_FORCE * 12 * _INCH,
        "newtonmeter": 1.0, "newtonmetre": 1.0,
    },
    "acceleration": {
        "m/s2": 1.0, "m/s/s": 1.0, "ms-2": 1.0, "m/sec2": 1.0, "mm/s2": 1e-3, "cm/s2": 1e-2,
        "um/s2": 1e-6, "in/s2": _INCH, "ft/s2": 12 * _INCH,
        "g": STANDARD_GRAVITY, "gn": STANDARD_GRAVITY, "g_n": STANDARD_GRAVITY,
        "mg": 1e-3 * STANDARD_GRAVITY,
    },
    "pressure": {
        "Pa": 1.0, "uPa": 1e-6, "mPa": 1e-3, "hPa": 1e2, "kPa": 1e3, "MPa": 1e6, "N/m2": 1.0,
        "pa": 1.0, "kpa": 1e3, "pascal": 1.0, "pascals": 1.0,
    },
    "angle": {
        "rad": 1.0, "mrad": 1e-3, "rev": _TURN, "deg": _DEGREE, "°": _DEGREE,
        "radian": 1.0, "radians": 1.0, "degree": _DEGREE, "degrees": _DEGREE,
    },
    "speed": {
        "rad/s": 1.0, "rads-1": 1.0, "rad/sec": 1.0, "deg/s": _DEGREE, "degree/s": _DEGREE,
        "°/s": _DEGREE, "rev/s": _TURN, "U/s": _TURN,
        **dict.fromkeys(
            ("rpm", "r/min", "rev/min", "1/min", "min-1", "U/min", "Upm", "turns/min"),
            _TURN / 60.0,
        ),
    },
    "force": {
        "N": 1.0, "mN": 1e-3, "kN": 1e3, "daN": 10.0, "lbf": _POUND_FORCE,
        "kgf": STANDARD_GRAVITY, "newton": 1.0, "newtons": 1.0,
    },
    "time": {
        "s": 1.0, "sec": 1.0, "ms": 1e-3, "msec": 1e-3, "us": 1e-6, "usec": 1e-6, "ns": 1e-9,
        "min": 60.0, "h": 3600.0,
        "second": 1.0, "seconds": 1.0, "sekunden": 1.0, "milliseconds": 1e-3,
    },
    "frequency": {"Hz": 1.0, "hz": 1.0, "kHz": 1e3, "MHz": 1e6, "hertz": 1.0},
    "displacement": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": _INCH, "meter": 1.0},
    "velocity": {
        "m/s": 1.0, "m/sec": 1.0, "ms-1": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "um/s": 1e-6,
        "in/s": _INCH,
    },
}  # fmt: skip
"""Value in SI by quantity and spelling, without multiplication signs."""

_BY_SPELLING = {
    spelling: (quantity, value)
    for quantity, units in _IN_SI.items()
    for spelling, value in units.items()
}
_BY_SPELLING |= {
    spelling.upper(): _BY_SPELLING[spelling]
    for spelling in (
        "Pa", "kPa", "m/s2", "m/s", "mm/s2", "mm/s", "Nm", "kN", "g", "rad", "rad/s", "deg",
        "deg/s", "rpm", "s", "sec", "m", "mm", "Hz", "kHz",
    )
}  # fmt: skip
"""Quantity and value in SI by spelling. Capitals are allowed only where they are unambiguous: MPA
may be mPa or MPa."""

_SHORTEST_WORD = 5
"""Length from which a unit is a word, whose case does not matter."""

_SIGNS = str.maketrans({"²": "2", "µ": "u", "μ": "u", "º": "°", **dict.fromkeys(" \t^·⋅*.()[]<>")})
_HYPHEN = re.compile(r"(?<=[^\W\d_])-(?=[^\W\d_])")
_ENDS_IN_UNIT = (
    re.compile(r"(.*)[(\[<]([^()\[\]<>]*)[)\]>]", re.DOTALL),
    re.compile(r"(.*?)[(\[<](.*)[)\]>]", re.DOTALL),
    re.compile(r"(.*\S)(?:\s/|\sin|,)\s+(\S.*)", re.DOTALL),
)


def quantity_of_unit(unit: str) -> tuple[str, float] | None:
    """Return the quantity of a unit, and its value in the unit of `SI_UNITS`.

    Parameters
    ----------
    unit : str
        Spelling of a file; signs of multiplication and powers, dots, blanks and brackets do not
        matter.

    Returns
    -------
    tuple of (str, float), optional
        Quantity, and the value [SI unit]; None for an unknown unit.

    Examples
    --------
    >>> quantity_of_unit("ms"), quantity_of_unit("[mm/s]"), quantity_of_unit("V")
    (('time', 0.001), ('velocity', 0.001), None)
    """
    plain = _HYPHEN.sub("", unit).translate(_SIGNS)
    if len(plain) >= _SHORTEST_WORD and plain not in _BY_SPELLING:
        plain = plain.lower()
    return _BY_SPELLING.get(plain)


def kind_of_unit(unit: str) -> tuple[str, float] | None:
    """Return the kind of channel of a unit, and its value in that channel's SI unit.

    Parameters
    ----------
    unit : str
        As for `quantity_of_unit`.

    Returns
    -------
    tuple of (str, float), optional
        Kind, and the value [SI unit]; None for a unit of no channel.

    Examples
    --------
    >>> kind_of_unit("N·mm"), kind_of_unit("m/s²"), kind_of_unit("[Pa]"), kind_of_unit("ms")
    (('torque', 0.001), ('acceleration', 1.0), ('pressure', 1.0), None)
    """
    quantity = quantity_of_unit(unit)
    return quantity if quantity is not None and quantity[0] in CHANNEL_UNITS else None


def split_unit(heading: str) -> tuple[str, str]:
    """Split the heading of a column into name and unit, empty if none is stated.

    Examples
    --------
    >>> split_unit("Acceleration (m/s^2)"), split_unit("Kraft / kN"), split_unit("time_ms")
    (('Acceleration', 'm/s^2'), ('Kraft', 'kN'), ('time', 'ms'))
    >>> split_unit("response")
    ('response', '')
    """
    heading = heading.strip()
    for ending in _ENDS_IN_UNIT:
        if match := ending.fullmatch(heading):
            return match[1].strip(), match[2].strip()
    name, _, unit = heading.partition("_")
    return (name, unit) if quantity_of_unit(unit) else (heading, "")


def split_ratio(unit: str) -> tuple[str, str]:
    """Split the unit of a response into those of output and input, empty if it has none.

    Examples
    --------
    >>> split_ratio("(m/s²)/(N m)"), split_ratio("Pa per N"), split_ratio("m/s^2")
    (('m/s²', 'N m'), ('Pa', 'N'), ('m/s^2', ''))
    """
    if quantity_of_unit(unit) is None:
        for sign in re.finditer(r"/| per ", unit):
            output, per = unit[: sign.start()], unit[sign.end() :]
            if quantity_of_unit(output) and quantity_of_unit(per):
                return output.strip(" ()"), per.strip(" ()")
    return unit, ""
