"""Rig and material files (TOML): read, check, and lay over the bench that is shipped.

A rig is the shipped bench, with what the material's file says of the bushing laid over it, with
what the user's file says laid over both. A file that brings its own ``[[fit]]`` entries describes
a bushing of its own: constant critical and kinetic torque, damping split evenly, no effects,
unless it says otherwise.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.checks import a_number, a_support, a_table, a_text, refuse_unknown
from models.errors import ParameterError
from models.rig import Fit, LawSpec, Rig
from models.rig_files.beams_file import read_beams
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
    "effects",
    "friction",
    "fit",
    "beams",
    "plate",
    "microphone",
    "assumed",
}

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
    return _build(_bench() | _material(material), f"material {material!r}")


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
    given = dict(content)
    measured = _measured(given.pop("measured_response", None), folder, where)
    refuse_unknown(given, _KEYS, where)
    base = _bench()
    if "fit" in given:
        bushing: dict[str, Any] = _PLAIN_BUSHING
    else:
        named = given.get("material", base["material"])
        bushing = _material(a_text(named, "material", where))
        given["material"] = bushing["material"]
    merged = base | bushing | given
    for table in ("beams", "plate", "microphone"):
        merged[table] = base[table] | a_table(given.get(table, {}), table, where)
    return replace(_build(merged, where), measured=measured)


def _measured(tables: Any, folder: Path, where: str) -> tuple[MeasuredResponse, ...]:
    if tables is None:
        return ()
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
    for known in material_names():
        if known.lower() == name.strip().lower():
            text = (_DATA / "materials" / f"{known}.toml").read_text(encoding="utf-8")
            return tomllib.loads(text) | {"material": known}
    raise ParameterError(f"material {name!r} is unknown; there are {', '.join(material_names())}")


def _build(merged: Mapping[str, Any], where: str) -> Rig:
    if not isinstance(merged["fit"], list):
        raise ParameterError(f"{where}: fit must be given as [[fit]] tables")
    fits = tuple(
        sorted(
            (_fit(table, f"{where}, fit {i + 1}") for i, table in enumerate(merged["fit"])),
            key=lambda fit: fit.interference,
        )
    )
    if not fits:
        raise ParameterError(f"{where}: needs at least one [[fit]]")
    if len({fit.interference for fit in fits}) < len(fits):
        raise ParameterError(f"{where}: two [[fit]] entries have the same interference_mm")
    friction = dict(a_table(merged["friction"], "friction", where))
    law = a_text(friction.pop("law", "coulomb"), "friction.law", where)
    for key in friction:
        a_number(friction, key, f"{where}, friction", low=-math.inf)
    effects = merged["effects"]
    if not isinstance(effects, list):
        raise ParameterError(f'{where}: effects must be a list such as ["slip_pulse:amplitude=20"]')
    plate = a_plate(merged["plate"], f"{where}, plate")
    return Rig(
        name=a_text(merged["name"], "name", where),
        material=a_text(merged["material"], "material", where),
        elastomer_inertia=a_number(merged, "elastomer_inertia_kgm2", where),
        clamp_inertia=a_number(merged, "clamp_inertia_kgm2", where),
        fits=fits,
        friction=LawSpec(law, friction),
        elastomer_damping_share=a_number(
            merged, "elastomer_damping_share", where, low=0.0, high=1.0, closed=True
        ),
        effects=tuple(parse_spec(a_text(e, "effects", where), f"{where}, effect") for e in effects),
        beams=read_beams(merged["beams"], f"{where}, beams"),
        plate=plate,
        microphone=a_microphone(merged["microphone"], plate, f"{where}, microphone"),
        assumed=_texts(merged.get("assumed", []), "assumed", where),
    )


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
