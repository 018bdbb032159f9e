"""The condition that a design was heard at, as its rig file keeps it: ``[design.heard]``.

    [design.heard]
    motion = "run_up"                  # or "constant" with speed_rad_s, or "swing"
    run_up.start_rad_s = 0
    run_up.end_rad_s = 12
    run_up.seconds = 6
    interference_mm = 0.279
    support_stiffness_Nm_rad = 2214    # or "fixed"
    temperature_C = 23

It is what the app begins with when the file is opened. ``[design]`` itself says what a design meets
in use; one condition there would make a map of one point.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from models.schema import as_table, refuse_unknown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from noise.app.design.controls import Control

__all__ = ["heard_table", "heard_values"]

_SUPPORT = "support_stiffness_Nm_rad"
_NAMES = {
    "motion": "motion",
    "speed": "speed_rad_s",
    "run_up.start": "run_up.start_rad_s",
    "run_up.end": "run_up.end_rad_s",
    "run_up.seconds": "run_up.seconds",
    "swing.degrees": "swing.amplitude_deg",
    "swing.hz": "swing.frequency_hz",
    "interference": "interference_mm",
    "support": _SUPPORT,
    "temperature": "temperature_C",
}
"""Of controls, in files."""


def heard_table(
    controls: Iterable[Control], values: Mapping[str, float | bool | str]
) -> dict[str, str | float]:
    """Return what a rig file says of the condition that values of controls describe.

    Examples
    --------
    >>> from noise.app.design.bases import Base
    >>> controls = Base("PDMS").controls
    >>> heard_table(controls, {one.key: one.value for one in controls})
    {'motion': 'constant', 'speed_rad_s': 5.0, 'interference_mm': 0.279,
     'support_stiffness_Nm_rad': 2214.0, 'temperature_C': 23.0}
    """
    found: dict[str, str | float] = {}
    for one in controls:
        if not one.condition or (one.only and values[one.only[0]] != one.only[1]):
            continue
        if one.key != "fixed":
            found[_NAMES[one.key]] = values[one.key]
        elif values["fixed"]:
            found[_SUPPORT] = "fixed"
    return found


def heard_values(content: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return what a rig file says of the condition by control, as it stands there.

    Parameters
    ----------
    content : mapping
        Of the whole file.
    where : str
        What messages call the file.

    Raises
    ------
    ParameterError
        Something is no table, or a key unknown.

    Examples
    --------
    >>> heard_values({"design": {"heard": {"support_stiffness_Nm_rad": "fixed"}}}, "rig.toml")
    {'fixed': True}
    """
    design = as_table(content.get("design", {}), "design", where)
    where = f"{where}, design"
    stated: dict[str, Any] = {}
    for name, value in as_table(design.get("heard", {}), "heard", where).items():
        inner = value if isinstance(value, Mapping) else {}
        stated |= {f"{name}.{key}": one for key, one in inner.items()} or {name: value}
    refuse_unknown(stated, set(_NAMES.values()), f"{where}.heard")
    found = {key: stated[name] for key, name in _NAMES.items() if name in stated}
    if found.get("support") == "fixed":
        del found["support"]
        found["fixed"] = True
    return found
