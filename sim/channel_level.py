"""How strong a disturbance is in each channel, as the effects that add one state it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.recording import REFERENCE_PRESSURE

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["channel_level"]


def channel_level(name: str, values: Mapping[str, float]) -> float:
    """Root mean square in a channel, in its unit; 0 where nothing is stated.

    Parameters
    ----------
    name : str
        Of the channel; ``torque_2`` is of the kind ``torque``.
    values : mapping of str to float
        ``pressure_level`` [dB re 20 uPa], ``acceleration``, ``torque`` and ``angle``.

    Examples
    --------
    >>> values = {"pressure_level": 94.0, "acceleration": 1.0, "torque": 0.1, "angle": 0.0}
    >>> round(channel_level("pressure_2", values), 2), channel_level("speed", values)
    (1.0, 0.0)
    """
    kind = name.partition("_")[0]
    if kind == "pressure":
        return REFERENCE_PRESSURE * float(10.0 ** (values["pressure_level"] / 20.0))
    return values[kind] if kind in ("acceleration", "torque", "angle") else 0.0
