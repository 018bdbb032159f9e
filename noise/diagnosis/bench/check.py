"""Is it this rig at all? What is wrong with a bench's units, signs, channels or conditions.

Asked before anything else: the posterior of causes has learned with right benches, and names a
cause for whatever else it is shown. What is found is told, and no cause is named.

The torque of the contact is what a material and its fit make of it; no effect takes half of it away
at every condition. Another law at the same level is told where a shipped material predicts mean,
swing and frequency of the torque in every recording, and the rig file does not.

Where the contact slides smoothly the torque makes nothing of acceleration and sound; then it is
said that their units were not checked.

A dead channel is left out and the others are looked at. A channel that clips is kept, since what
clipping does to it is known; its range is told, so that somebody sets it higher. Stated conditions
are held against what torque and angle say themselves: speed, its sign, order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment

from models.condition import known_condition
from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from noise.base.arrays import Array
from noise.diagnosis.bench.channels import (
    KINDS,
    OUTPUTS,
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
from noise.diagnosis.simulated.repeats import nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case


_SPEED = 0.2
"""Difference of logarithms of the speed that is stated and that of the angle; a speed that is read
off a dial errs by 3 %, and a fluctuating one evens out [-]; assumed."""

_STILL = 0.05
"""Share of the stated speed below which an angle does not turn [-]; assumed."""

_CONDITION_ERRORS = {"speed": 0.05, "torque": 0.2}
"""Differences of logarithms between a recording and its condition that count as one [-];
assumed."""

_SHUFFLED = 3.0
"""Mean of such differences from which conditions do not belong to their recordings [-];
assumed."""

_SORTED = 1.0
"""Mean of such differences below which another order fits [-]; assumed."""


LEAST_RATE = 8e3
"""Least sampling rate [Hz]: the cycle's harmonics to 3 kHz are in it; assumed."""


def refuse_unusable(recording: Recording, shortest: float) -> None:
    """Refuse a recording that no rig can be told from.

    Parameters
    ----------
    recording : Recording
    shortest : float
        Least duration [s].

    Raises
    ------
    ParameterError
        It is not in physical units, sampled too seldom or too short.
    """
    if not recording.calibrated:
        raise ParameterError(
            'is not in physical units; state units in a sidecar, with "calibrated": true, or '
            "calibration under [sensors] of the rig file"
        )
    if recording.rate < LEAST_RATE:
        raise ParameterError(f"is sampled at {recording.rate:g} Hz; {LEAST_RATE:g} at least")
    if recording.duration < shortest:
        raise ParameterError(f"lasts {recording.duration:.3g} s; {shortest:.3g} s at least")


def wrong_speed(levels: Sequence[Levels]) -> str:
    """Say whether the angle turns otherwise than stated; empty if it does not."""
    ratios = np.array([one.turned / one.speed for one in levels if one.turned is not None])
    if not ratios.size:
        return ""
    stated = float(np.median([abs(one.speed) for one in levels if one.turned is not None]))
    if words := speed_words(float(np.median(ratios)), stated):
        return words
    far = int(np.count_nonzero(np.abs(np.log(np.abs(ratios) + 1e-12)) > 2.0 * _SPEED))
    if not far:
        return ""
    return f"the angle turns at another speed than stated in {far} of {ratios.size} recordings"


def speed_words(ratio: float, stated: float) -> str:
    """Say what is wrong with a speed, by that of the angle; empty if nothing is.

    Parameters
    ----------
    ratio : float
        Speed of the angle over the one that is stated [-].
    stated : float
        [rad/s]

    Examples
    --------
    >>> speed_words(57.3, 2.0), speed_words(1.03, 2.0)
    ('channel angle looks like degrees, not rad (factor 57)', '')
    """
    if not ratio:
        return "channel angle does not turn"
    if abs(np.log(abs(ratio))) < _SPEED:
        turned = "channel angle turns against the stated speed: the sign of either is wrong"
        return turned if ratio < 0.0 else ""
    if unit := unit_of("angle", ratio):
        return f"channel angle looks like {unit}, not rad (factor {max(ratio, 1 / ratio):.2g})"
    if unit := unit_of("speed", 1.0 / ratio):
        return f"the stated speed looks like {unit}, not rad/s (factor {max(ratio, 1 / ratio):.2g})"
    turns = f"{ratio * stated:.2g} rad/s where {stated:.2g} rad/s is stated"
    if ratio < _STILL:
        return f"channel angle does not turn as stated: {turns}"
    return f"the stated speed is {factor_words(1.0 / ratio)}: the angle turns at {turns}"


def shuffled_conditions(case: Case, levels: Sequence[Levels]) -> str:
    """Say whether the conditions are those of each other's recordings; empty if they are not."""
    seen: list[tuple[float, float]] = []
    stated: list[tuple[float, float]] = []
    for one, recording in zip(levels, case.recordings, strict=True):
        if one.turned is None or one.torque is None or not one.turned or not one.torque:
            return ""
        interference = known_condition(recording.condition).interference
        kinetic = case.rig.fit(interference).kinetic_torque
        stated.append((np.log(abs(one.speed)), np.log(kinetic)))
        seen.append((np.log(abs(one.turned)), np.log(abs(one.torque) * kinetic)))
    x, y = np.array(seen), np.array(stated)
    x = x - np.median(x - y, axis=0)  # a wrong unit or gain is no wrong order
    size = np.array(list(_CONDITION_ERRORS.values()))
    cost = (np.minimum(np.abs(x[:, None, :] - y[None, :, :]) / size, 20.0)).sum(axis=2)
    rows, columns = linear_sum_assignment(cost)
    before, after = float(np.trace(cost)) / len(x), float(cost[rows, columns].mean())
    if before < _SHUFFLED or after > _SORTED:
        return ""
    moved = [case.names[i] for i, j in zip(rows, columns, strict=True) if cost[i, i] > cost[i, j]]
    return (
        f"conditions look shuffled among the recordings: speed and torque of {', '.join(moved)} "
        "are those stated of others"
    )


_NEEDED = KINDS[:3]
"""Without any of which there is nothing to look at."""

_LIVELY = 0.1
"""Swing of the torque over its mean [-] below which a coarse converter may rest at one value;
assumed."""

_FEWEST = 8
"""Samples at the very top that are clipped; assumed."""

_FLAT = 3.0
"""Times as many samples at the top as just below it: what goes over its top passes through both;
assumed."""

_NEAR = 0.01
"""Just below: so much of what a channel varies by [-]; assumed."""

_SAME = 1e-3
"""Relative difference of tops that are those of one range [-]; assumed."""


def without_dead_channels(
    names: Sequence[str], recordings: Sequence[Recording]
) -> tuple[list[Recording | None], list[str]]:
    """Leave dead channels out of recordings.

    Parameters
    ----------
    names : sequence of str
        Of the recordings.
    recordings : sequence of Recording

    Returns
    -------
    recordings : list of Recording or None
        One each that was given; None where nothing is left that can be looked at.
    findings : list of str
        Which channels are dead, one line each.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> sound = np.stack([np.sin(np.arange(9000.0)), np.zeros(9000)])
    >>> run = Recording(sound, 30e3, (Channel("torque"), Channel("pressure")))
    >>> (left,), findings = without_dead_channels(["a.wav"], [run])
    >>> left.channel_names, findings
    (('torque',), ['channel pressure is dead: it stays at 0 in all recordings'])
    """
    dead = _dead(recordings)
    left: list[Recording | None] = []
    for i, recording in enumerate(recordings):
        kept = [row for row in range(len(recording.channels)) if (i, row) not in dead]
        if len(kept) == len(recording.channels):
            left.append(recording)
        elif any(recording.channels[row].kind in _NEEDED for row in kept):
            channels = tuple(recording.channels[row] for row in kept)
            left.append(replace(recording, samples=recording.samples[kept], channels=channels))
        else:
            left.append(None)
    return left, dead_channels(names, recordings)


def dead_channels(names: Sequence[str], recordings: Sequence[Recording]) -> list[str]:
    """Say which channels never change, a line each; arguments as of `without_dead_channels`."""
    found: dict[str, list[tuple[str, float]]] = {}
    for i, row in sorted(_dead(recordings)):
        value = float(recordings[i].samples[row, 0])
        found.setdefault(recordings[i].channel_names[row], []).append((names[i], value))
    lines = []
    for channel, where in found.items():
        values = {value for _, value in where}
        at = f"at {values.pop() + 0.0:g}" if len(values) == 1 else "at some value"
        having = sum(channel in recording for recording in recordings)
        among = ", ".join(name for name, _ in where) if len(where) < having else "all recordings"
        lines.append(f"channel {channel} is dead: it stays {at} in {among}")
    return lines


def _dead(recordings: Sequence[Recording]) -> set[tuple[int, int]]:
    """Return recording and row of each dead channel."""
    constant: dict[str, list[tuple[int, int]]] = {}
    alive: set[str] = set()
    for i, recording in enumerate(recordings):
        for row, channel in enumerate(recording.channels):
            if channel.kind not in KINDS:
                continue
            if float(np.ptp(recording.samples[row])) == 0.0:
                constant.setdefault(channel.name, []).append((i, row))
            else:
                alive.add(channel.name)
    return {
        (i, row)
        for name, places in constant.items()
        for i, row in places
        if name not in alive or _lively(recordings[i])
    }


def _lively(recording: Recording) -> bool:
    """Whether the torque swings so that no other channel can rest within a converter's bit."""
    row = recording.first("torque")
    if row is None:
        return False
    torque = recording.samples[row]
    return float(np.std(torque)) > _LIVELY * abs(float(np.mean(torque)))


def clipped_channels(recordings: Sequence[Recording], rig: Rig) -> list[str]:
    """Say which channels reach a range that the rig file does not state.

    Parameters
    ----------
    recordings : sequence of Recording
    rig : Rig

    Returns
    -------
    list of str
        One line a channel.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> time = np.arange(9000) / 30e3
    >>> torque = 8.0 + np.clip(5.0 * np.sin(2 * np.pi * 97.0 * time), -9.0, 4.3)
    >>> run = Recording(torque[None], 30e3, (Channel("torque"),))
    >>> clipped_channels([run], load_material_rig("fluorocarbon-thesis"))
    ['channel torque clips at 12.3 N m']
    """
    lines = []
    for kind in _NEEDED:
        ends: dict[float, list[float]] = {1.0: [], -1.0: []}
        reached: dict[float, list[float]] = {1.0: [], -1.0: []}
        unit = ""
        for recording in recordings:
            if (row := recording.first(kind)) is None:
                continue
            unit = recording.channels[row].unit
            x = np.asarray(recording.samples[row], dtype=np.float64)
            for sign in ends:
                ends[sign].append(float((sign * x).max()))
                if _flat_top(sign * x):
                    reached[sign].append(float((sign * x).max()))
        stated = rig.sensors.of(kind).full_scale
        at = []
        for sign, tops in reached.items():
            if not tops or (stated and max(tops) >= stated * (1.0 - _SAME)):
                continue
            range_ = max(tops)  # nothing lies beyond a range, and whatever reaches it stops there
            alike = sum(abs(top - range_) <= _SAME * abs(range_) for top in tops)
            if alike == len(tops) and max(ends[sign]) <= range_ * (1.0 + _SAME):
                at.append(sign * range_)
        if at:
            where = " and ".join(f"{value:.3g}" for value in at)
            lines.append(f"channel {kind} clips at {where} {unit}")
    return lines


def _flat_top(x: Array) -> bool:
    """Whether samples stand at the largest value that should have gone beyond it."""
    top, size = float(x.max()), float(np.ptp(x))
    if not size:
        return False
    at_top = x >= top - 1e-6 * size
    n_top = int(np.count_nonzero(at_top))
    if n_top < _FEWEST:
        return False
    below = x[~at_top]
    step = top - float(below.max())  # of a converter, at the least
    if step > 10.0 * _NEAR * size:
        return False
    near = below > top - 1e-6 * size - max(_NEAR * size, 1.5 * step)
    return n_top > _FLAT * int(np.count_nonzero(near))


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
    recorded = [kind for kind in OUTPUTS if any(kind in one for one in case.recordings)]
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
        squares: list[Array] = []
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


def _course(recording: Recording) -> Array:
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


def _silent(course: Array) -> bool:
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
