"""Prediction of the torque in excerpts of a recording by a friction law.

Stick-slip is chaotic over many cycles but not within one. So a prediction starts from the recorded
state and covers a cycle or two. It starts in the middle of a slip, where the contact has lost its
memory, and contains the following stick, break and slip.
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
"""Length of the part of a recording that excerpts come from [s]; assumed."""

_PREDICTED = 0.05
"""Length of all excerpts together [s]; assumed."""

_CYCLES = 1.5
_SHORTEST, _LONGEST = 3e-3, 24e-3
"""Length of an excerpt in cycles, and its bounds [s]; assumed."""

_MOST = 10
_CLAMP_RINGS = 0.06
"""Decay time of the clamp's initial ringing beyond the part that is left out [s]; assumed."""

_RUN_IN = 9e-3
"""Sliding angle before an excerpt, after which a contact has no memory [rad]; assumed."""

_LONGEST_RUN_IN = 12e-3
"""Longest time of that sliding [s]."""


@dataclass(frozen=True, eq=False)
class Excerpts:
    """Excerpts of a recording.

    Parameters
    ----------
    spectrum : TorqueSpectrum
    starts : ndarray of int, shape (n_excerpts,)
        First samples, in `spectrum`.
    length : int
        Length of each [samples].
    run_in : int
        Length before each [samples].
    torque : ndarray, shape (n_excerpts, length)
        Recorded torque [Nm].
    scale : ndarray, shape (n_excerpts, length)
        Expected error of a good model [Nm].
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
        """Return at most `n` of the excerpts, evenly spaced."""
        size = self.starts.size
        chosen = np.unique(np.linspace(0, size - 1, min(n, size)).round().astype(int))
        return replace(
            self, starts=self.starts[chosen], torque=self.torque[chosen], scale=self.scale[chosen]
        )


_LEVEL = 2e-3
"""Expected error of the torque, over its mean; assumed."""

_JITTER = 8e-6
"""Expected error of the time [s]; assumed."""


def excerpts_of(measured: Measured, bushing: LumpedBushing) -> Excerpts | None:
    """Choose excerpts of a recording.

    Parameters
    ----------
    measured : Measured
    bushing : LumpedBushing
        Estimate, to locate the fastest sliding.

    Returns
    -------
    Excerpts or None
        None if there are too few slips.
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
    first = spectrum.used.start
    slope = np.abs(np.gradient(spectrum.torque) * rate)
    scale = np.hypot(_LEVEL * spectrum.mean, _JITTER * slope)
    return Excerpts(
        spectrum, starts, length, run_in, measured.torque[first:][inside], scale[inside]
    )


_TOLERANCE = 1e-6
"""Tolerance of the solver over one cycle."""

_SUBSTEPS = 12
"""Steps between two samples of a driven contact, which settles within microseconds."""


class Friction(NamedTuple):
    """Friction law with its coefficients and the effects on the contact."""

    law: FrictionLaw
    coefficients: Array
    hooks: tuple[Hook, ...]


def friction_of(law: LawSpec, effects: tuple[LawSpec, ...] = ()) -> Friction:
    """Return a friction law with the effects that act on the contact.

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
    """Integrate the inner state of a contact over a given sliding speed (Heun's method)."""
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
        Torques of the law [Nm].

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
    """Return the initial motion of each excerpt, sliding speed before and shaft speed in it.

    Cached, since a search moves the bushing less often than the rest.
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
