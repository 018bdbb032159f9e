"""Rig files (TOML): read, check, and lay over a base, or the bench that is shipped.

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

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.checks import a_table, a_text, meant, refuse_unknown
from models.errors import ParameterError
from models.foreign_file import LARGEST_TOML, parse_toml, reading, refusing
from models.plausible import refuse_impossible
from models.rig import Rig
from models.rig_files.change import changed_rig
from models.rig_files.rig_parts import RIG_KEYS, friction_law, rig_parts
from models.rig_files.sensors_file import read_sensors
from models.rig_files.shipped import (
    bench_content,
    material_content,
    material_names,
    material_of,
    shipped_name,
)
from models.rig_files.sleeve_file import read_sleeve

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.transfer_functions.measured import MeasuredResponse

__all__ = [
    "load_material_rig",
    "load_rig",
    "read_toml",
    "rig_from",
]

_APART = {"base", "change", "measured_response", "design", "tolerances", "sensors", "sleeve"}
"""Keys that are not laid over those of a base."""

_STRUCTURE = ("beams", "plate", "microphone")
"""Tables of which a file may give a part."""

_PLAIN_BUSHING = {
    "elastomer_damping_share": 0.5,
    "effects": [],
    "friction": {"law": "coulomb"},
}


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
    content, where = bench_content() | material_content(material), f"material {material!r}"
    return Rig(**rig_parts(content, where, friction_law(content["friction"], where, None)))


def load_rig(path: str | Path) -> Rig:
    """Read a rig file.

    Parameters
    ----------
    path : path-like
        TOML file of what differs from the shipped bench; or, where there is no such file, the name
        of a shipped material.

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
    if (material := material_of(path)) is not None:
        return load_material_rig(material)
    return rig_from(read_toml(path, where), path.parent, where)


def read_toml(path: Path, where: str) -> dict[str, Any]:
    """Read a TOML file; `where` is what messages call it.

    Raises
    ------
    ParameterError
        If the file cannot be read or is no TOML.
    """
    with reading(path, "TOML", where=where, largest=LARGEST_TOML):
        return parse_toml(path.read_text(encoding="utf-8"))


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
    with refusing(where, "rig file"):
        return _laid(content, folder, where, ())[0]


def _laid(
    content: Mapping[str, Any], folder: Path, where: str, chain: tuple[Path, ...]
) -> tuple[Rig, dict[str, Any]]:
    """Rig of a file's content, and its tables of the structure; `chain` led to the file."""
    if "suspension" in content:
        raise ParameterError(
            f"{where}: [suspension] is a car's bar in two bushings, which simulate --rig alone "
            "takes; take the table out for the bushing on the rig"
        )
    refuse_unknown(content, RIG_KEYS | _APART, where)
    given = {key: value for key, value in content.items() if key not in _APART}
    tables = {name: a_table(given.pop(name, {}), name, where) for name in _STRUCTURE}
    if "base" in content:
        base, below = _base(a_text(content["base"], "base", where), folder, where, chain)
        tables = {name: below[name] | tables[name] for name in _STRUCTURE}
        _check_name(given, base, where)
        rig = replace(base, **rig_parts(given | tables, where, base.friction))
    else:
        bench = bench_content()
        if "fit" in given:
            del bench["sleeve"]  # the fits are of a bushing of its own
        bushing = _bushing(given, bench["material"], where)
        tables = {name: bench[name] | tables[name] for name in _STRUCTURE}
        law = friction_law(bushing["friction"], "the bushing", None)
        rig = Rig(**rig_parts(bench | bushing | given | tables, where, law))
    if "measured_response" in content:
        rig = replace(rig, measured=_measured(content["measured_response"], folder, where))
    if "sensors" in content:
        table = content["sensors"]
        rig = replace(rig, sensors=read_sensors(table, rig.sensors, folder, f"{where}, sensors"))
    if "sleeve" in content:
        table = content["sleeve"]
        rig = replace(rig, sleeve=read_sleeve(table, rig.sleeve, f"{where}, sleeve"))
    refuse_impossible(rig, where)
    if "change" in content:
        rig = changed_rig(rig, a_table(content["change"], "change", where), f"{where}, change")
    return rig, tables


def _base(
    named: str, folder: Path, where: str, chain: tuple[Path, ...]
) -> tuple[Rig, dict[str, Any]]:
    material = shipped_name(named)
    if material is not None:
        return load_material_rig(material), {name: bench_content()[name] for name in _STRUCTURE}
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


def _check_name(given: dict[str, Any], base: Rig, where: str) -> None:
    """Refuse a base of one material under the name of another."""
    if "material" not in given:
        return
    shipped = shipped_name(a_text(given["material"], "material", where))
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
        bushing = material_content(named)
        given["material"] = bushing["material"]
        return bushing
    shipped = shipped_name(named)
    friction = a_table(given.get("friction", {}), "friction", where)
    if "material" in given and shipped is not None and "law" not in friction:
        law = material_content(shipped)["friction"]["law"]
        raise ParameterError(
            f"{where}: brings its own [[fit]] under the name of {shipped}, whose friction law is "
            f'{law}, and does not say which law it means; write base = "{shipped}" in place of '
            f'material to keep law and effects of {shipped}, or [friction] law = "coulomb" for '
            "constant torques"
        )
    return _PLAIN_BUSHING


def _measured(tables: Any, folder: Path, where: str) -> tuple[MeasuredResponse, ...]:
    from models.rig_files.measured_file import measured_responses  # brings numpy, help does without

    return measured_responses(tables, folder, where)
