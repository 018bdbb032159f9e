"""Changes to a rig: factors, percentages and values for named quantities.

A quantity of the bushing has a short name, ``damping``, and a long one with its unit,
``damping_Nms_rad``. ``"x2"`` and ``"-20 %"`` are allowed with both, a bare number with the long one
only; it is then the value at every fit and support. Parameters of the friction law and of effects
have names such as ``slip_pulse.amplitude``, or just ``ageing_time`` if that is unambiguous. A name
of the bushing always means the bushing, even if an effect has a parameter of the same name, such as
``room_reflections.length``.

Size and modulus of the rubber, ``wall_mm``, ``length_mm``, ``youngs_modulus_MPa`` or
``hardness_shore_A``, scale the bushing: its torques with contact pressure, area and radius by
`models.bushing`, its stiffness and inertia with those of the sleeve. Damping and friction law do
not change.
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
    """Return the long names of the quantities of a class by short name, without some."""
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
"""Long names, with units, by short name."""

_FRICTION = "friction"

_FACTOR = re.compile(r"x\s*(?P<number>[^\s%]+)")
_PERCENT = re.compile(r"(?P<number>[+-]\s*[^\s%]+)\s*%")


class _Amount(NamedTuple):
    """Change of a value: a factor, or a new value."""

    factor: float = 1.0
    value: float | None = None

    def of(self, old: float) -> float:
        return old * self.factor if self.value is None else self.value


def changed_rig(rig: Rig, changes: Mapping[str, Any], where: str) -> Rig:
    """Return a rig with quantities changed.

    Parameters
    ----------
    rig : Rig
    changes : mapping of str to str, float or mapping
        Factor, percentage or value by the quantity's name; a table by the name of an effect, or
        ``friction``.
    where : str
        Prefix of messages.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        A name is unknown or ambiguous, or an amount cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> other = changed_rig(rig, {"critical_torque": "-20 %", "ageing_time": "x2"}, "rig")
    >>> round(other.fit(0.279e-3).critical_torque, 3), other.friction.parameters["ageing_time"]
    (9.424, 0.000552)
    """
    amounts: dict[str, _Amount] = {}
    for name, change in _flat(changes, where):
        target = _target(rig, name, where)
        if target in amounts:
            raise ParameterError(f"{where}: {target} is changed twice; give one change")
        amounts[target] = _amount(change, name, target, where)
    try:
        rig = _resized(rig, amounts, where)
        changed = replace(
            rig,
            fits=tuple(replace(fit, **_changed(fit, _FIT, amounts)) for fit in rig.fits),
            friction=_changed_law(rig.friction, _FRICTION, amounts, where),
            effects=tuple(_changed_law(e, e.name, amounts, where) for e in rig.effects),
            **_changed(rig, _RIG, amounts),
        )
    except ParameterError as error:
        raise ParameterError(f"{where}: {str(error).removeprefix(f'{where}: ')}") from None
    refuse_impossible(changed, where)
    return changed


def multiplied(
    rig: Rig, changes: Mapping[str, Any], factors: Mapping[str, float]
) -> dict[str, str | float]:
    """Return changes to a rig combined with factors on quantities of the bushing.

    Changes of effects are left out, since a rig file lists the changed effects themselves.

    Parameters
    ----------
    rig : Rig
    changes : mapping of str to str, float or mapping
        As for `changed_rig`.
    factors : mapping of str to float
        Factors by short name [-].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> multiplied(load_material_rig("PDMS"), {"damping": "x2", "kinetic_torque_Nm": 8.0},
    ...            {"damping": 1.01, "kinetic_torque": 0.5, "critical_torque": 0.9})
    {'damping': 'x2.02', 'kinetic_torque_Nm': 4.0, 'critical_torque': 'x0.9'}
    """
    rest, combined = dict(factors), dict[str, str | float]()
    for name, change in _flat(changes, "change"):
        target = _target(rig, name, "change")
        if target in _LONG or target.startswith(f"{_FRICTION}."):
            factor = rest.pop(target, 1.0)
            amount = _amount(change, name, target, "change")
            value = amount.value
            combined[name] = f"x{amount.factor * factor:.6g}" if value is None else value * factor
    return combined | {name: f"x{factor:.6g}" for name, factor in rest.items()}


def _flat(changes: Mapping[str, Any], where: str) -> Iterator[tuple[str, Any]]:
    for name, change in changes.items():
        if name == HARDNESS.key:
            yield _LONG["youngs_modulus"], shore_modulus(HARDNESS.read(change, where)) / 1e6
        elif isinstance(change, Mapping):
            yield from ((f"{name}.{key}", value) for key, value in change.items())
        else:
            yield name, change


def _target(rig: Rig, name: str, where: str) -> str:
    """Return the target of a change: the short name of a quantity, or `law.parameter`."""
    owners = {_FRICTION: rig.friction, **{effect.name: effect for effect in rig.effects}}
    owner, dot, key = name.partition(".")
    if dot and owner == rig.friction.name:
        owner = _FRICTION
    if dot and owner in owners:
        return f"{owner}.{key}"
    # A full name of the bushing takes precedence over parameters of the same name.
    whole = [short for short, long in _LONG.items() if name in (short, long)]
    targets = whole or [f"{own}.{name}" for own, law in owners.items() if name in law.parameters]
    if len(targets) > 1:
        possible = " or ".join(targets)
        raise ParameterError(f"{where}: {name} can mean {possible}; write the full name")
    if not targets:
        parameters = {f"{own}.{key}": key for own, law in owners.items() for key in law.parameters}
        names = [*dict.fromkeys((*_LONG, *_LONG.values(), *parameters))]
        hint = did_you_mean(name, [*names, *parameters.values()])
        raise ParameterError(f"{where}: cannot change {name!r}{hint}; known are {', '.join(names)}")
    return targets[0]


def _amount(change: Any, name: str, target: str, where: str) -> _Amount:
    stated = f"{where}: {name} = {change!r}"
    if isinstance(change, str):
        text, by = change.strip(), math.nan
        with suppress(ValueError):
            if match := _FACTOR.fullmatch(text):
                by = float(match["number"])
            elif match := _PERCENT.fullmatch(text):
                by = 1.0 + float(match["number"].replace(" ", "")) / 100.0
        if not 0.0 < by < math.inf:
            raise ParameterError(
                f"{stated} is not a valid change; write a factor above 0 such as 'x2', a "
                "percentage above -100 % with its sign such as '-20 %', or a number"
            )
        return _Amount(factor=by)
    to = number({name: change}, name, where, low=-math.inf)
    if target in _LONG and name != _LONG[target]:
        raise ParameterError(
            f"{stated} has no unit; write {_LONG[target]} = {to:g}, or a factor such as 'x2'"
        )
    if target in _LONG and not (to > 0.0 or (to == 0.0 and target == "elastomer_damping_share")):
        raise ParameterError(f"{stated} must be above 0")
    return _Amount(value=to)


def _resized(rig: Rig, amounts: Mapping[str, _Amount], where: str) -> Rig:
    """Return a rig with a changed sleeve, and its bushing scaled accordingly."""
    named = [name for name in _SLEEVE if name in amounts]
    if not named:
        return rig
    old = rig.sleeve
    if old is None:
        raise ParameterError(
            f"{where}: {named[0]} needs a [sleeve] table in the rig file, for the sleeve of "
            "its fits: inner_radius_mm, wall_mm, length_mm, and hardness_shore_A or "
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


def _changed(obj: Any, names: Iterable[str], amounts: Mapping[str, _Amount]) -> dict[str, Any]:
    """Return the new values of the fields of an object that have an amount."""
    values: dict[str, Any] = {}
    for name in amounts.keys() & set(names):
        old, of = getattr(obj, name), amounts[name].of
        values[name] = {k: of(v) for k, v in old.items()} if isinstance(old, Mapping) else of(old)
    return values


def _changed_law(law: LawSpec, owner: str, amounts: Mapping[str, _Amount], where: str) -> LawSpec:
    parameters = dict(law.parameters)
    for target, amount in amounts.items():
        name = target.removeprefix(f"{owner}.")
        if name == target:
            continue
        old = parameters.get(name)
        if amount.value is None and not isinstance(old, int | float):
            stated = "does not state it as a number" if old is None else f"states {old!r}"
            raise ParameterError(
                f"{where}: {target} cannot be multiplied, since the rig {stated}; write its value "
                "as a number"
            )
        parameters[name] = amount.of(float(old) if isinstance(old, int | float) else 0.0)
    return replace(law, parameters=parameters) if parameters != law.parameters else law
