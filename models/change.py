"""Changes to a rig: factors, percentages and values for named quantities.

A quantity of the bushing has a short name, ``damping``, and a long one with its unit,
``damping_Nms_rad``. ``"x2"`` and ``"-20 %"`` go with both, a bare number with the long one alone,
and is then the value at every fit and support. Parameters of the friction law and of effects go by
their own names, ``slip_pulse.amplitude``, or by the last part of these where only one has it,
``ageing_time``. A name of the bushing is always the bushing's, although an effect may have a
parameter that is called alike, such as ``room_reflections.length``.

Size and modulus of the rubber, ``wall_mm``, ``length_mm``, ``youngs_modulus_MPa`` or
``hardness_shore_A``, take the bushing along: its torques go with contact pressure, area and
radius, as `models.bushing` has them, its stiffness and inertia with those of the sleeve. Damping
and friction law stay.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

from models.bushing import HARDNESS, Sleeve, shore_modulus
from models.errors import ParameterError
from models.rig import Fit, LawSpec, Rig
from models.schema import Quantity, declared, did_you_mean, number, refuse_impossible


def _numbers(kind: type, without: Iterable[str]) -> dict[str, str]:
    """Long names of the quantities of a class, but for some, by short ones."""
    entries = declared(kind).items()
    return {
        name: entry.key
        for name, entry in entries
        if isinstance(getattr(entry, "value", entry), Quantity) and name not in without
    }


_SLEEVE = _numbers(Sleeve, ("inner_radius", "poisson_ratio"))
_FIT = _numbers(Fit, ("interference",))
_RIG = _numbers(Rig, ("fastest_fitted",))
_LONG = _FIT | _RIG | _SLEEVE
"""Long names, with units, by short ones."""

_FRICTION = "friction"

_FACTOR = re.compile(r"x\s*(?P<number>[^\s%]+)")
_PERCENT = re.compile(r"(?P<number>[+-]\s*[^\s%]+)\s*%")


class _Amount(NamedTuple):
    """How a value changes: it is multiplied, or replaced."""

    factor: float = 1.0
    value: float | None = None

    def of(self, old: float) -> float:
        return old * self.factor if self.value is None else self.value


def changed_rig(rig: Rig, changes: Mapping[str, Any], where: str) -> Rig:
    """Return a rig with quantities changed; the one that is given stays as it is.

    Parameters
    ----------
    rig : Rig
    changes : mapping of str to str, float or mapping
        Factor, percentage or value by the quantity's name; a table goes by the name of an effect,
        or ``friction``.
    where : str
        What messages begin with.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        A name is unknown or means several quantities, or an amount cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> other = changed_rig(rig, {"critical_torque": "-20 %", "ageing_time": "x2"}, "rig")
    >>> round(other.fit(0.279e-3).critical_torque, 3), other.friction.parameters["ageing_time"]
    (9.424, 0.000552)
    """
    amounts: dict[str, _Amount] = {}
    for name, given in _flat(changes, where):
        target = _target(rig, name, where)
        if target in amounts:
            raise ParameterError(f"{where}: {target} is changed twice; give one change")
        amounts[target] = _amount(given, name, target, where)
    try:
        rig = _resized(rig, amounts, where)
        made = replace(
            rig,
            fits=tuple(replace(fit, **_changed(fit, _FIT, amounts)) for fit in rig.fits),
            friction=_changed_law(rig.friction, _FRICTION, amounts, where),
            effects=tuple(_changed_law(e, e.name, amounts, where) for e in rig.effects),
            **_changed(rig, _RIG, amounts),
        )
    except ParameterError as error:
        raise ParameterError(f"{where}: {str(error).removeprefix(f'{where}: ')}") from None
    refuse_impossible(made, where)
    return made


def multiplied(
    rig: Rig, changes: Mapping[str, Any], factors: Mapping[str, float]
) -> dict[str, str | float]:
    """Return changes to a rig with quantities of the bushing multiplied besides.

    Changes of effects are left out: who writes a rig file lists these as they have become.

    Parameters
    ----------
    rig : Rig
    changes : mapping of str to str, float or mapping
        As `changed_rig` has taken them.
    factors : mapping of str to float
        By short names [-].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> multiplied(load_material_rig("PDMS"), {"damping": "x2", "kinetic_torque_Nm": 8.0},
    ...            {"damping": 1.01, "kinetic_torque": 0.5, "critical_torque": 0.9})
    {'damping': 'x2.02', 'kinetic_torque_Nm': 4.0, 'critical_torque': 'x0.9'}
    """
    rest, found = dict(factors), dict[str, str | float]()
    for name, given in _flat(changes, "change"):
        target = _target(rig, name, "change")
        if target in _LONG or target.startswith(f"{_FRICTION}."):
            factor = rest.pop(target, 1.0)
            amount = _amount(given, name, target, "change")
            value = amount.value
            found[name] = f"x{amount.factor * factor:.6g}" if value is None else value * factor
    return found | {name: f"x{factor:.6g}" for name, factor in rest.items()}


def _flat(changes: Mapping[str, Any], where: str) -> Iterator[tuple[str, Any]]:
    for name, given in changes.items():
        if name == HARDNESS.key:
            yield _LONG["youngs_modulus"], shore_modulus(HARDNESS.read(given, where)) / 1e6
        elif isinstance(given, Mapping):
            yield from ((f"{name}.{key}", value) for key, value in given.items())
        else:
            yield name, given


def _target(rig: Rig, name: str, where: str) -> str:
    """Name what a change is of: the short name of a quantity of the bushing, or `law.parameter`."""
    owners = {_FRICTION: rig.friction, **{effect.name: effect for effect in rig.effects}}
    owner, dot, key = name.partition(".")
    if dot and owner == rig.friction.name:
        owner = _FRICTION
    if dot and owner in owners:
        return f"{owner}.{key}"
    if name.partition("_mm")[0] == "interference":
        raise ParameterError(
            f"{where}: {name} is an operating condition, not a property of the bushing; leave it "
            "out and ask for it with --interference"
        )
    # The whole name of a quantity of the bushing: that parameters end alike makes it no other.
    whole = [short for short, long in _LONG.items() if name in (short, long)]
    found = whole or [f"{own}.{name}" for own, law in owners.items() if name in law.parameters]
    if len(found) > 1:
        possible = " or ".join(found)
        raise ParameterError(f"{where}: {name} can mean {possible}; write which")
    if not found:
        parameters = {f"{own}.{key}": key for own, law in owners.items() for key in law.parameters}
        known = [*dict.fromkeys((*_LONG, *_LONG.values(), *parameters))]
        hint = did_you_mean(name, [*known, *parameters.values()])
        raise ParameterError(f"{where}: cannot change {name!r}{hint}; known are {', '.join(known)}")
    return found[0]


def _amount(given: Any, name: str, target: str, where: str) -> _Amount:
    stated = f"{where}: {name} = {given!r}"
    if isinstance(given, str):
        text, by = given.strip(), math.nan
        with suppress(ValueError):
            if found := _FACTOR.fullmatch(text):
                by = float(found["number"])
            elif found := _PERCENT.fullmatch(text):
                by = 1.0 + float(found["number"].replace(" ", "")) / 100.0
        if not 0.0 < by < math.inf:
            raise ParameterError(
                f"{stated} is not a valid change; write a factor above 0 such as 'x2', a "
                "percentage above -100 % with its sign such as '-20 %', or a number"
            )
        return _Amount(factor=by)
    to = number({name: given}, name, where, low=-math.inf)
    if target in _LONG and name != _LONG[target]:
        raise ParameterError(
            f"{stated} has no unit; write {_LONG[target]} = {to:g}, or a factor such as 'x2'"
        )
    if target in _LONG and not (to > 0.0 or (to == 0.0 and target == "elastomer_damping_share")):
        raise ParameterError(f"{stated} must be above 0")
    return _Amount(value=to)


def _resized(rig: Rig, amounts: Mapping[str, _Amount], where: str) -> Rig:
    """Return the rig with another sleeve, and what follows from that."""
    named = [name for name in _SLEEVE if name in amounts]
    if not named:
        return rig
    old = rig.sleeve
    if old is None:
        raise ParameterError(
            f"{where}: {named[0]} needs a [sleeve] table in the rig file, of what its fits were "
            "measured on: inner_radius_mm, wall_mm, length_mm, and hardness_shore_A or "
            "youngs_modulus_MPa"
        )
    units = {name: declared(Sleeve)[name].size for name in named}
    changed = {
        name: amounts[name].of(getattr(old, name) / unit) * unit for name, unit in units.items()
    }
    new = replace(old, **changed)
    torque = new.friction_torque(1.0, 1.0) / old.friction_torque(1.0, 1.0)
    stiffness = new.torsional_stiffness / old.torsional_stiffness
    return replace(
        rig,
        sleeve=new,
        elastomer_inertia=rig.elastomer_inertia * new.polar_area / old.polar_area,
        fits=tuple(
            replace(
                fit,
                elastomer_stiffness=stiffness * fit.elastomer_stiffness,
                critical_torque=torque * fit.critical_torque,
                kinetic_torque=torque * fit.kinetic_torque,
            )
            for fit in rig.fits
        ),
    )


def _changed(shown: Any, names: Iterable[str], amounts: Mapping[str, _Amount]) -> dict[str, Any]:
    """Return what becomes of the fields of an object that have an amount."""
    found: dict[str, Any] = {}
    for name in amounts.keys() & set(names):
        old, of = getattr(shown, name), amounts[name].of
        found[name] = {k: of(v) for k, v in old.items()} if isinstance(old, Mapping) else of(old)
    return found


def _changed_law(law: LawSpec, owner: str, amounts: Mapping[str, _Amount], where: str) -> LawSpec:
    parameters = dict(law.parameters)
    for target, amount in amounts.items():
        name = target.removeprefix(f"{owner}.")
        if name == target:
            continue
        old = parameters.get(name)
        if amount.value is None and not isinstance(old, int | float):
            stated = "does not state it as a number" if old is None else f"says {old!r}"
            raise ParameterError(
                f"{where}: {target} cannot be multiplied, since the rig {stated}; write its value "
                "as a number"
            )
        parameters[name] = amount.of(float(old) if isinstance(old, int | float) else 0.0)
    return replace(law, parameters=parameters) if parameters != law.parameters else law
