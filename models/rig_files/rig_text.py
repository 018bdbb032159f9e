"""Rig files as text: a rig written out whole, or a base with what is changed about it."""

from __future__ import annotations

import json
import math
import os
from typing import TYPE_CHECKING

from models.rig_files.sensors_file import sensors_text
from models.rig_files.shipped import material_names
from models.rig_files.temperature_file import temperature_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from models.rig import LawSpec, Rig

__all__ = ["base_name", "changed_rig_text", "rig_text", "support_name"]


def rig_text(rig: Rig, notes: Sequence[str] = (), base: str | None = None) -> str:
    """Write a rig's bushing, friction and sensors; the rest is the base's, or the shipped bench's.

    Parameters
    ----------
    rig : Rig
    notes : sequence of str
        Lines of comment at the top.
    base : str, optional
        Rig file that structure, responses, sensors and material stay those of.

    Returns
    -------
    str

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> print(rig_text(load_material_rig("fluorocarbon-thesis")).splitlines()[0])
    name = "bench"
    """
    lines = [f"# {note}" for note in notes]
    fastest = rig.fastest_fitted
    lines += [
        f"name = {json.dumps(rig.name)}",
        f"material = {json.dumps(rig.material)}" if base is None else f"base = {json.dumps(base)}",
        f"elastomer_inertia_kgm2 = {rig.elastomer_inertia:.5g}",
        f"clamp_inertia_kgm2 = {rig.clamp_inertia:.5g}",
        f"elastomer_damping_share = {rig.elastomer_damping_share:.4g}",
        f"effects = {json.dumps([str(effect) for effect in rig.effects])}",
        f"assumed = {json.dumps(list(rig.assumed))}",
        *([f"fastest_fitted_rad_s = {fastest:.5g}"] if fastest < math.inf else []),
        "",
        "[friction]",
        f"law = {json.dumps(rig.friction.name)}",
        *(f"{name} = {value:.5g}" for name, value in rig.friction.parameters.items()),
    ]
    if rig.temperature is not None:
        lines += ["", *temperature_text(rig.temperature)]
    if base is None and (sensors := sensors_text(rig.sensors)):
        lines += ["", *sensors]
    for fit in rig.fits:
        lines += [
            "",
            "[[fit]]",
            f"interference_mm = {1e3 * fit.interference:.6g}",
            f"elastomer_stiffness_Nm_rad = {fit.elastomer_stiffness:.5g}",
            f"critical_torque_Nm = {fit.critical_torque:.5g}",
            f"kinetic_torque_Nm = {fit.kinetic_torque:.5g}",
            f"damping_Nms_rad = {_by_support(fit.damping)}",
        ]
    return "\n".join(lines) + "\n"


def changed_rig_text(
    base: str,
    changes: Mapping[str, str | float],
    effects: Sequence[LawSpec],
    tolerances: Mapping[str, float],
    notes: Sequence[str] = (),
    responses: Sequence[Mapping[str, str | float]] = (),
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
    responses : sequence of mapping
        Keys of each ``[[measured_response]]``.
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
    lines = [f"# {note}".rstrip() for note in notes]
    lines += [f"base = {_quoted(base)}", f"effects = {_quoted([str(spec) for spec in effects])}"]
    law = {} if friction is None else {"law": friction.name, **friction.parameters}
    tables = {
        "friction": law, "change": changes, "tolerances": tolerances, "design.heard": heard,
    }  # fmt: skip
    for name, table in tables.items():
        if table:
            lines += ["", f"[{name}]", *(f"{_key(k)} = {_value(v)}" for k, v in table.items())]
    for response in responses:
        lines += ["", "[[measured_response]]"]
        lines += [f"{key} = {_value(value)}" for key, value in response.items()]
    return "\n".join(lines) + "\n"


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
    >>> from pathlib import Path
    >>> base_name(Path("bench/mine.toml"), Path("diagnosis")), base_name(Path("PDMS"), Path())
    ('../bench/mine.toml', './PDMS')
    """
    file = file.resolve()
    try:
        named = os.path.relpath(file, folder.resolve()).replace(os.sep, "/")
    except ValueError:  # another drive
        return file.as_posix()
    is_material = named.lower() in {name.lower() for name in material_names()}
    return f"./{named}" if is_material else named


def _key(name: str) -> str:
    return ".".join(
        part if part.replace("_", "").isalnum() and part.isascii() else _quoted(part)
        for part in name.split(".")
    )


def _value(value: str | float) -> str:
    return f"{value:.6g}" if isinstance(value, int | float) else _quoted(value)


def _quoted(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def support_name(support: float) -> str:
    """Name a support stiffness [Nm/rad] as keys and names of files do.

    Examples
    --------
    >>> support_name(2214.0), support_name(math.inf)
    ('2214', 'fixed')
    """
    return "fixed" if math.isinf(support) else f"{support:.6g}"


def _by_support(damping: Mapping[float, float]) -> str:
    def name(support: float) -> str:
        return "fixed" if math.isinf(support) else _quoted(support_name(support))

    inside = ", ".join(f"{name(support)} = {value:.5g}" for support, value in damping.items())
    return f"{{ {inside} }}"
