"""Whether the structure fits: recorded acceleration and sound against what the rig predicts.

An identification changes bushing and contact; clamp, beams and plate stay those that are known, the
shipped bench's where nothing is. How far off these are, levels tell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from models.errors import ParameterError
from models.rig import Rig
from noise.diagnosis.bench.units import unit_of
from sim.run import simulate
from sim.temperature import at_temperature

if TYPE_CHECKING:
    from noise.identification.measured import Measured


_BAND = 50.0, 10e3
"""In which levels are compared [Hz]; assumed."""

_SECONDS = 0.4
_MOST = 4
"""Recordings that are looked at for each channel."""

_CLOSE = 3.0
"""Offset up to which a structure is said to fit [dB]; assumed."""

_KINDS = {"acceleration": "acceleration", "pressure": "sound"}


def level_offsets(rig: Rig, recordings: Sequence[Measured]) -> dict[str, float]:
    """Return by how much recorded levels exceed simulated ones, median over recordings.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Measured

    Returns
    -------
    dict of str to float
        By channel [dB]; without those that no recording has.
    """
    offsets: dict[str, list[float]] = {}
    for kind in _KINDS:
        having = [one for one in recordings if one.recording.first(kind) is not None][:_MOST]
        for one in having:
            row, at = one.recording.first(kind), one.condition
            ambient = replace(at_temperature(rig, at.temperature), temperature=None)
            try:
                run = simulate(
                    ambient, at.speed, interference=at.interference,
                    support_stiffness=at.support_stiffness, seconds=_SECONDS,
                )  # fmt: skip
            except ParameterError:
                continue
            assert row is not None  # it has the channel
            levels = (
                _level(np.asarray(one.recording.samples[row], dtype=np.float64), one.rate),
                _level(run.recording[kind], run.recording.rate),
            )
            if all(map(math.isfinite, levels)):
                offsets.setdefault(kind, []).append(levels[0] - levels[1])
    return {kind: float(np.median(found)) for kind, found in offsets.items()}


def _level(signal: NDArray[np.float64], rate: float) -> float:
    frequency, density = welch(signal, rate, nperseg=min(signal.size, 4096))
    inside = (frequency >= _BAND[0]) & (frequency <= min(_BAND[1], 0.4 * rate))
    power = float(np.sum(density[inside]) * (frequency[1] - frequency[0]))
    return 10.0 * math.log10(power) if power > 0.0 and math.isfinite(power) else -math.inf


def structure_notes(rig: Rig, recordings: Sequence[Measured]) -> list[str]:
    """Say how recorded acceleration and sound compare with what the rig's structure predicts.

    Returns
    -------
    list of str
        Empty where neither was recorded.
    """
    notes = []
    for kind, offset in level_offsets(rig, recordings).items():
        told = f"measured {_KINDS[kind]} is {abs(offset):.0f} dB "
        told += "above" if offset > 0.0 else "below"
        if abs(offset) <= _CLOSE:
            told = f"measured {_KINDS[kind]} is within {_CLOSE:g} dB of"
        unit = unit_of(kind, 10.0 ** (offset / 20.0))
        after = "; measure responses with frf" + (f", or is it in {unit}?" if unit else "")
        after = "" if abs(offset) <= _CLOSE else after
        notes.append(f"the structure is that of the known bench: {told} what it predicts{after}")
    return notes
