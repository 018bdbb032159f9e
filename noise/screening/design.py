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
    [tolerances]
    elastomer_stiffness = 0.05                # relative standard deviation
    kinetic_torque = { low = 7.5, high = 8.5 }

The values along an axis of a map, in such a file and in options, are a number, a list, or a range
``LOW..HIGH`` with as many points as asked for, ``LOW..HIGH/N``. A range without them has those of a
map that shows a boundary where it is: a speed every eighth of a radian a second, seventeen fits.

A tolerance is a relative standard deviation, or limits between which all values are equally likely,
in the unit of the design file. Parameters of the rig's effects can vary as well, each under the
name of its effect: ``slip_pulse.amplitude = 0.1``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from models.condition import FIXED
from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import refusing
from models.rig import LawSpec, Rig
from models.rig_file import load_material_rig, material_names, read_toml, rig_from
from models.schema import as_table, as_text, number, refuse_unknown
from models.show import short_repr
from models.units import ABSOLUTE_ZERO

PARAMETERS = {
    "elastomer_stiffness": "Nm/rad",
    "damping": "Nm s/rad",
    "critical_torque": "Nm",
    "kinetic_torque": "Nm",
    "elastomer_inertia": "kg m2",
    "support_stiffness": "Nm/rad",
    "interference": "mm",
}
"""Parameters that can vary, with their units in a design file; those of effects vary as well."""


@dataclass(frozen=True)
class Tolerance:
    """Tolerance of one parameter.

    Parameters
    ----------
    name : str
        One of `PARAMETERS`, or ``EFFECT.PARAMETER``.
    spread : float, optional
        Relative standard deviation [-]; None where there are limits.
    low, high : float
        Limits [unit of the parameter].
    """

    name: str
    spread: float | None
    low: float = 0.0
    high: float = math.inf


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
        content = read_toml(path, where)
        plain = {key: content[key] for key in content if key not in ("design", "tolerances")}
        rig = rig_from(plain, path.parent, where)
        table = as_table(_stated("design", content, path.parent, where), "design", where)
        tolerances = _stated("tolerances", content, path.parent, where)
        inside = f"{where}, design"
        keys = {axis: key for axis, (key, _) in AXES.items()}
        refuse_unknown(table, {"name", "oscillation", *keys.values()}, inside)
        named = table.get("name", content.get("name", path.stem))
        return Design(
            name=as_text(named, "name", inside),
            rig=rig,
            use=read_use(
                {axis: table.get(key) for axis, key in keys.items()},
                {axis: f"{inside}: {key}" for axis, key in keys.items()},
                _swinging(table.get("oscillation"), inside),
            ),
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


def read_use(
    given: Mapping[str, object], names: Mapping[str, str], swinging: Swinging | None
) -> Use:
    """Read the operating conditions of a use.

    Parameters
    ----------
    given : mapping of str to object
        Values by the keys of `AXES`, as for `axis_values`, in the units of a design file.
    names : mapping of str to str
        Names of the axes in messages.
    swinging : Swinging, optional

    Raises
    ------
    ParameterError
        A value cannot be used.

    Examples
    --------
    >>> names = {axis: f"--{axis}" for axis in AXES}
    >>> read_use({"speed": "1..2/3", "interference": 0.25}, names, None).speed
    (1.0, 1.5, 2.0)
    """
    values = {axis: axis_values(given.get(axis), names[axis], AXES[axis][1]) for axis in AXES}
    fits = values["interference"]
    if fits and fits[-1] > 10.0:
        raise ParameterError(f"{names['interference']} is {fits[-1]:g} mm; it must be at most 10")
    return Use(**values | {"interference": tuple(1e-3 * fit for fit in fits)}, swinging=swinging)


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
) -> tuple[dict[str, Design], list[tuple[str, str]]]:
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

    Raises
    ------
    ParameterError
        All are refused.

    Examples
    --------
    >>> loaded, refused = load_designs(["PDMS", "PDMS", "cheese"])
    >>> list(loaded), [name for name, _ in refused]
    (['PDMS', 'PDMS (2)'], ['cheese'])
    """
    loaded: dict[str, Design] = {}
    refused: list[tuple[str, str]] = []
    for one in designs:
        try:
            design = one if isinstance(one, Design) else load_design(one)
            if change is not None:
                design = replace(design, rig=change(design.rig))
        except BushingNoiseError as error:
            refused.append((one.name if isinstance(one, Design) else str(one), str(error)))
            continue
        name, n = design.name, 2
        while name in loaded:
            name, n = f"{design.name} ({n})", n + 1
        loaded[name] = replace(design, name=name)
    if not loaded:
        raise ParameterError(refused[0][1])
    return loaded, refused


# --- tolerances ----------------------------------------------------------------------------------


def read_tolerances(
    given: object, where: str, effects: Sequence[LawSpec] = ()
) -> tuple[Tolerance, ...]:
    """Read the table ``[tolerances]``.

    Parameters
    ----------
    given : object
        Content of the table.
    where : str
        Name of the file in messages.
    effects : sequence of LawSpec
        Of the rig, the parameters of which can vary where it states them.

    Raises
    ------
    ParameterError
        A name that cannot vary, or an entry that is none; the message names it.

    Examples
    --------
    >>> read_tolerances({"damping": 0.1}, "design")
    (Tolerance(name='damping', spread=0.1, low=0.0, high=inf),)
    """
    table, where = as_table(given, "tolerances", where), f"{where}, tolerances"
    stated = {
        spec.name: {key for key, value in spec.parameters.items() if not isinstance(value, str)}
        for spec in effects
    }
    refuse_unknown(table, set(PARAMETERS) | set(stated), where)
    tolerances = []
    for name, entry in table.items():
        if name in PARAMETERS:
            tolerances.append(_tolerance(name, entry, where))
            continue
        inner = as_table(entry, name, where)
        refuse_unknown(inner, stated[name], f"{where}, {name}")
        tolerances += [_tolerance(f"{name}.{key}", value, where) for key, value in inner.items()]
    return tuple(tolerances)


def _tolerance(name: str, entry: object, where: str) -> Tolerance:
    if not isinstance(entry, Mapping):
        return Tolerance(name, number({name: entry}, name, where, closed=True))
    inside = f"{where}, {name}"
    refuse_unknown(entry, {"low", "high"}, inside)
    if set(entry) != {"low", "high"}:
        raise ParameterError(f"{inside}: give a number, or low and high")
    low, high = (number(entry, key, inside) for key in ("low", "high"))
    if not low < high:
        raise ParameterError(f"{inside}: low = {low:g} is not below high = {high:g}")
    return Tolerance(name, None, low, high)


# --- values along an axis ------------------------------------------------------------------------


MOST_POINTS = 2000
"""Along one axis."""

SPEED_STEP = 0.125
"""Of a range of speeds without points of its own [rad/s]."""


@dataclass(frozen=True)
class AxisRule:
    """Allowed values of an axis.

    Parameters
    ----------
    step : float, optional
        Step of a range without a number of points, in the unit of the axis, such as [rad/s].
    points : int
        Number of points of a range without one, where there is no step.
    low : float
        Lower limit, itself not allowed, in the unit of the axis, such as [rad/s].
    fixed : bool
        Whether ``fixed`` is a value.
    """

    step: float | None = None
    points: int = 17
    low: float = 0.0
    fixed: bool = False


POSITIVE = AxisRule()
FREQUENCY = AxisRule(step=0.25)

AXES = {
    "speed": ("speed_rad_s", AxisRule(step=SPEED_STEP)),
    "interference": ("interference_mm", POSITIVE),
    "support_stiffness": ("support_stiffness_Nm_rad", AxisRule(fixed=True)),
    "temperature": ("temperature_C", AxisRule(points=3, low=ABSOLUTE_ZERO)),
}
"""Key in a design file and rule of each axis of a `Use`."""


def spread(low: float, high: float, points: int) -> tuple[float, ...]:
    """Return evenly spaced values, rounded to ten digits.

    Parameters
    ----------
    low, high : float
        Ends, in the unit of the axis, such as [rad/s].
    points : int
        2 or more.

    Examples
    --------
    >>> spread(0.25, 1.0, 4)
    (0.25, 0.5, 0.75, 1.0)
    """
    step = (high - low) / (points - 1)
    return tuple(float(f"{low + i * step:.10g}") for i in range(points))


def axis_values(given: object, what: str, rule: AxisRule = POSITIVE) -> tuple[float, ...]:
    """Parse an axis: a number, ``5``, ``0.178,0.279``, ``0.25..13``, ``0.25..13/52``, or a list.

    Parameters
    ----------
    given : object
        Value of an option or a key of a design file; None has no values.
    what : str
        Name of the axis in messages, such as ``--speed``.
    rule : AxisRule

    Returns
    -------
    tuple of float
        Rising, each once, in the unit of the axis, such as [rad/s].

    Raises
    ------
    ParameterError
        It is none of these, or a value is out of range.

    Examples
    --------
    >>> axis_values("1..2/3", "--speed"), axis_values("fixed,2214", "-k", AxisRule(fixed=True))
    ((1.0, 1.5, 2.0), (2214.0, inf))
    >>> axis_values([0.178, 0.279], "interference_mm"), axis_values("1..2/2", "speed_rad_s")
    ((0.178, 0.279), (1.0, 2.0))
    """
    if given is None:
        return ()
    numbers: list[float] = []
    for item in given if isinstance(given, list) else [given]:
        if isinstance(item, str):
            for part in item.split(","):
                numbers += _part_values(part, what, item, rule)
        elif isinstance(item, int | float) and not isinstance(item, bool):
            numbers.append(float(item))
        else:
            raise ParameterError(f"{what} = {given!r}: give numbers, or a range such as '0.25..13'")
    values = sorted(set(numbers))
    if not values:
        raise ParameterError(f"{what} is empty; give at least one value")
    finite = rule.fixed or math.isfinite(values[-1])
    if not values[0] > rule.low or math.isnan(values[-1]) or not finite:
        raise ParameterError(f"{what} is {given!r}; values must be above {rule.low:g} and finite")
    if len(values) > MOST_POINTS:
        raise ParameterError(f"{what} has {len(values)} values; at most {MOST_POINTS} are mapped")
    return tuple(values)


def _part_values(part: str, what: str, whole: str, rule: AxisRule) -> tuple[float, ...]:
    """Parse the text between two commas: a number or a range."""

    def value(text: str, *, fixed: bool = False) -> float:
        if fixed and text.strip().lower() == "fixed":
            return FIXED
        with suppress(ValueError):
            if math.isfinite(parsed := float(text)):
                return parsed
        word = ", or fixed" if fixed else ""
        raise ParameterError(
            f"{what} is {whole!r}, expected numbers such as 5, 1,2.5,5 or 0.25..13/52{word}"
        )

    first, dots, rest = part.partition("..")
    if not dots:
        return (value(part, fixed=rule.fixed),)
    last, slash, count = rest.partition("/")
    start, end = value(first), value(last)
    if not start < end:
        raise ParameterError(f"{what} is {whole!r}: a range rises, as 0.25..13 does")
    if slash and not (count.strip().isdecimal() and 2 <= int(count) <= MOST_POINTS):
        raise ParameterError(
            f"{what} is {whole!r}: the points of a range are a whole number from 2 to "
            f"{MOST_POINTS}, as in 0.25..13/52"
        )
    n = int(count) if slash else rule.points
    if rule.step is not None and not slash:
        n = min(MOST_POINTS, round((end - start) / rule.step) + 1)
    return spread(start, end, max(2, n))
