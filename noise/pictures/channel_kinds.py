"""Kinds of channel that pictures and pages show: their names, units, colours and references."""

from __future__ import annotations

from dataclasses import dataclass

from models.drawing import CHANNEL_LOOKS
from models.recording import REFERENCE_PRESSURE

__all__ = ["KINDS", "Kind"]


@dataclass(frozen=True)
class Kind:
    """How a kind of channel is shown.

    Parameters
    ----------
    name : str
    unit : str
        As it is written on an axis.
    colour : str
    reference : float
        Of levels, in the channel's unit, such as [Pa]; that of ISO 1683 where there is one.
    density : str
        The reference of the autospectral density in words.
    least_swing : float
        Taken for the swing of a signal that swings less, in the channel's unit, such as [Pa].
    quiet : float
        A spectrum's axis ends no lower [dB].
    """

    name: str
    unit: str
    colour: str
    reference: float
    density: str
    least_swing: float
    quiet: float


_COLOURS = {kind: look.colour for kind, look in CHANNEL_LOOKS.items()}

KINDS = {
    "torque": Kind("Torque", "Nm", _COLOURS["torque"], 1.0, "(1 Nm)²/Hz", 0.1, -40.0),
    "acceleration": Kind(
        "Beam acceleration", "m/s²", _COLOURS["acceleration"], 1e-6, "(1 µm/s²)²/Hz", 0.1, 80.0
    ),
    "pressure": Kind(
        "Sound pressure", "Pa", _COLOURS["pressure"], REFERENCE_PRESSURE, "(20 µPa)²/Hz", 1e-3, 40.0
    ),
}
"""The kinds of channel that are shown, in their order. Blue, green and near-black are told apart
by every eye (Okabe and Ito, Color universal design, 2008)."""
