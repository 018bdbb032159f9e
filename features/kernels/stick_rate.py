"""Slope of a torque in true stick, from what a recording tells of its operating condition.

Stick-slip and the oscillations that merely look like it differ in this (thesis, 5.1.1): a contact
that sticks takes the shaft's whole motion into the springs, so that the torque rises at k_EFF times
the speed (5.1); one that slides rises slower. The signal alone cannot tell, the operating condition
can, and it comes from the sidecar, the speed from its own channels where they were recorded. With
the clamp bolted down a simulated contact that sticks reaches the rate within 1 %. On beams it does
so within some 10 % at 1 rad/s; the faster the shaft, the more of a rise is one swing of the beams,
whose slope is their own.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from models.blocks import in_pieces, n_samples_of, reader_of
from models.errors import ParameterError
from models.rig import effective_stiffness
from models.rig_file import load_material_rig

if TYPE_CHECKING:
    from models.blocks import Blocks
    from models.recording import Recording
    from models.rig import Rig

__all__ = ["stick_rate_of"]

_BLOCK = 0.02
"""Length over which the angle is averaged before its slope is taken [s]."""

_LEAST_BLOCKS = 3

_MOST = 1 << 21
"""Samples of a speed of which the median is taken; of more, every so many-th."""

_AT_ONCE = 1 << 16
"""Samples looked at together."""


def stick_rate_of(recording: Recording | Blocks, rig: Rig | None = None) -> float:
    """Product of k_EFF and the shaft's speed (thesis, (5.1)).

    Parameters
    ----------
    recording : Recording or Blocks
        Its condition tells interference and support, and material where no rig is given.
    rig : Rig, optional
        What the elastomer's stiffness is taken from; the shipped one with the recording's material
        otherwise.

    Returns
    -------
    float
        [N m/s], without sign; NaN where speed, interference, support or material is not known.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.recording import Channel, Recording
    >>> known = Condition(5.0, 0.279e-3, 2214.0, "fluorocarbon-thesis")
    >>> run = Recording(np.zeros((1, 480)), 48e3, (Channel("torque"),), known)
    >>> round(stick_rate_of(run))
    2557
    """
    condition = recording.condition
    if condition.interference is None or condition.support_stiffness is None:
        return math.nan
    if rig is None:
        rig = _shipped(condition.material)
    speed = _speed(recording)
    if rig is None or speed is None or speed == 0.0:
        return math.nan
    fit = rig.fit(condition.interference)
    return effective_stiffness(fit, condition.support_stiffness) * speed


def _speed(recording: Recording | Blocks) -> float | None:
    """Magnitude of the shaft's speed: median of its channels, or as it was set."""
    speed, angle = recording.first("speed"), recording.first("angle")
    n = n_samples_of(recording)
    if recording.calibrated and speed is not None:
        every = 1 + n // _MOST
        pieces = in_pieces(reader_of(recording, speed), n, every * _AT_ONCE)
        run = [np.abs(piece[::every]) for piece in pieces]
        return float(np.median(np.concatenate(run)))
    block = max(1, round(_BLOCK * recording.rate))
    if recording.calibrated and angle is not None:
        n_blocks = n // block
        if n_blocks >= _LEAST_BLOCKS:
            # Means of blocks first: the difference of single samples would be that of their noise.
            read = reader_of(recording, angle)
            means = np.concatenate(
                [
                    piece[: piece.size // block * block].reshape(-1, block).mean(axis=1)
                    for piece in in_pieces(read, n, max(1, _AT_ONCE // block) * block)
                ]
            )
            return float(np.median(np.abs(np.diff(means)))) * recording.rate / block
    set_speed = recording.condition.speed
    return None if set_speed is None else abs(set_speed)


@lru_cache(maxsize=16)
def _shipped(material: str | None) -> Rig | None:
    """Return the shipped rig with a material; nothing where the program does not know it."""
    try:
        return None if material is None else load_material_rig(material)
    except ParameterError:
        return None
