"""Rig and material files (TOML): read, check, and lay over the bench that is shipped.

A rig is the shipped bench, with what the material's file says of the bushing laid over it, with
what the user's file says laid over both. ``base`` names a material or another rig file instead, of
which all stays that the file does not say; ``[change]`` then multiplies or sets quantities. A file
without ``base`` that brings its own ``[[fit]]`` entries describes a bushing of its own: constant
critical and kinetic torque, damping split evenly, no effects, unless it says otherwise. Under the
name of a shipped material it must say which friction law it means.

The same file serves every command: what ``[design]`` and ``[tolerances]`` say is read where it is
used.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.checks import a_number, a_support, a_table, a_text, meant, refuse_unknown
from models.errors import ParameterError
from models.plausible import refuse_impossible
from models.recording import CHANNEL_UNITS
from models.rig import Fit, LawSpec, Rig
from models.rig_files.beams_file import read_beams
from models.rig_files.change import changed_rig
from models.rig_files.plate_file import a_microphone, a_plate

if TYPE_CHECKING:
    from models.transfer_functions.measured import MeasuredResponse

__all__ = [
    "load_material_rig",
    "load_rig",
    "material_names",
    "parse_spec",
    "read_toml",
    "rig_from",
]

_DATA = resources.files("models") / "data"

_KEYS = {
    "name",
    "material",
    "elastomer_inertia_kgm2",
    "clamp_inertia_kgm2",
    "elastomer_damping_share",
    "fastest_fitted_rad_s",
    "effects",
    "friction",
    "fit",
    "beams",
    "plate",
    "microphone",
    "assumed",
}

_APART = {"base", "change", "measured_response", "design", "tolerances", "sensors"}
"""Keys that are not laid over those of a base."""

_STRUCTURE = ("beams", "plate", "microphone")
"""Tables of which a file may give a part."""

_PLAIN_BUSHING = {
    "elastomer_damping_share": 0.5,
    "effects": [],
    "friction": {"law": "coulomb"},
}


def material_names() -> tuple[str, ...]:
    """Names of the materials that are shipped.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> "PDMS" in material_names()
    True
    """
    folder = _DATA / "materials"
    return tuple(sorted(Path(entry.name).stem for entry in folder.iterdir()))


def load_material_rig(material: str) -> Rig:
    """Return the shipped bench with a bushing of `material`; case does not matter.

    Parameters
    ----------
    material : str
        One of `material_names`.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        If the material is unknown.

    Examples
    --------
    >>> load_material_rig("fluorocarbon-thesis").fit(0.279e-3).critical_torque
    10.7
    """
    content, where = _bench() | _material(material), f"material {material!r}"
    return Rig(**_parts(content, where, _law(content["friction"], where, None)))


def load_rig(path: str | Path) -> Rig:
    """Read a rig file.

    Parameters
    ----------
    path : path-like
        TOML file of what differs from the shipped bench.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        If the file cannot be read, or holds what cannot be used; the message names the key.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "rig.toml"
    ...     size = path.write_text('material = "PDMS"', encoding="utf-8")
    ...     load_rig(path).material
    'PDMS'
    """
    path, where = Path(path), f"rig file {path}"
    return rig_from(read_toml(path, where), path.parent, where)


def read_toml(path: Path, where: str) -> dict[str, Any]:
    """Read a TOML file; `where` is what messages call it.

    Raises
    ------
    ParameterError
        If the file cannot be read or is no TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterError(f"{where}: {error.strerror or error}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterError(f"{where}: no valid TOML: {error}") from None


def rig_from(content: Mapping[str, Any], folder: Path, where: str) -> Rig:
    """Build a rig from what a rig file holds; `folder` is that of the files it names.

    Raises
    ------
    ParameterError
        If it holds what cannot be used; the message begins with `where` and names the key.

    Examples
    --------
    >>> rig_from({"material": "PDMS"}, Path(), "rig").friction.name
    'lugre'
    """
    return _laid(content, folder, where, ())[0]


def _laid(
    content: Mapping[str, Any], folder: Path, where: str, chain: tuple[Path, ...]
) -> tuple[Rig, dict[str, Any]]:
    """Rig of a file's content, and its tables of the structure; `chain` led to the file."""
    refuse_unknown(content, _KEYS | _APART, where)
    given = {key: value for key, value in content.items() if key not in _APART}
    tables = {name: a_table(given.pop(name, {}), name, where) for name in _STRUCTURE}
    if "base" in content:
        base, below = _base(a_text(content["base"], "base", where), folder, where, chain)
        tables = {name: below[name] | tables[name] for name in _STRUCTURE}
        _check_name(given, base, where)
        rig = replace(base, **_parts(given | tables, where, base.friction))
    else:
        bench = _bench()
        bushing = _bushing(given, bench["material"], where)
        tables = {name: bench[name] | tables[name] for name in _STRUCTURE}
        law = _law(bushing["friction"], "the bushing", None)
        rig = Rig(**_parts(bench | bushing | given | tables, where, law))
    if "measured_response" in content:
        rig = replace(rig, measured=_measured(content["measured_response"], folder, where))
    if "sensors" in content:
        rig = replace(rig, sensor_noise=_sensor_noise(content["sensors"], f"{where}, sensors"))
    refuse_impossible(rig, where)
    if "change" in content:
        rig = changed_rig(rig, a_table(content["change"], "change", where), f"{where}, change")
    return rig, tables


def _base(
    named: str, folder: Path, where: str, chain: tuple[Path, ...]
) -> tuple[Rig, dict[str, Any]]:
    material = _shipped(named)
    if material is not None:
        return load_material_rig(material), {name: _bench()[name] for name in _STRUCTURE}
    path = (folder / named).resolve()
    if path in chain:
        circle = " -> ".join(link.name for link in (*chain[chain.index(path) :], path))
        raise ParameterError(f"{where}: base = {named!r} leads back to itself: {circle}")
    if not path.is_file():
        raise ParameterError(
            f"{where}: base = {named!r} is neither a material nor a file"
            f"{meant(named, material_names())}; there are {', '.join(material_names())}"
        )
    below = f"{where}: base {named}"
    return _laid(read_toml(path, below), path.parent, below, (*chain, path))


def _shipped(name: str) -> str | None:
    known = {each.lower(): each for each in material_names()}
    return known.get(name.strip().lower())


def _check_name(given: dict[str, Any], base: Rig, where: str) -> None:
    """Refuse a base of one material under the name of another."""
    if "material" not in given:
        return
    shipped = _shipped(a_text(given["material"], "material", where))
    if shipped is not None and shipped != base.material:
        raise ParameterError(
            f"{where}: material = {given['material']!r} contradicts base, which is of "
            f"{base.material}; leave material out"
        )
    given["material"] = shipped or given["material"]


def _bushing(given: dict[str, Any], default: str, where: str) -> dict[str, Any]:
    """Tables of the bushing that a file without base is laid over."""
    named = a_text(given.get("material", default), "material", where)
    if "fit" not in given:
        bushing = _material(named)
        given["material"] = bushing["material"]
        return bushing
    shipped = _shipped(named)
    friction = a_table(given.get("friction", {}), "friction", where)
    if "material" in given and shipped is not None and "law" not in friction:
        law = _material(shipped)["friction"]["law"]
        raise ParameterError(
            f"{where}: brings its own [[fit]] under the name of {shipped}, whose friction law is "
            f'{law}, and does not say which law it means; write base = "{shipped}" in place of '
            f'material to keep law and effects of {shipped}, or [friction] law = "coulomb" for '
            "constant torques"
        )
    return _PLAIN_BUSHING


def _sensor_noise(table: Any, where: str) -> dict[str, float]:
    table = a_table(table, "sensors", where)
    refuse_unknown(table, {"noise"}, where)
    noise = table.get("noise", _FROM_RECORDINGS)
    if noise == _FROM_RECORDINGS:
        return {}
    if not isinstance(noise, Mapping):
        raise ParameterError(
            f'{where}: noise = {noise!r} must be "{_FROM_RECORDINGS}", or a table such as '
            "{ torque = 0.01, pressure = 2e-3 }"
        )
    refuse_unknown(noise, set(CHANNEL_UNITS), f"{where}, noise")
    return {name: a_number(noise, name, f"{where}, noise", closed=True) for name in noise}


_FROM_RECORDINGS = "from recordings"


def _measured(tables: Any, folder: Path, where: str) -> tuple[MeasuredResponse, ...]:
    from models.rig_files.measured_file import measured_responses  # brings numpy, help does without

    return measured_responses(tables, folder, where)


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


def _bench() -> dict[str, Any]:
    return tomllib.loads((_DATA / "rigs" / "bench.toml").read_text(encoding="utf-8"))


def _material(name: str) -> dict[str, Any]:
    known = _shipped(name)
    if known is None:
        raise ParameterError(
            f"material {name!r} is unknown{meant(name, material_names())}; there are "
            f"{', '.join(material_names())}"
        )
    text = (_DATA / "materials" / f"{known}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text) | {"material": known}


def _parts(given: Mapping[str, Any], where: str, law: LawSpec) -> dict[str, Any]:
    """Read the fields of a `Rig` that are given; `law` is the one that stays."""
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
        parts["friction"] = _law(given["friction"], where, law)
    if "effects" in given:
        effects = given["effects"]
        if not isinstance(effects, list):
            raise ParameterError(
                f'{where}: effects must be a list such as ["slip_pulse:amplitude=20"]'
            )
        parts["effects"] = tuple(
            parse_spec(a_text(e, "effects", where), f"{where}, effect") for e in effects
        )
    if "assumed" in given:
        parts["assumed"] = _texts(given["assumed"], "assumed", where)
    parts["beams"] = read_beams(given["beams"], f"{where}, beams")
    parts["plate"] = a_plate(given["plate"], f"{where}, plate")
    parts["microphone"] = a_microphone(given["microphone"], parts["plate"], f"{where}, microphone")
    return parts


_NUMBERS = {
    "elastomer_inertia_kgm2": "elastomer_inertia",
    "clamp_inertia_kgm2": "clamp_inertia",
    "fastest_fitted_rad_s": "fastest_fitted",
}


def _law(table: Any, where: str, stays: LawSpec | None) -> LawSpec:
    """Friction law of a table; one that names none changes parameters of the law that stays."""
    friction = dict(a_table(table, "friction", where))
    named = a_text(friction.pop("law", stays.name if stays else "coulomb"), "friction.law", where)
    for key in friction:
        a_number(friction, key, f"{where}, friction", low=-math.inf)
    if stays is not None and "law" not in table:
        friction = {**stays.parameters, **friction}
    return LawSpec(named, friction)


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
