"""The sensors of a rig as recordings show them, where its file does not state their noise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from models.sensors import Sensor
from models.units import CHANNEL_UNITS
from noise.diagnosis.preparation.converter_step import converter_step
from noise.diagnosis.preparation.sensor_noise import LOUDEST, estimated_noise
from sim.acquisition import Acquisition

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig


_BITS = 24
"""Of the converter that a step is written as; its range is never reached."""


def with_seen_sensors(rig: Rig, recordings: Sequence[Recording]) -> tuple[Rig, tuple[str, ...]]:
    """Return a rig with noise and resolution of its sensors, where these can be told.

    What is stated stays. A noise that cannot be told is that of good sensors.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    rig : Rig
    notes : tuple of str
        What was found, and what could not be, a line each.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> noise = 0.01 * np.random.default_rng(0).standard_normal((1, 60_000))
    >>> run = Recording(noise, 30e3, (Channel("torque"),))
    >>> seen, notes = with_seen_sensors(load_material_rig("fluorocarbon-thesis"), [run])
    >>> round(seen.sensors.of("torque").noise, 3), notes
    (0.01, ('noise of the sensors (white, RMS), by the recordings: torque 0.01 N m; ...',))
    """
    usual = Acquisition().noise
    found = dict(rig.sensors.by_kind)
    told, untold, louder, steps = [], [], [], []
    recorded = dict.fromkeys(c.kind for r in recordings for c in r.channels if c.kind in usual)
    for kind in recorded:
        sensor, unit = rig.sensors.of(kind), CHANNEL_UNITS[kind]
        if not sensor.step and (step := converter_step(recordings, kind)):
            sensor = _in_steps(sensor, step)
            steps.append(f"{kind} {step:.2g} {unit}")
        if sensor.noise is None:
            level = estimated_noise(recordings, kind, sensor.step)
            if level is None:
                untold.append(kind)
            elif level > LOUDEST * usual[kind] and not rig.sensors.noise_from_recordings:
                louder.append(f"{kind} {level:.2g} {unit}")
            else:
                sensor = replace(sensor, noise=level)
                told.append(f"{kind} {level:.2g} {unit}")
        found[kind] = sensor
    notes = []
    if told:
        notes.append(
            f"noise of the sensors (white, RMS), by the recordings: {', '.join(told)}; a hiss of "
            "the room that is in all recordings counts as theirs"
        )
    if steps:
        notes.append(f"steps of the converter, by the recordings: {', '.join(steps)}")
    if untold:
        notes.append(
            f"noise of the sensors of {', '.join(untold)}: these recordings do not tell it (no "
            "white floor between the slips); that of good sensors is assumed, which [sensors] of "
            "the rig file can replace"
        )
    if louder:
        notes.append(
            f"more white noise than usual sensors have, taken for a difference from the rig file: "
            f"{', '.join(louder)}; if it is the sensors' own, state it under [sensors]"
        )
    return replace(rig, sensors=replace(rig.sensors, by_kind=found)), tuple(notes)


def _in_steps(sensor: Sensor, step: float) -> Sensor:
    """Return a sensor with a converter of some step, within the range that it may have."""
    if sensor.full_scale is None:
        return replace(sensor, full_scale=math.ldexp(step, _BITS - 1), bits=_BITS)
    bits = 1 + math.log2(sensor.full_scale / step)
    whole = round(bits)
    return replace(sensor, bits=whole) if abs(bits - whole) < 1e-3 else sensor
