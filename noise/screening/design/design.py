"""Bushing design: a rig, its use and its tolerances, read from a file.

A design file is a rig file with two tables more: ``[design]`` says what the design is called and
what it will meet in use, ``[tolerances]`` how far built ones lie from it. The name of a material
that is shipped is a design as well, on the shipped bench. What neither file nor caller says is
taken from the rig: its fits, its supports.

    [design]
    name = "softer"
    speed_rad_s = "0.25..13"           # or a list
    interference_mm = "0.178..0.381/9"
    support_stiffness_Nm_rad = [2214, 3745, "fixed"]
    temperature_C = 23
    oscillation = { amplitude_deg = 15, frequency_hz = "0.5..4" }
    [design.heard]                     # where the app begins; no map is of it
    speed_rad_s = 5
    [tolerances]
    elastomer_stiffness = 0.05                # relative standard deviation
    interference = { absolute = 0.01 }        # the same in mm
    kinetic_torque = { low = 7.5, high = 8.5 }
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from models.errors import ParameterError
from models.foreign_file import refusing
from models.rig import Rig
from models.rig_file import load_material_rig, material_names, read_toml, rig_from
from models.schema import as_table, as_text, number, refuse_unknown
from models.show import short_repr
from noise.screening.design.axis_values import (
    FREQUENCY,
    SPEED,
    SUPPORT,
    TEMPERATURE,
    axis_values,
)
from noise.screening.design.tolerances import Tolerance, read_tolerances

_USE_KEYS = {
    "name",
    "speed_rad_s",
    "interference_mm",
    "support_stiffness_Nm_rad",
    "temperature_C",
    "oscillation",
    "heard",
}


@short_repr
@dataclass(frozen=True)
class Swinging:
    """A bar on the road, swinging to and fro.

    Parameters
    ----------
    amplitude : float
        [rad]
    frequency : tuple of float
        [Hz]

    Examples
    --------
    >>> Swinging(math.radians(15.0), (0.5, 2.0)).peak_speed[1]
    3.28...
    """

    amplitude: float
    frequency: tuple[float, ...]

    @property
    def peak_speed(self) -> tuple[float, ...]:
        """Largest speed at each frequency [rad/s]."""
        return tuple(2.0 * math.pi * f * self.amplitude for f in self.frequency)


@short_repr
@dataclass(frozen=True)
class Use:
    """What a design meets in use; empty where it is not said.

    Parameters
    ----------
    speed : tuple of float
        [rad/s], rising; the first and the last are the limits of use.
    interference : tuple of float
        [m]
    support_stiffness : tuple of float
        [Nm/rad]
    temperature : tuple of float
        [degree Celsius]
    swinging : Swinging, optional

    Examples
    --------
    >>> Use(speed=(1.0, 5.0)).interference
    ()
    """

    speed: tuple[float, ...] = ()
    interference: tuple[float, ...] = ()
    support_stiffness: tuple[float, ...] = ()
    temperature: tuple[float, ...] = ()
    swinging: Swinging | None = None


@short_repr
@dataclass(frozen=True)
class Design:
    """A bushing on its rig, how it is used, and how it varies.

    Parameters
    ----------
    name : str
    rig : Rig
    use : Use
    tolerances : tuple of Tolerance

    Examples
    --------
    >>> Design("soft", load_material_rig("PDMS")).use.speed
    ()
    """

    name: str
    rig: Rig
    use: Use = Use()
    tolerances: tuple[Tolerance, ...] = ()


def load_design(given: str | Path) -> Design:
    """Read a design file, or take a material by its name.

    Parameters
    ----------
    given : str or Path
        Design file, or name of a material.

    Returns
    -------
    Design

    Raises
    ------
    ParameterError
        There is no such file or material, or the file holds what cannot be used.

    Examples
    --------
    >>> load_design("pdms").rig.material
    'PDMS'
    """
    path = Path(given)
    if not path.suffix and not path.exists():
        known = {name.lower(): name for name in material_names()}
        name = known.get(str(given).strip().lower())
        if name is None:
            raise ParameterError(
                f"design {str(given)!r}: neither a file nor a material; there are "
                f"{', '.join(material_names())}"
            )
        return Design(name, load_material_rig(name))
    where = f"design {path}"
    with refusing(where, "design"):
        return _read_design(path, where)


def _read_design(path: Path, where: str) -> Design:
    content = read_toml(path, where)
    table = as_table(content.pop("design", {}), "design", where)
    tolerances = content.pop("tolerances", {})
    refuse_unknown(table, _USE_KEYS, f"{where}, design")
    rig = rig_from(content, path.parent, where)
    named = table.get("name", content.get("name", path.stem))
    return Design(
        name=as_text(named, "name", f"{where}, design"),
        rig=rig,
        use=_use(table, f"{where}, design"),
        tolerances=read_tolerances(tolerances, where, rig.effects),
    )


def _use(table: Mapping[str, object], where: str) -> Use:
    fits = axis_values(table.get("interference_mm"), f"{where}: interference_mm")
    if fits and fits[-1] >= 10.0:
        raise ParameterError(f"{where}: interference_mm = {fits[-1]:g} must be below 10")
    speed, support, temperature = (
        axis_values(table.get(key), f"{where}: {key}", rule)
        for key, rule in (
            ("speed_rad_s", SPEED),
            ("support_stiffness_Nm_rad", SUPPORT),
            ("temperature_C", TEMPERATURE),
        )
    )
    return Use(
        speed=speed,
        interference=tuple(1e-3 * fit for fit in fits),
        support_stiffness=support,
        temperature=temperature,
        swinging=_swinging(table.get("oscillation"), where),
    )


def _swinging(given: object, where: str) -> Swinging | None:
    if given is None:
        return None
    where = f"{where}, oscillation"
    table = as_table(given, "oscillation", where)
    refuse_unknown(table, {"amplitude_deg", "frequency_hz"}, where)
    degrees = number(table, "amplitude_deg", where)
    if "frequency_hz" not in table:
        raise ParameterError(f"{where}: frequency_hz is missing")
    frequency = axis_values(table["frequency_hz"], f"{where}: frequency_hz", FREQUENCY)
    return Swinging(math.radians(degrees), frequency)
