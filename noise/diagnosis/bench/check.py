"""Is it this rig at all? What is wrong with a bench's units, signs, channels or conditions.

Asked before anything else: the posterior of causes has learned with right benches, and names a
cause for whatever else it is shown. What is found is told, and no cause is named.

The torque of the contact is what a material and its fit make of it; no effect takes half of it away
at every condition. Another law at the same level is told where a shipped material predicts mean,
swing and frequency of the torque in every recording, and the rig file does not.

Where the contact slides smoothly the torque makes nothing of acceleration and sound, and what they
hold is the noise of their sensors. A unit that is a thousand times another moves it beyond what any
sensor has; one of ten (g) does so only where the rig file states the noise. Where even that tells
nothing, it is said that units were not checked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import known_condition
from models.errors import BushingNoiseError
from models.recording import Recording
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from models.units import CHANNEL_UNITS
from noise.diagnosis.bench.channels import (
    SWINGING,
    Levels,
    backwards,
    factor_words,
    is_told,
    levels_of,
    swapped_channels,
    turned_channels,
    unit_of,
    wrong_units,
)
from noise.diagnosis.bench.faults import dead_channels, shuffled_conditions, wrong_speed
from noise.diagnosis.preparation.prepare import estimated_noise
from noise.diagnosis.simulated.repeats import nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.acquisition import Acquisition
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from models.recording import Recording
    from noise.diagnosis.bench.channels import Levels
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
        and any(not _within_band(ratio, *_STATED) for ratio in own.values())
        and all(_within_band(noise[k] / stated[o], 0.5, 2.0) for k, o in (_OUTPUTS, _OUTPUTS[::-1]))
    ):
        yield "channels acceleration and pressure look swapped: either has the other's stated noise"
        return
    for kind, level in noise.items():
        usual = level / Acquisition().noise[kind]
        if not _within_band(own.get(kind, 1.0), *_STATED):
            factor, within, those = own[kind], math.log(2.0), "that of [sensors]"
        elif not _within_band(usual, 1.0 / _FAR, _FAR):
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


def _within_band(x: float, low: float, high: float) -> bool:
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


_LEAST = 0.58
"""Share of the kinetic torque that is left at some condition, whatever is missing [-]: an effect
that takes half away does so at some speeds; assumed."""

_FOLLOWS = 0.9
"""Share explained, and correlation, from which a path tells the gain of the torque [-];
assumed."""

_ERRORS = np.array([0.04, 0.08, 0.08])
"""Differences of logarithms of mean, swing and frequency between repeats, and of a fit that
another rig of the same material has [-]; assumed."""

_LIKE, _UNLIKE = 2.0, 3.0
"""Root mean square differences, in such errors: at most to the material, and at least so many
times that to the rig file; assumed."""

_SILENT = 1.0
"""The first of these where nothing slips, neither here nor there: the mean torque alone tells;
assumed."""

_CYCLES = (15.0, 1500.0)
"""Between which slips repeat [Hz]; assumed."""


def another_level(levels: Sequence[Levels]) -> str:
    """Say whether friction is far below the rig file's at every condition; empty if it is not."""
    found = [abs(one.torque) for one in levels if one.torque is not None]
    fits = [fit for one in levels for (kind, path), fit in one.paths.items() if kind == path]
    gains = [f.gain for f in fits if min(f.explained, abs(f.alike)) > _FOLLOWS]
    read = max(float(np.median(gains)), 1.0) if gains else 1.0  # of a torque that reads low
    if not found or max(found) * read >= _LEAST:
        return ""
    return (
        f"the torque is {np.median(found):.2g} of the rig file's kinetic torque, and at most "
        f"{max(found):.2g} at any condition: another material, fit or rig"
    )


def another_material(
    case: Case, transfer_functions: TransferFunctionCache, library: Mapping[str, Effect] | None
) -> str:
    """Say whether the friction is that of a shipped material and not of the rig file."""
    torque = [recording.first("torque") for recording in case.recordings]
    if any(row is None for row in torque):
        return ""
    seen = [_course(recording) for recording in case.recordings]
    silent = all(_silent(course) for course in seen)

    def away(rig: Rig, most: float) -> float:
        squares: list[NDArray[np.float64]] = []
        n = sum(1 if silent else course.size for course in seen)
        for course, recording in zip(seen, case.recordings, strict=True):
            at = _within(rig, recording)
            try:
                (made,) = nominal_repeats(at, rig, transfer_functions, [0], library=library)
            except BushingNoiseError:
                return np.inf
            expected = _course(made)
            both = silent and _silent(expected)
            squares.append((((course - expected) / _ERRORS) ** 2)[: 1 if both else None])
            if sum(map(np.sum, squares)) > n * most**2:
                return np.inf  # however well the others fit
        return float(np.sqrt(np.concatenate(squares).mean()))

    own = away(case.rig, np.inf)
    if own < _UNLIKE:
        return ""
    most = min(_SILENT if silent else _LIKE, own / _UNLIKE)
    for name in material_names():
        other = load_material_rig(name)
        names = sorted((other.material, case.rig.material), key=len)
        if other.friction.name == case.rig.friction.name and names[1].startswith(names[0]):
            continue  # other numbers of one law are a matter of parameters
        whole = replace(other, sensors=case.rig.sensors, measured=case.rig.measured)
        if away(whole, most) < most:
            return f"the friction is that of {name}, not of the rig file: another material"
    return ""


def _course(recording: Recording) -> NDArray[np.float64]:
    """Logarithms of mean and swing of the torque, and of the frequency of its cycles."""
    row = recording.first("torque")
    x = np.asarray(recording.samples[row], dtype=np.float64)
    mean, swing = abs(float(x.mean())), float(x.std())
    if swing < SWINGING * mean:  # nothing slips, and what is seen is noise
        return np.log([max(mean, 1e-12), SWINGING * max(mean, 1e-12), _CYCLES[0]])
    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(x.size), 4 * x.size)) ** 2
    frequency = np.fft.rfftfreq(4 * x.size, 1.0 / recording.rate)
    inside = (frequency > _CYCLES[0]) & (frequency < _CYCLES[1])
    middle = float(frequency[inside] @ power[inside]) / (float(power[inside].sum()) + 1e-300)
    return np.log(np.maximum([mean, swing, middle], 1e-12))


def _silent(course: NDArray[np.float64]) -> bool:
    """Return whether nothing slips."""
    return bool(course[2] <= np.log(_CYCLES[0]))


def _within(rig: Rig, recording: Recording) -> Recording:
    """Return a recording at the interference of a rig's fits that is nearest to its own."""
    condition = recording.condition
    assert condition.interference is not None  # `usable` made it so
    nearest = float(np.clip(condition.interference, *rig.interference_range))
    return replace(recording, condition=replace(condition, interference=nearest))


_ANY_RIG = 3.0
"""Times that the torque of a rig may differ from another's of its kind [-]; assumed."""


def bench_findings(case: Case, library: Mapping[str, Effect] | None = None) -> tuple[str, ...]:
    """Say what of a case cannot be of its rig.

    Parameters
    ----------
    case : Case
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among.

    Returns
    -------
    tuple of str
        One line each; empty where nothing is.
    """
    if dead := tuple(dead_channels(case.names, case.recordings)):
        return dead
    if case.misplaced:
        return (case.misplaced,)
    cache = TransferFunctionCache(case.rig, library)
    levels = [levels_of(recording, case.rig, cache) for recording in case.recordings]
    if swapped := swapped_channels(case.recordings, case.rig, levels):
        return (swapped,)
    if reversed_ := backwards(levels):
        return (reversed_,)
    if shuffled := shuffled_conditions(case, levels):
        return (shuffled,)
    found = [
        *turned_channels(levels), *wrong_units(levels), *noise_findings(case, levels),
        wrong_speed(levels),
    ]  # fmt: skip
    if found := [text for text in found if text]:
        return tuple(found)
    level = another_level(levels)
    other = level or another_material(case, cache, library)
    return (other,) if other else ()


def unit_findings(recordings: Sequence[Recording], rig: Rig) -> tuple[str, ...]:
    """Say which channels are in another unit, of a rig of which only the kind is known.

    Parameters
    ----------
    recordings : sequence of Recording
        With known conditions.
    rig : Rig
        One of its kind, as that which an identification starts from.

    Returns
    -------
    tuple of str
        One line each; empty where none is, and where the rig cannot tell.
    """
    cache = TransferFunctionCache(rig)
    try:
        levels = [levels_of(recording, rig, cache) for recording in recordings]
    except BushingNoiseError:  # a support that this rig has not
        return ()
    return tuple(text for text in wrong_units(levels, alike=_ANY_RIG) if " looks like " in text)
