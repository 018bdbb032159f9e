"""Faults of channels: dead, or clipped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from models.recording import Recording
from models.rig import Rig
from models.units import CHANNEL_UNITS
from noise.base.arrays import Array
from noise.diagnosis.sensors import channel_signals
from noise.diagnosis.signature import KINDS

_LIVELY = 0.1
"""Ratio of the torque's standard deviation to its mean [-] above which no working channel stays
within one step of a coarse converter; assumed."""


def without_dead_channels(
    names: Sequence[str], recordings: Sequence[Recording]
) -> tuple[list[Recording | None], list[str]]:
    """Return recordings without their dead channels, and findings on these channels.

    Parameters
    ----------
    names : sequence of str
        Names of the recordings.
    recordings : sequence of Recording

    Returns
    -------
    recordings : list of Recording or None
        One entry per input recording; None if no usable channel remains.
    findings : list of str
        One line per dead channel.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> sound = np.stack([np.sin(np.arange(9000.0)), np.zeros(9000)])
    >>> run = Recording(sound, 30e3, (Channel("torque"), Channel("pressure")))
    >>> (left,), findings = without_dead_channels(["a.wav"], [run])
    >>> left.channel_names, findings
    (('torque',), ['channel pressure is dead: it stays at 0 in all recordings'])
    """
    lines: list[str] = []
    left: list[Recording | None] = list(recordings)
    kinds = (*KINDS, "angle")
    for channel in dict.fromkeys(c.name for r in recordings for c in r.channels if c.kind in kinds):
        having = [i for i, r in enumerate(recordings) if channel in r]
        constant = [i for i in having if float(np.ptp(recordings[i][channel])) == 0.0]
        if len(constant) < len(having):  # a coarse converter has one value where nothing swings
            constant = [i for i in constant if _is_lively(recordings[i])]
        if constant:
            values = {float(recordings[i][channel][0]) for i in constant}
            at = f"{values.pop() + 0.0:g}" if len(values) == 1 else "some value"
            among = ", ".join(names[i] for i in constant)
            among = among if len(constant) < len(having) else "all recordings"
            lines.append(f"channel {channel} is dead: it stays at {at} in {among}")
        for i in constant:
            left[i] = _without(left[i], channel)
    return left, lines


def _without(recording: Recording | None, channel: str) -> Recording | None:
    """Return a recording without a channel; None if none of the needed ones remains."""
    if recording is None:
        return None
    rows = [i for i, name in enumerate(recording.channel_names) if name != channel]
    channels = tuple(recording.channels[row] for row in rows)
    if not any(one.kind in KINDS for one in channels):
        return None
    return replace(recording, samples=recording.samples[rows], channels=channels)


def _is_lively(recording: Recording) -> bool:
    """Return whether the torque swings too much for a working channel to stay constant."""
    row = recording.first("torque")
    if row is None:
        return False
    torque = recording.samples[row]
    return float(np.std(torque)) > _LIVELY * abs(float(np.mean(torque)))


_FEWEST, _FLAT = 8, 3.0
"""Least number of samples at the largest value of a clipped channel, and least ratio of it to that
just below [-]; a signal that is not clipped passes through both; assumed."""

_NEAR = 0.01
"""Width of the interval just below the largest value, as a share of the channel's peak-to-peak
value [-]; assumed."""

_SAME = 1e-3
"""Relative difference up to which two largest values are the same [-]; assumed."""


def clipped_channels(recordings: Sequence[Recording], rig: Rig) -> list[str]:
    """Return findings on channels that clip below the full scale in the rig file.

    Parameters
    ----------
    recordings : sequence of Recording
    rig : Rig

    Returns
    -------
    list of str
        One line per channel that clips.

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
    for kind in KINDS:
        full_scale = rig.sensors.of(kind).full_scale or np.inf
        at = []
        for sign in (1.0, -1.0):
            signals = [sign * x for x in channel_signals(recordings, kind)]
            limit = max((float(x.max()) for x in signals), default=np.inf)
            reached = (x for x in signals if float(x.max()) >= limit - _SAME * abs(limit))
            if limit < full_scale * (1.0 - _SAME) and any(map(_flat_top, reached)):
                at.append(f"{sign * limit:.3g}")
        if at:
            lines.append(f"channel {kind} clips at {' and '.join(at)} {CHANNEL_UNITS[kind]}")
    return lines


def _flat_top(x: Array) -> bool:
    """Return whether a signal is clipped at its largest value; `x` has shape (n,)."""
    top, size = float(x.max()), float(np.ptp(x))
    at_top = x >= top - 1e-6 * size
    n_top = int(np.count_nonzero(at_top))
    if not size or n_top < _FEWEST:
        return False
    below = x[~at_top]
    step = top - float(below.max())  # at least one step of the converter
    if step > 10.0 * _NEAR * size:
        return False
    near = below > top - 1e-6 * size - max(_NEAR * size, 1.5 * step)
    return n_top > _FLAT * int(np.count_nonzero(near))
