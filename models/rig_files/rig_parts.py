"""The fields of a rig, read and checked from the tables of a rig or material file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from models.checks import a_number, a_support, a_table, a_text, refuse_unknown
from models.errors import ParameterError
from models.rig import Fit, LawSpec
from models.rig_files.beams_file import read_beams
from models.rig_files.plate_file import a_microphone, a_plate
from models.rig_files.sleeve_file import read_sleeve
from models.rig_files.temperature_file import read_temperature

__all__ = ["RIG_KEYS", "friction_law", "parse_spec", "rig_parts"]

RIG_KEYS = {
    "name",
    "material",
    "elastomer_inertia_kgm2",
    "clamp_inertia_kgm2",
    "elastomer_damping_share",
    "fastest_fitted_rad_s",
    "effects",
    "friction",
    "fit",
    "sleeve",
    "beams",
    "plate",
    "microphone",
    "assumed",
    "temperature",
}
"""Keys that `rig_parts` reads."""

_NUMBERS = {
    "elastomer_inertia_kgm2": "elastomer_inertia",
    "clamp_inertia_kgm2": "clamp_inertia",
    "fastest_fitted_rad_s": "fastest_fitted",
}


def rig_parts(given: Mapping[str, Any], where: str, law: LawSpec) -> dict[str, Any]:
    """Read the fields of a `Rig` that are given; those of the structure always are.

    Parameters
    ----------
    given : mapping
        As the TOML file holds them.
    where : str
        What messages begin with.
    law : LawSpec
        The friction law that stays where the table of friction names none.

    Returns
    -------
    dict of str to object

    Raises
    ------
    ParameterError
        A value cannot be used; the message names its key.

    Examples
    --------
    >>> from models.rig_files.shipped import bench_content
    >>> given = bench_content() | {"clamp_inertia_kgm2": 1e-3}
    >>> rig_parts(given, "rig", LawSpec("coulomb"))["clamp_inertia"]
    0.001
    """
    parts: dict[str, Any] = {}
    for key in ("name", "material"):
        if key in given:
            parts[key] = a_text(given[key], key, where)
    for key, field in _NUMBERS.items():
        if key in given:
            parts[field] = a_number(given, key, where)
    if "elastomer_damping_share" in given:
        parts["elastomer_damping_share"] = a_number(
            given, "elastomer_damping_share", where, low=0.0, high=1.0, closed=True
        )
    if "fit" in given:
        parts["fits"] = _fits(given["fit"], where)
    if "friction" in given:
        parts["friction"] = friction_law(given["friction"], where, law)
    if "effects" in given:
        effects = given["effects"]
        if not isinstance(effects, list):
            raise ParameterError(
                f'{where}: effects must be a list such as ["slip_pulse:amplitude=20"]'
            )
        parts["effects"] = tuple(
            parse_spec(a_text(e, "effects", where), f"{where}, effect") for e in effects
        )
    if "sleeve" in given:
        parts["sleeve"] = read_sleeve(given["sleeve"], None, f"{where}, sleeve")
    if "temperature" in given:
        parts["temperature"] = read_temperature(given["temperature"], where)
    if "assumed" in given:
        parts["assumed"] = _texts(given["assumed"], "assumed", where)
    parts["beams"] = read_beams(given["beams"], f"{where}, beams")
    parts["plate"] = a_plate(given["plate"], f"{where}, plate")
    parts["microphone"] = a_microphone(given["microphone"], parts["plate"], f"{where}, microphone")
    return parts


def _fits(tables: Any, where: str) -> tuple[Fit, ...]:
    if not isinstance(tables, list):
        raise ParameterError(f"{where}: fit must be given as [[fit]] tables")
    fits = tuple(
        sorted(
            (_fit(table, f"{where}, fit {i + 1}") for i, table in enumerate(tables)),
            key=lambda fit: fit.interference,
        )
    )
    if not fits:
        raise ParameterError(f"{where}: needs at least one [[fit]]")
    if len({fit.interference for fit in fits}) < len(fits):
        raise ParameterError(f"{where}: two [[fit]] entries have the same interference_mm")
    return fits


def _texts(value: Any, key: str, where: str) -> tuple[str, ...]:
    if not isinstance(value, list):
        raise ParameterError(f"{where}: {key} must be a list of texts")
    return tuple(a_text(item, key, where) for item in value)


def _fit(table: Any, where: str) -> Fit:
    table = a_table(table, "fit", where)
    refuse_unknown(
        table,
        {
            "interference_mm",
            "elastomer_stiffness_Nm_rad",
            "critical_torque_Nm",
            "kinetic_torque_Nm",
            "damping_Nms_rad",
        },
        where,
    )
    critical = a_number(table, "critical_torque_Nm", where)
    kinetic = a_number(table, "kinetic_torque_Nm", where)
    if critical < kinetic:
        raise ParameterError(
            f"{where}: critical_torque_Nm = {critical:g} is below kinetic_torque_Nm = {kinetic:g}; "
            "a contact cannot break below the torque at which it slides"
        )
    damping = table.get("damping_Nms_rad")
    by_support = damping if isinstance(damping, Mapping) else {"fixed": damping}
    if not by_support:
        raise ParameterError(f"{where}: damping_Nms_rad is empty")
    return Fit(
        interference=1e-3 * a_number(table, "interference_mm", where),
        elastomer_stiffness=a_number(table, "elastomer_stiffness_Nm_rad", where),
        critical_torque=critical,
        kinetic_torque=kinetic,
        damping={
            a_support(key, "damping_Nms_rad", where): a_number(
                {"damping_Nms_rad": value}, "damping_Nms_rad", where, high=1e3, closed=True
            )
            for key, value in by_support.items()
        },
    )


def friction_law(table: Any, where: str, stays: LawSpec | None) -> LawSpec:
    """Friction law of a table; one that names none changes parameters of the law that stays.

    Raises
    ------
    ParameterError
        It is no table, or a parameter no number.

    Examples
    --------
    >>> friction_law({"first_speed": 2.0}, "rig", LawSpec("stribeck_exponential")).name
    'stribeck_exponential'
    """
    friction = dict(a_table(table, "friction", where))
    named = a_text(friction.pop("law", stays.name if stays else "coulomb"), "friction.law", where)
    for key in friction:
        a_number(friction, key, f"{where}, friction", low=-math.inf)
    if stays is not None and "law" not in table:
        friction = {**stays.parameters, **friction}
    return LawSpec(named, friction)


def parse_spec(text: str, where: str = "effect") -> LawSpec:
    """Parse ``name:key=value,key=value``.

    Raises
    ------
    ParameterError
        If the text has another form.

    Examples
    --------
    >>> parse_spec("slip_pulse:amplitude=120,threshold=3")
    LawSpec(name='slip_pulse', parameters={'amplitude': 120.0, 'threshold': 3.0})
    """
    name, _, rest = text.partition(":")
    parameters: dict[str, float | str] = {}
    for part in filter(None, (p.strip() for p in rest.split(","))):
        key, equals, value = part.partition("=")
        if not (equals and key.strip() and value.strip()):
            raise ParameterError(f"{where} {text!r}: write it as NAME:key=value,key=value")
        try:
            parameters[key.strip()] = float(value)
        except ValueError:
            parameters[key.strip()] = value.strip()
    if not name.strip():
        raise ParameterError(f"{where} {text!r}: write it as NAME:key=value,key=value")
    return LawSpec(name.strip(), parameters)
