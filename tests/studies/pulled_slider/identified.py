"""Spring, friction and ageing of a pulled slider, read off records as those of a bushing are.

The spring is the elastomer, the slider its surface, the table the shaft; metres stand for radians
and force over weight for torque, so what comes out is stiffness over weight. The static part is the
most frequent slope of force over pull: while the slider sticks it is that of the spring and of what
yields in the contact in series. A slider that hardly sticks oscillates at the frequency of its
spring, whatever it weighs. Tops and bottoms of the cycles are static friction and what a slip ends
at, half-way between which lies kinetic friction while little is lost; tops that rise with the
logarithm of the time in stick are ageing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import savgol_filter, welch

from tests.studies.pulled_slider.cycles import turning_points

if TYPE_CHECKING:
    from tests.studies.pulled_slider.record import PulledRecord

__all__ = ["IdentifiedSlider", "identify_slider"]

_RISE = 0.02
"""Force over weight by which it rises while a slope is taken, for a slider of `_USUAL` weight."""

_USUAL = 0.3
"""[N]"""

_SLOPES = np.geomspace(0.1, 2.0, 60)
"""Classes of slopes, over that of a slider of the usual weight."""

_LOWEST = 3.0
"""Lines below come from the surface [Hz]."""

_CYCLE = 0.25
"""Height of a cycle over the range of the force."""


@dataclass(frozen=True)
class IdentifiedSlider:
    """What one record says.

    Parameters
    ----------
    stiffness : float
        Of the spring, and what yields with it, over the slider's weight [1/m].
    frequency : float
        Of the strongest line [Hz].
    static, kinetic : float
        Friction coefficients [-].
    ageing : float
        By which the static one grows when it sticks longer by a factor e [-].
    cycles : int
        That were seen.
    """

    stiffness: float
    frequency: float
    static: float
    kinetic: float
    ageing: float
    cycles: int


def identify_slider(record: PulledRecord) -> IdentifiedSlider:
    """Identify spring and friction of a record."""
    rate = record.recording.rate
    force = median_filter(record.recording["force"], 5)
    expected = record.stiffness / _USUAL
    window = max(5, round(_RISE / (expected * record.pull) * rate) | 1)
    slope = savgol_filter(force, window, 1, deriv=1, delta=1.0 / rate) / record.pull / expected
    counts, edges = np.histogram(slope, bins=_SLOPES)
    i = int(np.argmax(counts))
    inside = slope[(slope >= edges[i] / 1.1) & (slope < edges[i + 1] * 1.1)]
    line, power = welch(force, rate, nperseg=min(force.size, round(2.0 * rate)))
    power[line < _LOWEST] = 0.0
    bottoms, tops = turning_points(force, max(0.02, _CYCLE * float(np.ptp(force))))
    waited = np.log((tops - bottoms) / rate)
    ageing = float(np.polyfit(waited, force[tops], 1)[0]) if tops.size > 9 else math.nan
    static, ended = (float(np.median(force[at])) for at in (tops, bottoms))
    return IdentifiedSlider(
        expected * float(np.median(inside)), float(line[np.argmax(power)]), static,
        0.5 * (static + ended), ageing, tops.size,
    )  # fmt: skip
