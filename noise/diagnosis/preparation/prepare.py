"""What is done to recordings and to the rig before they are compared.

In order: the start is left out, the speed is what the angle says, the noise and the resolution of
sensors are taken from the recordings, where the rig file does not state them, and of recordings
that are long or finely sampled a part is looked at.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from noise.diagnosis.preparation.bounded import bounded
from noise.diagnosis.preparation.measured_speed import at_measured_speeds
from noise.diagnosis.preparation.sensors_seen import with_seen_sensors
from noise.diagnosis.preparation.settled_part import settled_parts

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig


@dataclass(frozen=True, eq=False)
class Prepared:
    """Recordings as they are compared, with the rig that they are compared with.

    Parameters
    ----------
    rig : Rig
        Its sensors as the recordings show them, where its file does not state them.
    recordings : tuple of Recording
        Their settled part, at the speed that they turn at; those that are ``left_out`` are missing.
    notes : tuple of str
        What a user should know of it, a line each.
    left_out : mapping of int to str
        Why a recording cannot be used, by its place among those given.
    """

    rig: Rig
    recordings: tuple[Recording, ...]
    notes: tuple[str, ...] = ()
    left_out: Mapping[int, str] = field(default_factory=dict)


def prepared(rig: Rig, recordings: Sequence[Recording]) -> Prepared:
    """Make recordings ready to be compared with a rig.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording
        Of one rig, with speed, interference and support stiffness in their conditions.

    Returns
    -------
    Prepared

    Examples
    --------
    >>> import numpy as np
    >>> from models.condition import KnownCondition
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> x = 7.0 + 0.1 * np.random.default_rng(0).standard_normal((1, 15_000))
    >>> at = KnownCondition(1.0, 0.279e-3, 3745.0)
    >>> run = Recording(x, 30e3, (Channel("torque"),), at)
    >>> prepared(load_material_rig("fluorocarbon-thesis"), [run]).recordings[0].duration
    0.5
    """
    parts, cut, left_out = settled_parts(recordings)
    timed, turned = at_measured_speeds(parts)
    seen, sensed = with_seen_sensors(rig, timed)
    thinned, kept, shortened = bounded(seen, timed)
    return Prepared(thinned, kept, (*cut, *turned, *sensed, *shortened), left_out)
