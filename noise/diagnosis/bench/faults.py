"""Channels that hold no signal, and channels whose peaks are cut off: what is said before all else.

A dead channel is left out and the others are looked at. A channel that clips is kept, since what
clipping does to it is known; its range is told, so that somebody sets it higher.

Stated conditions are held against what torque and angle say themselves: speed, its sign, order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from noise.diagnosis.bench.channels import factor_words, unit_of

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig
    from noise.diagnosis.bench.channels import Levels
    from noise.diagnosis.case import Case


_SPEED = 0.2
"""Difference of logarithms of the speed that is stated and that of the angle; a speed that is read
off a dial errs by 3 %, and a fluctuating one evens out [-]; assumed."""

_STILL = 0.05
"""Share of the stated speed below which an angle does not turn [-]; assumed."""

_ERRORS = {"speed": 0.05, "torque": 0.2}
"""Differences of logarithms between a recording and its condition that count as one [-];
assumed."""

_SHUFFLED = 3.0
"""Mean of such differences from which conditions do not belong to their recordings [-];
assumed."""

_SORTED = 1.0
"""Mean of such differences below which another order fits [-]; assumed."""


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
        kinetic = _kinetic(case.rig, recording.condition.interference)
        stated.append((np.log(abs(one.speed)), np.log(kinetic)))
        seen.append((np.log(abs(one.turned)), np.log(abs(one.torque) * kinetic)))
    x, y = np.array(seen), np.array(stated)
    x = x - np.median(x - y, axis=0)  # a wrong unit or gain is no wrong order
    size = np.array(list(_ERRORS.values()))
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


def _kinetic(rig: Rig, interference: float | None) -> float:
    assert interference is not None  # `usable` made it so
    return rig.fit(interference).kinetic_torque


KINDS = ("torque", "acceleration", "pressure", "angle")

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


@dataclass(frozen=True, eq=False)
class Sounding:
    """Recordings without their dead channels.

    Parameters
    ----------
    recordings : tuple of Recording, or None
        One each that was given; None where nothing is left that can be looked at.
    findings : tuple of str
        Which channels are dead, one line each.
    """

    recordings: tuple[Recording | None, ...]
    findings: tuple[str, ...] = ()


def without_dead_channels(names: Sequence[str], recordings: Sequence[Recording]) -> Sounding:
    """Leave dead channels out of recordings.

    Parameters
    ----------
    names : sequence of str
        Of the recordings.
    recordings : sequence of Recording

    Returns
    -------
    Sounding

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> sound = np.stack([np.sin(np.arange(9000.0)), np.zeros(9000)])
    >>> run = Recording(sound, 30e3, (Channel("torque"), Channel("pressure")))
    >>> found = without_dead_channels(["a.wav"], [run])
    >>> found.recordings[0].channel_names, found.findings
    (('torque',), ('channel pressure is dead: it stays at 0 in all recordings',))
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
    return Sounding(tuple(left), tuple(dead_channels(names, recordings)))


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


def _flat_top(x: NDArray[np.float64]) -> bool:
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
