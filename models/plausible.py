"""Bounds of the plausible and of the possible for what describes a bushing and its use.

What lies outside the usual is used, and told in one line; what is not possible is refused.
The usual range is that of the thesis's rig and of bushings from a wiper's to a lorry's spring eye;
the possible is as wide as numbers still mean something.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from models.rig import Rig

__all__ = ["BOUNDS", "Bounds", "refuse_impossible", "remark", "rig_remarks"]


@dataclass(frozen=True)
class Bounds:
    """Bounds of one quantity, in the unit in which files and options say it.

    Parameters
    ----------
    unit : str
        Shown behind values.
    usual, possible : tuple of float
        Lowest and highest value [`unit`].
    source : str
        Where the bounds come from.
    slips : tuple of (float, str)
        Factors that bring a value in a wrong unit to the right one, and that unit.
    """

    unit: str
    usual: tuple[float, float]
    possible: tuple[float, float]
    source: str
    slips: tuple[tuple[float, str], ...] = ()


_TORQUE_SLIPS = ((1e-3, "Nmm"), (1e3, "kNm"))

_RANGES = {
    "torque": Bounds(
        "Nm", (0.05, 1e4), (1e-9, 1e9), "+-102.5 at the rig (Appendix C); cells of 0.1 Nm to 10 kNm"
    ),
    "acceleration": Bounds(
        "m/s^2",
        (5.0, 1e6),
        (1e-6, 1e9),
        "+-977 at the rig (Appendix D); sensors of 0.5 to 1e5 g",
    ),
    "pressure": Bounds(
        "Pa", (0.02, 2e4), (1e-9, 1e8), "+-28.9 at the rig (Appendix E); microphones to 180 dB"
    ),
    "angle": Bounds("rad", (1e-3, 1e4), (1e-9, 1e9), "+-12.4 at the rig (Appendix B)"),
    "speed": Bounds("rad/s", (0.1, 1e4), (1e-6, 1e9), "ten times the speeds of the rig and more"),
    "force": Bounds("N", (1.0, 1e6), (1e-6, 1e12), "hammers of 20 N to 200 kN"),
}
"""Of full scale, by kind of channel."""

_NOISE = {
    "torque": 0.5, "acceleration": 5.0, "pressure": 0.15, "angle": 0.06, "speed": 0.5, "force": 5.0,
}  # fmt: skip
"""Largest usual standard deviation by kind of channel, in its unit."""

BOUNDS = {
    "elastomer_stiffness_Nm_rad": Bounds(
        "Nm/rad",
        (20.0, 2e4),
        (1e-3, 1e8),
        "430 to 1011 at the rig (Table 5.3); a rubber ring of 10 to 50 mm has G = 0.4 to 6 MPa",
        ((1e-3, "Nmm/rad"), (180.0 / math.pi, "Nm/degree"), (1e3, "kNm/rad")),
    ),
    "critical_torque_Nm": Bounds(
        "Nm",
        (0.3, 500.0),
        (1e-6, 1e7),
        "5 to 40 at the rig (Appendix F); friction 0.1 to 2 at 0.1 to 5 MPa on 10 to 50 mm",
        _TORQUE_SLIPS,
    ),
    "kinetic_torque_Nm": Bounds(
        "Nm", (0.2, 500.0), (1e-6, 1e7), "as the critical torque", _TORQUE_SLIPS
    ),
    "damping_Nms_rad": Bounds(
        "Nm s/rad",
        (2e-3, 1.5),
        (1e-9, 1e3),
        "0.08 to 0.24 at the rig (Table 5.5); rubber's loss factors reach 1, half of what is "
        "critical, 2 sqrt(k J) = 3.1 at the rig's first mode (k = 665 + 2214, J = 8.3e-4)",
        ((1e-3, "Nmm s/rad"), (180.0 / math.pi, "Nm s/degree")),
    ),
    "fit_interference_mm": Bounds(
        "mm",
        (0.02, 3.0),
        (1e-6, 100.0),
        "0.127 to 0.381 at the rig (3.1.3); strains of rubber of 1 to 30 %",
        ((1e3, "metres"), (1e-3, "micrometres")),
    ),
    "interference_mm": Bounds(
        "mm",
        (0.02, 3.0),
        (1e-6, 10.0),
        "as that of a fit",
        ((1e3, "metres"), (1e-3, "micrometres")),
    ),
    "elastomer_inertia_kgm2": Bounds(
        "kg m2",
        (5e-7, 5e-3),
        (1e-12, 1e3),
        "1.5e-5 at the rig (Appendix F); 5 g at 10 mm to 2 kg at 50 mm",
        ((1e-4, "kg cm2"), (1e-6, "kg mm2")),
    ),
    "clamp_inertia_kgm2": Bounds(
        "kg m2",
        (2e-5, 0.5),
        (1e-12, 1e4),
        "8.3e-4 at the rig (Appendix F); a bracket of 50 g at 20 mm to one of 50 kg at 100 mm",
        ((1e-4, "kg cm2"), (1e-6, "kg mm2")),
    ),
    "support_stiffness_Nm_rad": Bounds(
        "Nm/rad",
        (1e3, 2e5),
        (1e-3, 1e12),
        "2214 and 3745 at the rig (Table 3.2); 'fixed' is no number",
        ((1e-3, "Nmm/rad"), (180.0 / math.pi, "Nm/degree"), (1e3, "kNm/rad")),
    ),
    "speed_rad_s": Bounds(
        "rad/s",
        (0.0, 25.0),
        (0.0, 1e6),
        "up to 19.75 at the rig (5.1.3); a bar that swings by 30 degrees at 6 Hz reaches 20",
    ),
    "temperature_C": Bounds(
        "degree Celsius",
        (-40.0, 150.0),
        (-273.15, 2000.0),
        "from a car's cold start to beside its exhaust",
    ),
    "bits": Bounds(
        "bit", (8.0, 24.0), (2.0, 32.0), "12 at the rig (3.1.2); what converters have is 8 to 24"
    ),
    "antialias_hz": Bounds(
        "Hz",
        (500.0, 1e5),
        (1.0, 1e9),
        "below half of 30 kHz at the rig (3.1.2); slips repeat above 100 Hz",
        ((1e3, "kHz"),),
    ),
    **{f"range.{kind}": bounds for kind, bounds in _RANGES.items()},
    **{
        f"noise.{kind}": Bounds(
            _RANGES[kind].unit, (0.0, most), (0.0, 1e9), "ten steps of the rig's 12 bits (3.1.2)"
        )
        for kind, most in _NOISE.items()
    },
}
"""By the key of a rig file or sidecar."""


def remark(name: str, *values: float) -> str:
    """Say in one line which values are outside the usual; empty where none is.

    Parameters
    ----------
    name : str
        A key of `BOUNDS`.
    *values : float
        [unit of the key]

    Examples
    --------
    >>> remark("critical_torque_Nm", 10700.0)
    'critical_torque_Nm = 10700 is outside the usual 0.3 to 500 Nm (is it in Nmm?)'
    >>> remark("critical_torque_Nm", 10.7)
    ''
    """
    bounds = BOUNDS[name]
    low, high = bounds.usual
    outside = sorted({value for value in values if not low <= _size(name, value) <= high})
    if not outside:
        return ""
    said = f"{outside[0]:g}" + (f" to {outside[-1]:g}" if len(outside) > 1 else "")
    units = (
        unit
        for factor, unit in bounds.slips
        if all(low <= factor * _size(name, value) <= high for value in outside)
    )
    unit = next(units, "")
    hint = f" (is it in {unit}?)" if unit else ""
    return (
        f"{name.removeprefix('fit_')} = {said} is outside the usual {low:g} to {high:g} "
        f"{bounds.unit}{hint}"
    )


def _size(name: str, value: float) -> float:
    """Return the value that is compared: a speed counts by its size."""
    return abs(value) if name == "speed_rad_s" else value


def rig_remarks(rig: Rig) -> tuple[str, ...]:
    """Say of each quantity of a rig that is outside the usual so, a line a quantity.

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> rig_remarks(load_material_rig("fluorocarbon"))
    ()
    """
    return tuple(text for name, values in _values(rig) if (text := remark(name, *values)))


def refuse_impossible(rig: Rig, where: str) -> None:
    """Refuse a rig of which a quantity cannot be.

    Raises
    ------
    ParameterError
        A value lies outside the possible; the message begins with `where` and names it.
    """
    for name, values in _values(rig):
        low, high = BOUNDS[name].possible
        for value in values:
            if not low <= value <= high:
                raise ParameterError(
                    f"{where}: {name.removeprefix('fit_')} = {value:g} cannot be; possible is "
                    f"{low:g} to {high:g} {BOUNDS[name].unit}"
                )


def _values(rig: Rig) -> Iterator[tuple[str, list[float]]]:
    yield "fit_interference_mm", [float(f"{1e3 * fit.interference:.12g}") for fit in rig.fits]
    yield "elastomer_stiffness_Nm_rad", [fit.elastomer_stiffness for fit in rig.fits]
    yield "critical_torque_Nm", [fit.critical_torque for fit in rig.fits]
    yield "kinetic_torque_Nm", [fit.kinetic_torque for fit in rig.fits]
    yield "damping_Nms_rad", [value for fit in rig.fits for value in fit.damping.values()]
    yield "elastomer_inertia_kgm2", [rig.elastomer_inertia]
    yield "clamp_inertia_kgm2", [rig.clamp_inertia]
    sensors = rig.sensors.by_kind
    for kind, sensor in sensors.items():
        yield f"range.{kind}", [] if sensor.full_scale is None else [sensor.full_scale]
        yield f"noise.{kind}", [] if sensor.noise is None else [sensor.noise]
    yield "bits", [float(s.bits) for s in sensors.values() if s.bits is not None]
    yield "antialias_hz", [s.antialias for s in sensors.values() if s.antialias is not None]
