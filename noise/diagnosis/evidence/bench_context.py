"""Bench of a case in a few numbers: its sensors, lengths, responses, law and listed effects.

What a difference means depends on them, so they stand in the row beside the differences.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from models.condition import same_support
from models.recording import Recording
from models.rig import Rig
from noise.diagnosis.simulated.repeats import CHANNELS
from sim.acquisition import Acquisition

CONTEXT = (
    *(f"{kind}_noise" for kind in CHANNELS), *(f"{kind}_step" for kind in CHANNELS),
    "seconds", "coherence", "constant_law", "listed",
)  # fmt: skip
"""Names of the numbers, in their order."""

_BAND = (100.0, 3000.0)
"""In which a hammer test's coherence is looked at [Hz]; assumed."""


def bench_context(rig: Rig, recordings: Sequence[Recording]) -> dict[str, float]:
    """Say what bench a case is from.

    Parameters
    ----------
    rig : Rig
        With the sensors that simulated repeats go through.
    recordings : sequence of Recording

    Returns
    -------
    dict of str to float
        By `CONTEXT`: noise over that of good sensors, as a logarithm; a converter's step over that
        noise [-]; length of a recording [s]; share of a measured response that is no answer to the
        hammer, 1 where none was measured; whether the law is the constant one, and how many effects
        are listed. What is missing is unknown.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> run = Recording(np.zeros((1, 15_000)), 30e3, (Channel("torque"),))
    >>> bench_context(load_material_rig("fluorocarbon-thesis"), [run])
    {'seconds': 0.5, 'coherence': 1.0, 'constant_law': 1.0, 'listed': 0.0, 'torque_noise': 0.0, \
'torque_step': 0.0}
    """
    context = {
        "seconds": float(np.median([r.duration for r in recordings])),
        "coherence": lacking_coherence(rig, recordings),
        "constant_law": float(rig.friction.name == "coulomb"),
        "listed": float(len(rig.effects)),
    }
    for kind, usual in Acquisition().noise.items():
        if any(r.first(kind) is not None for r in recordings):
            sensor = rig.sensors.of(kind)
            level = usual if sensor.noise is None else sensor.noise
            context[f"{kind}_noise"] = math.log(max(level / usual, 1e-3))
            context[f"{kind}_step"] = sensor.step / usual
    return context


def lacking_coherence(rig: Rig, recordings: Sequence[Recording]) -> float:
    """Median of what the coherence of the supports' measured responses lacks of 1.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording
        Whose supports' responses are looked at.

    Returns
    -------
    float
        Of the worst of them [-]: 0 where it is unknown, 1 where no response was measured.
    """
    supports = [r.condition.support_stiffness for r in recordings]
    responses = [
        response
        for entry in rig.measured
        if any(s is not None and same_support(s, entry.support_stiffness) for s in supports)
        for response in (entry.torque_to_acceleration, entry.torque_to_pressure)
        if response is not None
    ]
    if not responses:
        return 1.0
    lacking = [0.0]
    for response in responses:
        if response.coherence is not None:
            inside = (response.frequencies >= _BAND[0]) & (response.frequencies <= _BAND[1])
            if inside.any():
                lacking.append(1.0 - float(np.median(response.coherence[inside])))
    return max(lacking)
