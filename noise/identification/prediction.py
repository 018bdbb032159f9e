"""Torque that a law of friction predicts of excerpts of a recording.

Stick-slip is chaotic over many cycles but not within one. So a model begins where a recording
shows what it does, and predicts a cycle or two. In the midst of a slip a contact has forgotten
what it did before, and stick, break and slip are still to come.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.rig import LawSpec
from noise.base.arrays import Array
from noise.identification.bushing_fit import TorqueSpectrum, torque_spectrum
from noise.identification.measured import Measured
from sim.bushing import LumpedBushing
from sim.contact import CRITICAL, KINETIC, N_CONTACT, address_of, call_law_at
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.friction.law import FrictionLaw
from sim.motion import contact_hooks
from sim.parameters import resolve
from sim.solvers.contact_solver import ContactRun, Hook

_LOOKED_AT = 0.42
"""Of a recording; what a transform of it costs [s]; assumed."""

_PREDICTED = 0.05
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
    wanted = min(_MOST, max(3, math.ceil(_PREDICTED * rate / length)))
    starts = np.unique(peaks[np.linspace(0, peaks.size - 1, wanted).round().astype(int)])
    inside = starts[:, None] + np.arange(length)
    kept = spectrum.kept.start
    slope = np.abs(np.gradient(spectrum.torque) * rate)
    scale = np.hypot(_LEVEL * spectrum.mean, _JITTER * slope)
    return Excerpts(spectrum, starts, length, run_in, measured.torque[kept:][inside], scale[inside])


_TOLERANCE = 1e-6
"""Of the solver, over one cycle."""

_SUBSTEPS = 12
"""Between two samples, of a contact that is driven: it settles within microseconds."""


class Friction(NamedTuple):
    """A law of friction ready to be solved."""

    law: FrictionLaw
    coefficients: Array
    hooks: tuple[Hook, ...]


def friction_of(law: LawSpec, effects: tuple[LawSpec, ...] = ()) -> Friction:
    """Prepare a law and the effects that act on the contact.

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    declared = friction_law(law.name)
    values = resolve(f"friction law {law.name!r}", declared.parameters, law.parameters)
    hooks = contact_hooks(activated(effects, EFFECTS), np.random.default_rng(0))
    return Friction(declared, declared.coefficients(values), hooks)


@njit(cache=True, error_model="numpy", nogil=True)
def _driven(law, speed, step, substeps, c, contact, state) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Carry the inner state of a contact through sliding that is known (Heun's method)."""
    first, second, guess = np.zeros_like(state), np.zeros_like(state), np.zeros_like(state)
    h = step / substeps
    for i in range(speed.size - 1):
        slope = (speed[i + 1] - speed[i]) / substeps
        for j in range(substeps):
            v = speed[i] + slope * j
            call_law_at(law, v, c.ctypes, contact.ctypes, state.ctypes, first.ctypes)
            for m in range(state.size):
                guess[m] = state[m] + h * first[m]
            call_law_at(law, v + slope, c.ctypes, contact.ctypes, guess.ctypes, second.ctypes)
            for m in range(state.size):
                state[m] += 0.5 * h * (first[m] + second[m])


def predicted_torque(
    excerpts: Excerpts, bushing: LumpedBushing, friction: Friction, critical: float, kinetic: float
) -> Array:
    """Return the predicted torque of the cell in each excerpt.

    Parameters
    ----------
    excerpts : Excerpts
    bushing : LumpedBushing
    friction : Friction
    critical, kinetic : float
        Torques as the law means them [Nm].

    Returns
    -------
    ndarray, shape (n_excerpts, length)
        [Nm]

    Raises
    ------
    ParameterError
        The friction is too steep to be solved.
    """
    step, packed, law = 1.0 / excerpts.rate, bushing.packed(), friction.law
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL], contact[KINETIC] = critical, kinetic
    motions, run_ins, speeds = _begun(
        excerpts, bushing.elastomer_stiffness, bushing.elastomer_damping,
        bushing.support_stiffness, bushing.support_damping, bushing.clamp_inertia,
    )  # fmt: skip
    torque = np.empty((excerpts.starts.size, excerpts.length))
    for row, motion, run_in, speed in zip(torque, motions, run_ins, speeds, strict=True):
        inner = law.state()
        if inner.size:
            _driven(
                address_of(law.torque), run_in, step, _SUBSTEPS, friction.coefficients, contact,
                inner,
            )  # fmt: skip
        run = ContactRun(
            packed, critical, kinetic, float(speed), step, law=law.torque,
            coefficients=friction.coefficients, law_state=inner, hooks=friction.hooks,
            tolerance=_TOLERANCE, motion=motion,
        )  # fmt: skip
        row[:] = run.advance(np.full(excerpts.length, speed), excerpts.length)[0][:, 1]
    return torque


@lru_cache(maxsize=600)
def _begun(
    excerpts: Excerpts, stiffness: float, damping: float, support: float, support_damping: float,
    clamp_inertia: float,
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Motion where each excerpt begins, sliding speed before it, and the shaft's speed in it.

    Kept, since a search moves the bushing less often than the rest.
    """
    spectrum = excerpts.spectrum
    bushing = LumpedBushing(1.0, clamp_inertia, stiffness, support, damping, support_damping)
    states = spectrum.states(bushing)
    inside = excerpts.starts[:, None] + np.arange(excerpts.length)
    before = excerpts.starts[:, None] + np.arange(-excerpts.run_in, 1)
    return (
        np.ascontiguousarray(states[:, excerpts.starts].T),
        spectrum.shaft_speed[before] - states[1][before],
        spectrum.shaft_speed[inside].mean(axis=1),
    )
