"""Units of acceleration and sound where nothing slips: by the noise of sensors, or not at all.

Where the contact slides smoothly the torque makes nothing of acceleration and sound, and what they
hold is the noise of their sensors. A unit that is a thousand times another moves it beyond what any
sensor has; one of ten (g) does so only where the rig file states the noise. Where even that tells
nothing, it is said that units were not checked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from models.condition import known_condition
from models.rig import Rig
from models.units import CHANNEL_UNITS
from noise.diagnosis.bench.channels import SWINGING, is_told
from noise.diagnosis.bench.levels import Levels, factor_words, levels_of, unit_of
from noise.diagnosis.preparation.sensor_noise import estimated_noise
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.acquisition import Acquisition
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from models.recording import Recording
    from noise.diagnosis.case import Case


_OUTPUTS = ("acceleration", "pressure")

_SENSORS = (0.3, 4.0)
"""Noise of usual sensors over that of the good ones of `sim.acquisition` [-]: from better than
these to the thesis's converter."""

_FAR = 30.0
"""Times that noise must be off where the rig file does not state it [-]: better sensors, poorer
ones and louder rooms are within; assumed."""

_STATED = (1.0 / 5.0, 30.0)
"""Noise over that which the rig file states, between which it may be the sensor's [-]: a data sheet
states the most, and a room adds to it; assumed."""


def noise_findings(case: Case, levels: Sequence[Levels]) -> Iterator[str]:
    """Say which channels have a noise that another unit explains, where the torque tells nothing.

    Parameters
    ----------
    case : Case
    levels : sequence of Levels
        Of its recordings.

    Yields
    ------
    str
    """
    noise, stated = _noises(case, _untold(case, levels))
    own = {kind: noise[kind] / level for kind, level in stated.items()}
    if (
        len(stated) == 2
        and any(not _within(ratio, *_STATED) for ratio in own.values())
        and all(_within(noise[k] / stated[o], 0.5, 2.0) for k, o in (_OUTPUTS, _OUTPUTS[::-1]))
    ):
        yield "channels acceleration and pressure look swapped: either has the other's stated noise"
        return
    for kind, level in noise.items():
        usual = level / Acquisition().noise[kind]
        if not _within(own.get(kind, 1.0), *_STATED):
            factor, within, those = own[kind], math.log(2.0), "that of [sensors]"
        elif not _within(usual, 1.0 / _FAR, _FAR):
            middle = math.sqrt(_SENSORS[0] * _SENSORS[1])
            factor, within, those = usual / middle, math.log(_SENSORS[1] / middle), "usual sensors'"
        else:
            continue
        if unit := unit_of(kind, factor, within):
            yield (
                f"channel {kind} looks like {unit}, not {CHANNEL_UNITS[kind]}: nothing slips that "
                f"it could be told from, and its noise is {factor_words(factor)} for {those}"
            )


def _noises(case: Case, kinds: Sequence[str]) -> tuple[dict[str, float], dict[str, float]]:
    """Return the noise of channels as recorded, and as stated, with the rounding of converters."""
    noise = {kind: estimated_noise(case.recordings, kind) for kind in kinds}
    sensors = {kind: case.rig.sensors.of(kind) for kind in kinds}
    return (
        {kind: level for kind, level in noise.items() if level},
        {
            kind: math.hypot(sensor.noise, sensor.step / math.sqrt(12.0))
            for kind, sensor in sensors.items()
            if sensor.noise and noise[kind]
        },
    )


def _within(x: float, low: float, high: float) -> bool:
    return low < x < high


def unchecked_units(case: Case, library: Mapping[str, Effect] | None = None) -> tuple[str, ...]:
    """Say of which channels nothing tells the unit.

    Parameters
    ----------
    case : Case
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among.

    Returns
    -------
    tuple of str
        One line, or none.
    """
    if any(_swings(recording, case.rig) for recording in case.recordings):
        return ()
    cache = TransferFunctionCache(case.rig, library)
    untold = _untold(case, [levels_of(one, case.rig, cache) for one in case.recordings])
    if not untold:
        return ()
    why = "nothing slips" if any("torque" in one for one in case.recordings) else "no torque"
    return (
        f"{why}: units, signs and order of {' and '.join(untold)} were not checked, since nothing "
        "tells how large they should be",
    )


def _untold(case: Case, levels: Sequence[Levels]) -> list[str]:
    """Return the channels that no recording tells the size of."""
    return [
        kind
        for kind in _OUTPUTS
        if any(kind in one for one in case.recordings) and not is_told(kind, levels)
    ]


def _swings(recording: Recording, rig: Rig) -> bool:
    row = recording.first("torque")
    interference = known_condition(recording.condition).interference
    return row is not None and float(recording.samples[row].std()) > (
        SWINGING * rig.fit(interference).kinetic_torque
    )
