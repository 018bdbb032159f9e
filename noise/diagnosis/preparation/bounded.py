"""As much of long and finely sampled recordings as a diagnosis looks at.

Whatever is compared with a recording is simulated as long and as finely, many times over. Two
seconds hold a hundred slips and more, and nothing above 10 kHz counts, so that more of a recording
would cost in proportion and tell little.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.sensors import Sensor
from sim.acquisition import decimate

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig


LONGEST = 2.0
"""Of a recording the last part of this length is looked at, in which it has settled [s]; what a
diagnosis may cost settles it; assumed."""

HIGHEST_RATE = 51.2e3
"""Recordings at higher rates are filtered and thinned out [Hz]; assumed."""


def bounded(
    rig: Rig, recordings: Sequence[Recording]
) -> tuple[Rig, tuple[Recording, ...], tuple[str, ...]]:
    """Keep of recordings what a diagnosis looks at.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording

    Returns
    -------
    rig : Rig
        Its sensors as they are at the lower rate: with less noise, and without steps.
    recordings : tuple of Recording
        At most `LONGEST`, at `HIGHEST_RATE` or below.
    notes : tuple of str
        What was left out, a line each.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> long = Recording(np.zeros((1, 288_000)), 96e3, (Channel("torque"),))
    >>> _, (short,), notes = bounded(load_material_rig("PDMS"), [long])
    >>> short.rate, short.duration
    (48000.0, 2.0)
    >>> print("; ".join(notes))
    1 of 1 recordings is sampled above 51.2 kHz and was filtered and thinned out; 1 of 1 recordings
    is longer than 2 s, of which the last 2 s were looked at
    """
    factors = [math.ceil(recording.rate / HIGHEST_RATE) for recording in recordings]
    kept = tuple(_last(_thinned(r, k)) for r, k in zip(recordings, factors, strict=True))
    n, fine = len(kept), sum(k > 1 for k in factors)
    long = sum(recording.duration > LONGEST for recording in recordings)
    notes = []
    if fine:
        are = "is" if fine == 1 else "are"
        notes.append(
            f"{fine} of {n} recordings {are} sampled above {HIGHEST_RATE / 1e3:g} kHz and "
            f"{'was' if fine == 1 else 'were'} filtered and thinned out"
        )
    if long:
        notes.append(
            f"{long} of {n} recordings {'is' if long == 1 else 'are'} longer than {LONGEST:g} s, "
            f"of which the last {LONGEST:g} s were looked at"
        )
    return _with_thinned_sensors(rig, min(factors, default=1)), kept, tuple(notes)


def _thinned(recording: Recording, factor: int) -> Recording:
    if factor == 1:
        return recording
    samples = np.stack([decimate(row, factor) for row in recording.samples])
    return replace(recording, samples=samples, rate=recording.rate / factor)


def _last(recording: Recording) -> Recording:
    n = round(LONGEST * recording.rate)
    if recording.samples.shape[1] <= n:
        return recording
    return replace(recording, samples=np.ascontiguousarray(recording.samples[:, -n:]))


def _with_thinned_sensors(rig: Rig, factor: int) -> Rig:
    if factor == 1:
        return rig
    thinned = {kind: _thinned_sensor(s, factor) for kind, s in rig.sensors.by_kind.items()}
    return replace(rig, sensors=replace(rig.sensors, by_kind=thinned))


def _thinned_sensor(sensor: Sensor, factor: int) -> Sensor:
    """Of white noise a filter passes what it passes of the band; steps become such noise."""
    if sensor.noise is None:
        return replace(sensor, bits=None)
    noise = math.sqrt((sensor.noise**2 + sensor.step**2 / 12.0) / factor)
    return replace(sensor, noise=noise, bits=None)
