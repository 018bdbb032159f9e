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

import json
import math
import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import refusing
from models.rig import Rig
from models.rig_file import base_name, load_material_rig, material_names, read_toml, rig_from
from models.schema import as_table, as_text, number, refuse_unknown
from models.show import short_repr
from noise.screening.axis_values import (
    FREQUENCY,
    SPEED,
    SUPPORT,
    TEMPERATURE,
    axis_values,
)
from noise.screening.tolerances import Tolerance, read_tolerances

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
    """Oscillation of a stabilizer bar on the road.

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
    """Operating conditions of a design in use; empty where not stated.

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
    """Bushing design: a rig, its use and its tolerances.

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
    """Load a design from a file, or by the name of a material.

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
    plain = {key: value for key, value in content.items() if key not in ("design", "tolerances")}
    rig = rig_from(plain, path.parent, where)
    table = as_table(_stated("design", content, path.parent, where), "design", where)
    tolerances = _stated("tolerances", content, path.parent, where)
    refuse_unknown(table, _USE_KEYS, f"{where}, design")
    named = table.get("name", content.get("name", path.stem))
    return Design(
        name=as_text(named, "name", f"{where}, design"),
        rig=rig,
        use=_use(table, f"{where}, design"),
        tolerances=read_tolerances(tolerances, where, rig.effects),
    )


def _stated(key: str, content: Mapping[str, Any], folder: Path, where: str) -> Any:
    """Return a table of a design file, or of its base without the name."""
    if key in content:
        return content[key]
    base = folder / str(content.get("base", ""))
    if not base.is_file():
        return {}
    table = _stated(key, read_toml(base, where), base.parent, where)
    if isinstance(table, Mapping):
        return {name: value for name, value in table.items() if name != "name"}
    return table


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


def load_designs(
    designs: Sequence[str | Path | Design], change: Callable[[Rig], Rig] | None = None
) -> tuple[dict[str, Design], list[tuple[str, str]], list[tuple[str, Path]]]:
    """Load designs, and collect the reasons for those that are refused.

    Parameters
    ----------
    designs : sequence of str, Path or Design
        Design files, names of materials, or designs.
    change : callable, optional
        Makes another rig of that of each design.

    Returns
    -------
    dict of str to Design
        Designs by name; a number distinguishes two of one name.
    list of (str, str)
        Those that are refused, and why.
    list of (str, Path)
        Names of designs, and the files that they are as they stand in.

    Raises
    ------
    ParameterError
        All are refused.

    Examples
    --------
    >>> loaded, refused, files = load_designs(["PDMS", "PDMS", "cheese"])
    >>> list(loaded), [name for name, _ in refused], files
    (['PDMS', 'PDMS (2)'], ['cheese'], [])
    """
    loaded: dict[str, Design] = {}
    refused: list[tuple[str, str]] = []
    files: list[tuple[str, Path]] = []
    for one in designs:
        try:
            design = one if isinstance(one, Design) else load_design(one)
            if change is not None:
                design = replace(design, rig=change(design.rig))
        except BushingNoiseError as error:
            refused.append((one.name if isinstance(one, Design) else str(one), str(error)))
            continue
        design = _with_name_of_its_own(design, set(loaded))
        loaded[design.name] = design
        if change is None and not isinstance(one, Design) and Path(one).is_file():
            files.append((design.name, Path(one)))
    if not loaded:
        raise ParameterError(refused[0][1])
    return loaded, refused, files


def _with_name_of_its_own(design: Design, taken: set[str]) -> Design:
    """Return the design with a number behind its name where the name is taken."""
    name, number = design.name, 2
    while name in taken:
        name, number = f"{design.name} ({number})", number + 1
    return replace(design, name=name)


def copy_design_file(name: str, source: Path, folder: Path) -> Path:
    """Copy a design's file to ``folder/NAME.toml``, with the responses that it names.

    Responses named by a path of the file's own folder go with it. One named by a way out of that
    folder would not be found from the copy, which is refused. A base out of that folder, or with
    such a base of its own, is named by the copy from where it lies.

    Parameters
    ----------
    name : str
        Name of the design in the screening.
    source, folder : Path

    Returns
    -------
    Path
        The copy.

    Raises
    ------
    ParameterError
        The name is none of a file, or the copy is no design; the message says so.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as made:
    ...     source = Path(made) / "mine.toml"
    ...     size = source.write_text('material = "PDMS"', encoding="utf-8")
    ...     copy_design_file("soft", source, Path(made) / "designs").name
    'soft.toml'
    """
    target = folder / f"{name}.toml"
    where = f"design {source}: cannot be copied to {target}"
    if Path(name).name != name:
        raise ParameterError(f"{where}: the design's name is none of a file")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in _named_files(source):
            if not path.is_absolute() and ".." not in path.parts:
                (folder / path).parent.mkdir(parents=True, exist_ok=True)
                _copied(source.parent / path, folder / path)
        if (base := _base_elsewhere(source)) is None:
            _copied(source, target)
        else:
            named = f"base = {json.dumps(base_name(base, folder), ensure_ascii=False)}"
            text = source.read_text(encoding="utf-8")
            target.write_text(_BASE.sub(lambda _: named, text, count=1), encoding="utf-8")
        load_design(target)
    except OSError as error:
        raise ParameterError(f"{where}: {error.strerror or error}") from None
    except BushingNoiseError as error:
        target.unlink(missing_ok=True)
        raise ParameterError(f"{where}: {error}") from None
    return target


_BASE = re.compile(r"""^base\s*=\s*(?:"[^"]*"|'[^']*')""", re.MULTILINE)
"""Line that names the base of a file."""


def _base_elsewhere(source: Path) -> Path | None:
    """Return the base of a file if its path, or that of its own base, leaves the folder."""
    named = Path(read_toml(source, f"design {source}").get("base", ""))
    base = source.parent / named
    if named.is_absolute() or not base.is_file():
        return None
    return base if ".." in named.parts or _base_elsewhere(base) is not None else None


def _copied(source: Path, target: Path) -> None:
    if not (target.exists() and source.samefile(target)):
        shutil.copyfile(source, target)


def _named_files(source: Path) -> list[Path]:
    content = read_toml(source, f"design {source}")
    paths = [
        Path(value)
        for table in content.get("measured_response", [])
        for key, value in table.items()
        if key.startswith("torque_to_") and isinstance(value, str)
    ]
    base = Path(content.get("base", ""))
    if base.suffix and (source.parent / base).is_file() and _base_elsewhere(source) is None:
        paths += [base, *(base.parent / named for named in _named_files(source.parent / base))]
    return paths
