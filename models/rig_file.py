"""Rig files (TOML): reading with inheritance from a base, and writing.

A rig is the shipped bench, overridden by the material's file, overridden by the user's file.
``base`` names a material or another rig file whose values the file inherits; ``[change]`` then
multiplies or sets quantities. A file without ``base`` but with its own ``[[fit]]`` entries
describes its own bushing: constant critical and kinetic torque, damping split evenly, no effects,
unless it states otherwise. Under the name of a shipped material it must state the friction law.

The same file serves every command; ``[design]`` and ``[tolerances]`` are read where they are used.
Keys and bounds are declared in `models.rig` and `models.bench`.
"""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.bench import refuse_plate
from models.change import changed_rig
from models.errors import ParameterError
from models.foreign_file import LARGEST_TOML, reading, refusing
from models.rig import LawSpec, Rig
from models.schema import (
    as_table,
    as_text,
    declared,
    did_you_mean,
    read_table,
    refuse_unknown,
    table_of,
    toml_text,
)
from models.sensors import read_sensors

if TYPE_CHECKING:
    from models.transfer_functions.measured import MeasuredResponse

_DATA = resources.files("models") / "data"

_APART = {"base", "change", "measured_response", "design", "tolerances", "sensors"}
"""Keys that are not fields of `Rig`."""

_PLAIN_BUSHING = {"elastomer_damping_share": 0.5, "effects": [], "friction": {"law": "coulomb"}}

_RESPONSES = ("torque_to_acceleration", "torque_to_pressure")


def material_names() -> tuple[str, ...]:
    """Return the names of the shipped materials.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> "PDMS" in material_names()
    True
    """
    return tuple(sorted(Path(entry.name).stem for entry in (_DATA / "materials").iterdir()))


def shipped_name(name: str) -> str | None:
    """Return the exact name of a shipped material, or None; case does not matter.

    Examples
    --------
    >>> shipped_name("pdms"), shipped_name("our rubber")
    ('PDMS', None)
    """
    names = {each.lower(): each for each in material_names()}
    return names.get(name.strip().lower())


def material_of(path: Path) -> str | None:
    """Return the shipped material that a path of a rig file names, or None.

    Examples
    --------
    >>> material_of(Path("pdms")), material_of(Path("bench.toml"))
    ('PDMS', None)
    """
    return None if path.exists() else shipped_name(str(path))


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
    content = _bench() | _material(material)
    return read_table(Rig, content, f"material {material!r}")


def load_rig(path: str | Path) -> Rig:
    """Read a rig file.

    Parameters
    ----------
    path : path-like
        TOML file of the differences from the shipped bench; or, if there is no such file, the name
        of a shipped material.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        If the file cannot be read, or an entry cannot be used; the message names the key.

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
    """Read a TOML file, called `where` in messages.

    Raises
    ------
    ParameterError
        If the file cannot be read or is not valid TOML.
    """
    with reading(path, "valid TOML file", where=where, largest=LARGEST_TOML):
        return tomllib.loads(path.read_text(encoding="utf-8"))


def rig_from(content: Mapping[str, Any], folder: Path, where: str) -> Rig:
    """Build a rig from the content of a rig file in a folder.

    Raises
    ------
    ParameterError
        If an entry cannot be used; the message begins with `where` and names the key.

    Examples
    --------
    >>> rig_from({"material": "PDMS"}, Path(), "rig").friction.name
    'lugre'
    """
    with refusing(where, "rig file"):
        return _layered(content, folder, where, ())


def _bench() -> dict[str, Any]:
    return tomllib.loads((_DATA / "rigs" / "bench.toml").read_text(encoding="utf-8"))


def _material(name: str) -> dict[str, Any]:
    shipped = shipped_name(name)
    if shipped is None:
        names = material_names()
        raise ParameterError(
            f"material {name!r} is unknown{did_you_mean(name, names)}; there are {', '.join(names)}"
        )
    text = (_DATA / "materials" / f"{shipped}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text) | {"material": shipped}


def _layered(content: Mapping[str, Any], folder: Path, where: str, chain: tuple[Path, ...]) -> Rig:
    """Return the rig of a file's content; `chain` lists the files that refer to it."""
    if "suspension" in content:
        raise ParameterError(
            f"{where}: [suspension] is a car's bar in two bushings, which only simulate --rig "
            "takes; remove the table for the bushing on the rig"
        )
    keys = [entry.key for entry in declared(Rig).values()]
    refuse_unknown(content, {*keys, *_APART}, where)
    entries = {key: value for key, value in content.items() if key not in _APART}
    if "base" in content:
        base = _base(as_text(content["base"], "base", where), folder, where, chain)
        if "material" in entries:
            shipped = shipped_name(as_text(entries["material"], "material", where))
            if shipped not in (None, base.material):
                raise ParameterError(
                    f"{where}: material = {shipped!r} contradicts base, which is of "
                    f"{base.material}; leave material out"
                )
            entries["material"] = shipped or entries["material"]
    elif "fit" in entries:
        base = _own_bushing(entries, where)
    else:
        named = as_text(entries.get("material", _bench()["material"]), "material", where)
        base = load_material_rig(named)
        entries["material"] = base.material
    rig = read_table(Rig, entries, where, base)
    refuse_plate(rig.plate, f"{where}, plate")
    depends = rig.temperature
    if depends is not None and not depends.reference > depends.glass_transition:
        raise ParameterError(
            f"{where}, temperature: reference_C = {depends.reference:g} is not above "
            f"glass_transition_C = {depends.glass_transition:g}, below which rubber is no elastomer"
        )
    if "measured_response" in content:
        rig = replace(rig, measured=measured_responses(content["measured_response"], folder, where))
    if "sensors" in content:
        table = content["sensors"]
        rig = replace(rig, sensors=read_sensors(table, rig.sensors, f"{where}, sensors"))
    if "change" in content:
        rig = changed_rig(rig, as_table(content["change"], "change", where), f"{where}, change")
    return rig


def _base(named: str, folder: Path, where: str, chain: tuple[Path, ...]) -> Rig:
    if shipped_name(named) is not None:
        return load_material_rig(named)
    path = (folder / named).resolve()
    if path in chain:
        circle = " -> ".join(link.name for link in (*chain[chain.index(path) :], path))
        raise ParameterError(f"{where}: base = {named!r} leads back to itself: {circle}")
    if not path.is_file():
        names = material_names()
        raise ParameterError(
            f"{where}: base = {named!r} is neither a material nor a file"
            f"{did_you_mean(named, names)}; there are {', '.join(names)}"
        )
    below = f"{where}: base {named}"
    return _layered(read_toml(path, below), path.parent, below, (*chain, path))


def _own_bushing(entries: Mapping[str, Any], where: str) -> Rig:
    """Return a rig with the file's own fits: a plain bushing on the bench, without a sleeve."""
    bench = _bench()
    named = as_text(entries.get("material", bench["material"]), "material", where)
    shipped = shipped_name(named)
    law_is_named = "law" in as_table(entries.get("friction", {}), "friction", where)
    if "material" in entries and shipped is not None and not law_is_named:
        law = _material(shipped)["friction"]["law"]
        raise ParameterError(
            f"{where}: has its own [[fit]] under the name of {shipped}, but no friction law (that "
            f'of {shipped} is {law}): write base = "{shipped}" in place of material to keep law '
            f'and effects of {shipped}, or [friction] law = "coulomb" for constant torques'
        )
    del bench["sleeve"]
    return read_table(Rig, bench | _PLAIN_BUSHING | {"fit": entries["fit"]}, where)


def measured_responses(tables: Any, folder: Path, where: str) -> tuple[MeasuredResponse, ...]:
    """Read the measured responses of a rig file's ``[[measured_response]]`` entries.

    An entry names a support and the files of its responses from the torque on clamp and beams,
    with the bushing removed, to the acceleration, to the sound, or both.

    Parameters
    ----------
    tables : list of mapping
        Entries of the TOML file.
    folder : Path
        Folder of the rig file, to which names of files are relative.
    where : str
        Name of the rig file in messages.

    Raises
    ------
    ParameterError
        An entry or its file cannot be used.

    Examples
    --------
    >>> measured_responses([{"torque_to_pressure": "a.npz"}], Path("."), "rig file r.toml")
    Traceback (most recent call last):
    models.errors.ParameterError: rig file r.toml, measured_response 1: torque_to_pressure: ...
    """
    from models.transfer_functions.measured import MeasuredResponse, measured_with

    if not isinstance(tables, list):
        raise ParameterError(
            f"{where}: measured_response must be given as [[measured_response]] tables"
        )
    responses: list[MeasuredResponse] = []
    for i, content in enumerate(tables, start=1):
        here = f"{where}, measured_response {i}"
        table = dict(as_table(content, "measured_response", here))
        for key in table.keys() & set(_RESPONSES):
            table[key] = folder / as_text(table[key], key, here)
        entry = read_table(MeasuredResponse, table, here)
        if entry.torque_to_acceleration is entry.torque_to_pressure is None:
            raise ParameterError(f"{here}: names no response; give {' or '.join(_RESPONSES)}")
        if measured_with(tuple(responses), entry.support_stiffness) is not None:
            raise ParameterError(
                f"{here}: support_stiffness_Nm_rad = {entry.support_stiffness:g} has an entry "
                "already; give one a support"
            )
        responses.append(entry)
    return tuple(responses)


def rig_text(rig: Rig, notes: Sequence[str] = (), base: str | None = None) -> str:
    """Return the text of a rig file; numbers of the bushing have six significant digits.

    Parameters
    ----------
    rig : Rig
    notes : sequence of str
        Lines of comment at the top.
    base : str, optional
        Rig file from which structure, responses, sensors and material are inherited; by default
        they are those of the shipped bench. The sleeve is not written.

    Returns
    -------
    str

    Examples
    --------
    >>> print(rig_text(load_material_rig("fluorocarbon-thesis")).splitlines()[0])
    name = "bench"
    """
    front = {"material": rig.material} if base is None else {"base": base}
    stated = {"effects": [], "assumed": [], **table_of(rig)}
    for key in ("name", "material", "beams", "plate", "microphone", "sleeve"):
        stated.pop(key, None)
    return toml_text({"name": rig.name} | front | _rounded(stated), notes)


def changed_rig_text(
    base: str,
    changes: Mapping[str, str | float],
    effects: Sequence[LawSpec],
    tolerances: Mapping[str, float],
    notes: Sequence[str] = (),
) -> str:
    """Return the text of a rig file of the differences from another rig.

    Parameters
    ----------
    base : str
        Material or file, as from `base_name`.
    changes : mapping of str to str or float
        Entries of ``[change]``.
    effects : sequence of LawSpec
        All effects of the rig, including those of the base.
    tolerances : mapping of str to float
        Relative standard deviations [-]; ``"slip_pulse.amplitude"`` is that of an effect.
    notes : sequence of str
        Lines of comment at the top.

    Returns
    -------
    str

    Examples
    --------
    >>> print(changed_rig_text("PDMS", {"damping": "x1.03"}, (), {"damping": 0.02}))
    base = "PDMS"
    effects = []
    <BLANKLINE>
    [change]
    damping = "x1.03"
    <BLANKLINE>
    [tolerances]
    damping = 0.02
    <BLANKLINE>
    """
    tables: dict[str, Any] = {"change": _nested(changes), "tolerances": _nested(tolerances)}
    content: dict[str, Any] = {"base": base, "effects": [str(spec) for spec in effects]}
    content |= {name: table for name, table in tables.items() if table}
    return toml_text(_rounded(content), notes)


def _nested(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with entries ``law.parameter`` moved into tables by law."""
    nested: dict[str, Any] = {}
    for name, value in table.items():
        law, _, parameter = name.rpartition(".")
        (nested.setdefault(law, {}) if law else nested)[parameter] = value
    return nested


def _rounded(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(f"{value:.6g}") if is_number and math.isfinite(value) else value


def base_name(file: Path, folder: Path) -> str:
    """Return the ``base`` entry for a rig file, in a file of a folder.

    Parameters
    ----------
    file, folder : Path

    Returns
    -------
    str
        Path relative to the folder, or absolute on another drive.

    Examples
    --------
    >>> base_name(Path("bench/mine.toml"), Path("diagnosis")), base_name(Path("PDMS"), Path())
    ('../bench/mine.toml', './PDMS')
    """
    file = file.resolve()
    try:
        named = os.path.relpath(file, folder.resolve()).replace(os.sep, "/")
    except ValueError:  # another drive
        return file.as_posix()
    return f"./{named}" if shipped_name(named) is not None else named
