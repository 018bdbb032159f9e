"""Recordings that laws are fitted to, and where a search begins with each.

Stick-slip is chaotic over many cycles but not within one. So a model begins where a recording
shows what it does, and foretells a cycle or two. In the midst of a slip a contact has forgotten
what it did before, and stick, break and slip are still to come.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from noise.base.arrays import Array
from noise.identification.bushing_fit import Known, TorqueSpectrum, torque_spectrum
from noise.identification.measured import Measured
from noise.identification.outcome import Seen
from sim.bushing import LumpedBushing

_LOOKED_AT = 0.42
"""Of a recording; what a transform of it costs [s]; assumed."""

_FORETOLD = 0.05
"""Of a recording, all excerpts together [s]; assumed."""

_CYCLES = 1.5
_SHORTEST, _LONGEST = 3e-3, 24e-3
"""An excerpt lasts so many cycles, but no less and no longer [s]; assumed."""

_MOST = 10
_CLAMP_RINGS = 0.06
"""What the clamp did before the recording is felt so long beyond what is left out of it [s];
assumed."""

_RUN_IN = 9e-3
"""Angle by which a contact has slid before an excerpt, to forget what it was [rad]; assumed."""

_LONGEST_RUN_IN = 12e-3
"""[s]"""


@dataclass(frozen=True, eq=False)
class Excerpts:
    """Excerpts of one recording.

    Parameters
    ----------
    spectrum : TorqueSpectrum
    starts : ndarray of int, shape (n_excerpts,)
        Samples of `spectrum` at which they begin.
    length : int
        Of each [samples].
    run_in : int
        Before each [samples].
    torque : ndarray, shape (n_excerpts, length)
        As recorded [Nm].
    scale : ndarray, shape (n_excerpts, length)
        By what a good model may miss it [Nm].
    """

    spectrum: TorqueSpectrum
    starts: NDArray[np.int64]
    length: int
    run_in: int
    torque: Array
    scale: Array

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.spectrum.rate

    def some(self, n: int) -> Excerpts:
        """Return `n` of them at most, evenly chosen."""
        size = self.starts.size
        chosen = np.unique(np.linspace(0, size - 1, min(n, size)).round().astype(int))
        return replace(
            self, starts=self.starts[chosen], torque=self.torque[chosen], scale=self.scale[chosen]
        )


_LEVEL = 2e-3
"""Share of the mean torque that a model may miss a torque by; assumed."""

_JITTER = 8e-6
"""And the time by which it may be early or late [s]; assumed."""


def excerpts_of(measured: Measured, bushing: LumpedBushing) -> Excerpts | None:
    """Choose excerpts of a recording.

    Parameters
    ----------
    measured : Measured
    bushing : LumpedBushing
        A guess; it tells where the contact slides fastest.

    Returns
    -------
    Excerpts or None
        None where nothing slips.
    """
    spectrum = torque_spectrum(measured, _LOOKED_AT)
    rate, n = spectrum.rate, spectrum.torque.size
    v = spectrum.contact(bushing).sliding_speed
    threshold = 0.5 * float(np.quantile(v, 0.995))
    above = np.concatenate([[False], v > threshold, [False]])
    edges = np.flatnonzero(np.diff(above.astype(np.int8)))
    peaks = np.array(
        [a + int(np.argmax(v[a:b])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    )
    if peaks.size < 4:
        return None
    cycle = float(np.median(np.diff(peaks))) / rate
    length = round(rate * min(max(_CYCLES * cycle, _SHORTEST), _LONGEST))
    speed = float(np.mean(spectrum.shaft_speed))
    run_in = round(rate * min(_RUN_IN / speed, _LONGEST_RUN_IN))
    first = max(run_in, 0 if bushing.clamp_is_fixed else round(_CLAMP_RINGS * rate))
    peaks = peaks[(peaks >= first) & (peaks + length <= n)]
    if not peaks.size:
        return None
    wanted = min(_MOST, max(3, math.ceil(_FORETOLD * rate / length)))
    starts = np.unique(peaks[np.linspace(0, peaks.size - 1, wanted).round().astype(int)])
    inside = starts[:, None] + np.arange(length)
    kept = spectrum.kept.start
    slope = np.abs(np.gradient(spectrum.torque) * rate)
    scale = np.hypot(_LEVEL * spectrum.mean, _JITTER * slope)
    return Excerpts(spectrum, starts, length, run_in, measured.torque[kept:][inside], scale[inside])


_LEAST_DROP = 0.05
"""What the critical torque exceeds the kinetic one by where a search begins, at least [-];
assumed."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A recording that laws are fitted to.

    Parameters
    ----------
    measured : Measured
    excerpts : Excerpts
    start : ndarray, shape (7,)
        Where a search begins: logarithms of `noise.identification.law_model.LOCAL` [-].
    """

    measured: Measured
    excerpts: Excerpts
    start: Array

    @property
    def interference(self) -> float:
        """Fit [m]."""
        return self.measured.condition.interference

    @property
    def support(self) -> float:
        """Stiffness of the support [Nm/rad]."""
        return self.measured.condition.support_stiffness

    def with_some(self, n: int) -> Subject:
        """Return it with `n` excerpts at most."""
        return replace(self, excerpts=self.excerpts.some(n))


def subjects_of(seen: Sequence[Seen], known: Known) -> list[Subject]:
    """Make subjects of the recordings that slip, each begun at the median of its interference.

    Parameters
    ----------
    seen : sequence of Seen
    known : Known

    Returns
    -------
    list of Subject
    """
    slipping = [one for one in seen if one.levels.slips]
    subjects = []
    for one in slipping:
        c, kinetic = one.measured.condition, one.levels.kinetic
        alike = [o for o in slipping if o.measured.condition.interference == c.interference]
        stiffness = float(np.median([o.fit.bushing.elastomer_stiffness for o in alike]))
        damping = float(np.median([o.fit.damping for o in alike]))
        drop = float(np.median([o.levels.critical / o.levels.kinetic - 1.0 for o in alike]))
        bushing = LumpedBushing(
            known.elastomer_inertia, known.clamp_inertia, stiffness, c.support_stiffness,
            known.damping_share * damping, (1.0 - known.damping_share) * damping,
        )  # fmt: skip
        excerpts = excerpts_of(one.measured, bushing)
        if excerpts is not None:
            start = np.log([
                stiffness, kinetic, max(drop, _LEAST_DROP) * kinetic, damping,
                known.elastomer_inertia, known.clamp_inertia, known.damping_share,
            ])  # fmt: skip
            subjects.append(Subject(one.measured, excerpts, start))
    return subjects
