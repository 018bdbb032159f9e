"""Is it this rig at all? What is wrong with a bench's units, signs, channels or conditions.

Asked before anything else: the posterior of causes has learned with right benches, and names a
cause for whatever else it is shown. What is found is told, and no cause is named.

The torque of the contact is what a material and its fit make of it; no effect takes half of it away
at every condition. Another law at the same level is told where a shipped material predicts mean,
swing and frequency of the torque in every recording, and the rig file does not.

Where the contact slides smoothly the torque makes nothing of acceleration and sound; then it is
said that their units were not checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import known_condition
from models.errors import BushingNoiseError
from models.recording import Recording
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from noise.diagnosis.bench.channels import (
    SWINGING,
    Levels,
    backwards,
    is_told,
    levels_of,
    swapped_channels,
    turned_channels,
    wrong_units,
)
from noise.diagnosis.bench.faults import dead_channels, shuffled_conditions, wrong_speed
from noise.diagnosis.simulated.repeats import nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from models.recording import Recording
    from noise.diagnosis.bench.channels import Levels
    from noise.diagnosis.case import Case


_OUTPUTS = ("acceleration", "pressure")


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
    levels = [levels_of(one, case.rig, cache) for one in case.recordings]
    recorded = [kind for kind in _OUTPUTS if any(kind in one for one in case.recordings)]
    untold = [kind for kind in recorded if not is_told(kind, levels)]
    if not untold:
        return ()
    why = "nothing slips" if any("torque" in one for one in case.recordings) else "no torque"
    return (
        f"{why}: units, signs and order of {' and '.join(untold)} were not checked, since nothing "
        "tells how large they should be",
    )


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
    found = [*turned_channels(levels), *wrong_units(levels), wrong_speed(levels)]
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
