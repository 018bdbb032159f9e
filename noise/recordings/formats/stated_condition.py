"""Operating conditions among the properties of a logger's file, checked as those of a sidecar."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from noise.recordings.sidecar import parse_sidecar

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.condition import Condition

__all__ = ["CONDITIONS", "stated_condition"]

_SUPPORT = "support_stiffness_Nm_rad"
CONDITIONS = (
    "speed_rad_s",
    "interference_mm",
    _SUPPORT,
    "material",
    "temperature_C",
)
"""Properties of a file that are its operating condition, named as in a sidecar."""


def stated_condition(properties: Mapping[str, object], where: str) -> Condition:
    """Read the operating condition among the properties of a file.

    Parameters
    ----------
    properties : mapping
        Numbers may be texts; a support stiffness may be "fixed".
    where : str
        What messages call the file.

    Raises
    ------
    RecordingError
        A property that is named as a condition holds none.

    Examples
    --------
    >>> stated_condition({"speed_rad_s": "5.0", "operator": "JD"}, "run07.tdms").speed
    5.0
    """
    entry: dict[str, object] = {}
    for key in CONDITIONS:
        value = properties.get(key)
        if isinstance(value, np.ndarray | np.generic) and value.size == 1:
            value = value.item()
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        if isinstance(value, str) and key != "material":
            value = _number(value)
        if value is not None or (key == _SUPPORT and properties.get(key) is not None):
            entry[key] = value
    return parse_sidecar(json.dumps({"conditions": entry}, default=str), where).condition


def _number(text: str) -> float | str | None:
    """Read the number in a text; None for the clamp fixed to the baseplate."""
    if text.strip().lower() in ("fixed", "null"):
        return None
    try:
        return float(text)
    except ValueError:
        return text
