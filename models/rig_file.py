"""Rig files (TOML): read and lay over a base, or over the bench that is shipped; write.

A rig is the shipped bench, with what the material's file states of the bushing laid over it, with
what the user's file states laid over both. ``base`` names a material or another rig file instead,
of which all stays that the file does not state; ``[change]`` then multiplies or sets quantities. A
file without ``base`` that brings its own ``[[fit]]`` entries describes a bushing of its own:
constant critical and kinetic torque, damping split evenly, no effects, unless it says otherwise.
Under the name of a shipped material it must say which friction law it means.

The same file serves every command: what ``[design]`` and ``[tolerances]`` state is read where it is
used. Keys and bounds are declared in `models.rig` and `models.bench`.
"""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.bench import refuse_plate
from models.change import changed_rig
from models.errors import ParameterError
from models.foreign_file import LARGEST_TOML, ExcessError, reading, refusing
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
from models.sensors import read_sensors, sensors_table

if TYPE_CHECKING:
    from models.transfer_functions.measured import MeasuredResponse

_DATA = resources.files("models") / "data"

_APART = {"base", "change", "measured_response", "design", "tolerances", "sensors"}
"""Keys that are read here, or by who uses them."""

_MOST_DOTS = 200
"""Of a key of TOML: the time to read it grows with their square."""

_PLAIN_BUSHING = {
    "elastomer_damping_share": 0.5,
    "effects": [],
    "friction": {"law": "coulomb"},
}

_RESPONSES = ("torque_to_acceleration", "torque_to_pressure")


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
    return tuple(sorted(Path(entry.name).stem for entry in (_DATA / "materials").iterdir()))


def shipped_name(name: str) -> str | None:
    """Return the name of a shipped material as it is written; case does not matter.

    Examples
    --------
    >>> shipped_name("pdms"), shipped_name("our rubber")
    ('PDMS', None)
    """
    known = {each.lower(): each for each in material_names()}
    return known.get(name.strip().lower())


def material_of(path: Path) -> str | None:
    """Return the shipped material that stands in the place of a rig file, None where none does.

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
        If the file cannot be read or is not valid TOML.
    """
    with reading(path, "valid TOML file", where=where, largest=LARGEST_TOML):
        text = path.read_text(encoding="utf-8")
        for line in text.splitlines():
            if line.count(".") > _MOST_DOTS and not line.lstrip().startswith("#"):
                parts = re.split(r"[=,{}\[\]]", line)
                if max(part.count(".") for part in parts) > _MOST_DOTS:
                    raise ExcessError(f"has a key of more than {_MOST_DOTS} parts")
        return tomllib.loads(text)


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
        return _laid(content, folder, where, ())


def _bench() -> dict[str, Any]:
    return tomllib.loads((_DATA / "rigs" / "bench.toml").read_text(encoding="utf-8"))


def _material(name: str) -> dict[str, Any]:
    known = shipped_name(name)
    if known is None:
        names = material_names()
        raise ParameterError(
            f"material {name!r} is unknown{did_you_mean(name, names)}; there are {', '.join(names)}"
        )
    text = (_DATA / "materials" / f"{known}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text) | {"material": known}


def _laid(content: Mapping[str, Any], folder: Path, where: str, chain: tuple[Path, ...]) -> Rig:
    """Rig of a file's content; `chain` led to the file."""
    if "suspension" in content:
        raise ParameterError(
            f"{where}: [suspension] is a car's bar in two bushings, which simulate --rig alone "
            "takes; take the table out for the bushing on the rig"
        )
    keys = [entry.key for entry in declared(Rig).values()]
    refuse_unknown(content, {*keys, *_APART}, where)
    given = {key: value for key, value in content.items() if key not in _APART}
    if "base" in content:
        base = _base(as_text(content["base"], "base", where), folder, where, chain)
        _check_name(given, base, where)
    elif "fit" in given:
        base = _own_bushing(given, where)
    else:
        named = as_text(given.get("material", _bench()["material"]), "material", where)
        base = load_material_rig(named)
        given["material"] = base.material
    rig = read_table(Rig, given, where, base)
    refuse_plate(rig.plate, f"{where}, plate")
    depends = rig.temperature
    if depends is not None and not depends.reference > depends.glass_transition:
        raise ParameterError(
            f"{where}, temperature: reference_C = {depends.reference:g} is not above "
            f"glass_transition_C = {depends.glass_transition:g}; what is no elastomer there has no "
            "friction to be shifted"
        )
    if "measured_response" in content:
        rig = replace(rig, measured=measured_responses(content["measured_response"], folder, where))
    if "sensors" in content:
        table = content["sensors"]
        rig = replace(rig, sensors=read_sensors(table, rig.sensors, folder, f"{where}, sensors"))
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
    return _laid(read_toml(path, below), path.parent, below, (*chain, path))


def _check_name(given: dict[str, Any], base: Rig, where: str) -> None:
    """Refuse a base of one material under the name of another."""
    if "material" not in given:
        return
    shipped = shipped_name(as_text(given["material"], "material", where))
    if shipped is not None and shipped != base.material:
        raise ParameterError(
            f"{where}: material = {given['material']!r} contradicts base, which is of "
            f"{base.material}; leave material out"
        )
    given["material"] = shipped or given["material"]


def _own_bushing(given: Mapping[str, Any], where: str) -> Rig:
    """Rig with fits of a file's own: a plain bushing on the bench, whose sleeve is not its own."""
    bench = _bench()
    named = as_text(given.get("material", bench["material"]), "material", where)
    shipped = shipped_name(named)
    law_is_named = "law" in as_table(given.get("friction", {}), "friction", where)
    if "material" in given and shipped is not None and not law_is_named:
        law = _material(shipped)["friction"]["law"]
        raise ParameterError(
            f"{where}: has its own [[fit]] under the name of {shipped}, but no friction law (that "
            f'of {shipped} is {law}): write base = "{shipped}" in place of material to keep law '
            f'and effects of {shipped}, or [friction] law = "coulomb" for constant torques'
        )
    del bench["sleeve"]
    return read_table(Rig, bench | _PLAIN_BUSHING | {"fit": given["fit"]}, where)


def measured_responses(tables: Any, folder: Path, where: str) -> tuple[MeasuredResponse, ...]:
    """Read what the ``[[measured_response]]`` entries of a rig file name.

    An entry names a support and the files of its responses from the torque that the bushing puts
    into clamp and beams, bushing removed, to the acceleration, to the sound, or both.

    Parameters
    ----------
    tables : list of mapping
        As the TOML file holds them.
    folder : Path
        Of the rig file; names of files are relative to it.
    where : str
        What messages call the rig file.

    Raises
    ------
    ParameterError
        An entry, or a file that it names, cannot be used.

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
    found: list[MeasuredResponse] = []
    for i, given in enumerate(tables, start=1):
        here = f"{where}, measured_response {i}"
        table = dict(as_table(given, "measured_response", here))
        for key in table.keys() & set(_RESPONSES):
            table[key] = folder / as_text(table[key], key, here)
        entry = read_table(MeasuredResponse, table, here)
        if entry.torque_to_acceleration is entry.torque_to_pressure is None:
            raise ParameterError(f"{here}: names no response; give {' or '.join(_RESPONSES)}")
        if measured_with(tuple(found), entry.support_stiffness) is not None:
            raise ParameterError(
                f"{here}: support_stiffness_Nm_rad = {entry.support_stiffness:g} has an entry "
                "already; give one a support"
            )
        found.append(entry)
    return tuple(found)


def rig_text(rig: Rig, notes: Sequence[str] = (), base: str | None = None) -> str:
    """Write a rig as a file; numbers of the bushing have six significant digits.

    Parameters
    ----------
    rig : Rig
    notes : sequence of str
        Lines of comment at the top.
    base : str, optional
        Rig file whose structure, responses, sensors and material stay. Without one the structure
        is written where it is another than the shipped bench's; responses and sleeve are not.

    Returns
    -------
    str

    Examples
    --------
    >>> print(rig_text(load_material_rig("fluorocarbon-thesis")).splitlines()[0])
    name = "bench"
    """
    structure = ("beams", "plate", "microphone")
    if base is None:
        bench = load_material_rig(_bench()["material"])
        same = [name for name in structure if getattr(rig, name) == getattr(bench, name)]
        front = {"name": rig.name, "material": rig.material}
    else:
        same, front = [*structure, "material"], {"name": rig.name, "base": base}
    stated = {"effects": [], "assumed": [], **table_of(rig)}
    stated |= {name: table_of(getattr(rig, name), whole=True) for name in structure}
    table = front | {k: _rounded(v) for k, v in stated.items() if k not in (*same, "sleeve")}
    if base is None and (sensors := sensors_table(rig.sensors)):
        table["sensors"] = sensors
    return toml_text(table, notes)


def changed_rig_text(
    base: str,
    changes: Mapping[str, str | float],
    effects: Sequence[LawSpec],
    tolerances: Mapping[str, float],
    notes: Sequence[str] = (),
    friction: LawSpec | None = None,
    heard: Mapping[str, str | float] | None = None,
) -> str:
    """Write a rig file of what differs from another rig.

    Parameters
    ----------
    base : str
        Material or file, as `base_name` gives it.
    changes : mapping of str to str or float
        As ``[change]`` takes them.
    effects : sequence of LawSpec
        All that the rig has, those of the base as well.
    tolerances : mapping of str to float
        Relative standard deviations [-]; ``"slip_pulse.amplitude"`` is one of an effect.
    notes : sequence of str
        Lines of comment at the top.
    friction : LawSpec, optional
        The law where it is another than that of the base.
    heard : mapping of str to str or float, optional
        The condition that the app begins with, as ``[design.heard]`` takes it [unit of the key].

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
    tables: dict[str, Any] = {
        "friction": {} if friction is None else {"law": friction.name, **friction.parameters},
        "change": _nested(changes),
        "tolerances": _nested(tolerances),
        "design": {"heard": heard} if heard else {},
    }
    content: dict[str, Any] = {"base": base, "effects": [str(spec) for spec in effects]}
    content |= {name: table for name, table in tables.items() if table}
    return toml_text(_rounded(content), notes)


def _nested(table: Mapping[str, Any]) -> dict[str, Any]:
    """Put ``law.parameter`` into a table of the law."""
    found: dict[str, Any] = {}
    for name, value in table.items():
        law, _, parameter = name.rpartition(".")
        (found.setdefault(law, {}) if law else found)[parameter] = value
    return found


def _rounded(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(f"{value:.6g}") if is_number and math.isfinite(value) else value


def base_name(file: Path, folder: Path) -> str:
    """Name a rig file as ``base`` in a file of a folder does.

    Parameters
    ----------
    file, folder : Path

    Returns
    -------
    str
        Relative to the folder; absolute where nothing leads from one to the other.

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
