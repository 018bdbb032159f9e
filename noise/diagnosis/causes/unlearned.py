"""What the shipped models of causes have not seen or cannot tell, and what that costs.

The models learned from recordings through sensors up to `NOISIEST` times as noisy as the good ones
of `sim.acquisition`, and through converters as coarse as the thesis's. Against repeats that are
simulated through a rig's own sensors a gap stays what it is, whatever the sensors; the
probabilities of causes do not. Nor do they where a rig's responses come from a poor hammer test:
its errors look like those of a sensor's gain or of the plate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from models.sensors import Sensors
from models.units import CHANNEL_UNITS
from noise.diagnosis.evidence.bands import USABLE
from noise.diagnosis.evidence.bench_context import lacking_coherence
from sim.acquisition import THESIS_CONVERTER, Acquisition

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig


NOISIEST = 6.0
"""Noise of the sensors that were learned with, over that of good ones at most [-]."""

_POOR = 0.05
"""What a good hammer test's coherence lacks of 1 at most, median over frequency [-]. On development
benches of the second rig good tests lack 0.001 and poor ones 0.10; between these it is assumed."""


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
    rough: list[str] = []
    full: list[str] = []
    filtered: dict[float, list[str]] = {}
    for kind in dict.fromkeys(c.kind for r in recordings for c in r.channels if c.kind in usual):
        sensor = sensors.of(kind)
        level = _level(usual[kind] if sensor.noise is None else sensor.noise, sensor.step)
        most = _level(NOISIEST * usual[kind], THESIS_CONVERTER.of(kind).step)
        rows = [(r, row) for r in recordings if (row := r.first(kind)) is not None]
        if level > most:
            rough.append(f"{kind} {level:.2g} {CHANNEL_UNITS[kind]} (at most {most:.2g})")
        if sensor.full_scale is not None:
            end = sensor.full_scale - 1.5 * sensor.step
            if any(abs(r.samples[row]).max() >= end for r, row in rows):
                full.append(kind)
        if sensor.antialias is not None and sensor.antialias < USABLE * rows[0][0].rate:
            filtered.setdefault(sensor.antialias, []).append(kind)
    found = [f"noise and rounding of {', '.join(rough)}"] if rough else []
    found += [f"a filter at {corner:g} Hz ({', '.join(on)})" for corner, on in filtered.items()]
    found += [f"a range that is reached ({', '.join(full)})"] if full else []
    if not found:
        return ()
    return (
        f"the causes were learned with better sensors than these: {'; '.join(found)}; their "
        "probabilities are less sure here, and none is named within what repeats through the same "
        "sensors differ by",
    )


def poor_responses(rig: Rig, recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Say that measured responses are too poor to name what they may feign; empty where not.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording
        Whose supports' responses are looked at.

    Returns
    -------
    tuple of str
        One line, or none.

    Examples
    --------
    >>> from models.rig_file import load_rig
    >>> poor_responses(load_rig("fluorocarbon"), [])
    ()
    """
    lacking = lacking_coherence(rig, recordings) if rig.measured else 0.0
    if lacking <= _POOR:
        return ()
    return (
        f"the rig file's responses were measured with a coherence of {1.0 - lacking:.2f} only: "
        "what they are off by looks like a gain error or another plate, so nothing is named within "
        "what repeats differ by; more hits, and harder ones, would tell",
    )


def _level(noise: float, step: float) -> float:
    """Add noise and rounding, as standard deviations [unit of the channel]."""
    return math.hypot(noise, step / math.sqrt(12.0))
