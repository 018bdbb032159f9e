"""Channels that hold no signal, and channels whose peaks are cut off: what is said before all else.

A dead channel is left out and the others are looked at. A channel that clips is kept, since what
clipping does to it is known; its range is told, so that somebody sets it higher.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig


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
