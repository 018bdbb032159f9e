"""Sensors that the shipped models of causes have not seen, and what that costs.

The models learned from recordings through good sensors, a little noisier or quieter than those of
`sim.acquisition`. Against repeats that are simulated through a rig's own sensors a gap stays what
it is, whatever the sensors; the probabilities of causes do not.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from models.recording import CHANNEL_UNITS
from noise.diagnosis.cases.draw import NOISE_DRAWN
from noise.diagnosis.evidence.channel_summary import USABLE
from sim.acquisition import Acquisition

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.recording import Recording
    from models.sensors import Sensors

__all__ = ["unlearned_sensors"]


def unlearned_sensors(sensors: Sensors, recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Say which sensors the causes were not learned with; empty where all are as they were.

    Parameters
    ----------
    sensors : Sensors
        Their noise stated or estimated.
    recordings : sequence of Recording
        Through them.

    Returns
    -------
    tuple of str
        One line, or none.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.sensors import Sensor, Sensors
    >>> run = Recording(np.zeros((1, 4)), 30e3, (Channel("torque"),))
    >>> unlearned_sensors(Sensors({"torque": Sensor(full_scale=102.5, bits=16)}), [run])
    ()
    """
    usual = Acquisition().noise
    found = []
    for kind in dict.fromkeys(c.kind for r in recordings for c in r.channels if c.kind in usual):
        sensor, most = sensors.of(kind), NOISE_DRAWN[1] * usual[kind]
        noise = usual[kind] if sensor.noise is None else sensor.noise
        rough = math.hypot(noise, sensor.step / math.sqrt(12.0))
        rows = [r for r in recordings if r.first(kind) is not None]
        if rough > most:
            unit = CHANNEL_UNITS[kind]
            found.append(f"{kind} with up to {most:.2g} {unit} of noise, here {rough:.2g}")
        if sensor.full_scale is not None and any(
            abs(r.samples[r.first(kind)]).max() >= sensor.full_scale - 1.5 * sensor.step
            for r in rows
        ):
            found.append(f"{kind} within its range, here up to its end")
        if sensor.antialias is not None and sensor.antialias < USABLE * rows[0].rate:
            found.append(f"{kind} without a filter at {sensor.antialias:g} Hz")
    if not found:
        return ()
    return (
        f"the causes were learned with better sensors: {'; '.join(found)}; their probabilities are "
        "less sure here, and none is named within what repeats through the same sensors differ by",
    )
