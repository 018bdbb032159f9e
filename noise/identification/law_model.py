"""A rig as a vector of logarithms: what a law's fit changes, and how its torque is simulated."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.rig import LawSpec
from noise.diagnosis.gap.signature import channel_signature
from noise.diagnosis.simulated.repeats import Scatter, perturb_run
from sim.friction import friction_law
from sim.motion import simulate_motion
from sim.parameters import resolve
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Rig
    from noise.identification.law_candidates import Candidate
    from noise.identification.measured import Measured

__all__ = ["LawModel", "simulated_torque", "torque_statistics"]

_SETTLING = 0.1
"""Simulated before what is looked at [s]."""

_SECONDS = 0.35
"""Looked at, at most [s]."""

_TOLERANCE = 1e-6
"""Of the solver: neighbouring motions part, but their statistics do not."""

_STIFFER = 0.22
"""Logarithm by which an elastic contact may hide stiffness of the elastomer."""

_QUANTILES = (0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 0.98)


@dataclass(frozen=True, eq=False)
class LawModel:
    """A rig with a law, as a function of a vector.

    The vector holds logarithms: stiffness of each fit, kinetic torque of each fit, what the
    critical torque exceeds it by, damping at each support, then the law's own parameters.

    Parameters
    ----------
    base : Rig
        From which the vector departs; its fits have all supports.
    candidate : Candidate
    supports : tuple of float
        [Nm/rad]
    """

    base: Rig
    candidate: Candidate
    supports: tuple[float, ...]

    @property
    def n_bushing(self) -> int:
        """Length of the vector's part that any law has."""
        return 3 * len(self.base.fits) + len(self.supports)

    def starts(self, bushing: NDArray[np.float64] | None = None) -> list[NDArray[np.float64]]:
        """Return vectors to begin at, each of the law's starts.

        Parameters
        ----------
        bushing : ndarray, shape (n_bushing,), optional
            The part that any law has, logarithms [-]; by default the base.
        """
        fits = self.base.fits
        if bushing is None:
            drops = [
                max(fit.critical_torque - fit.kinetic_torque, 0.02 * fit.kinetic_torque)
                for fit in fits
            ]
            bushing = np.log([
                *(fit.elastomer_stiffness for fit in fits), *(fit.kinetic_torque for fit in fits),
                *drops, *(fits[0].damping[support] for support in self.supports),
            ])  # fmt: skip
        begun = [bushing]
        if not self.candidate.sticks:  # what gives way in the contact looked like elastomer
            stiffer = bushing.copy()
            stiffer[: len(fits)] += _STIFFER
            begun = [bushing, stiffer]
        options = [options for _, _, options in self.candidate.free.values()]
        return [
            np.concatenate([self._begun(one, chosen), np.log(chosen)]) if chosen else one.copy()
            for one in begun
            for chosen in itertools.product(*options)
        ]

    def _begun(
        self, bushing: NDArray[np.float64], chosen: tuple[float, ...]
    ) -> NDArray[np.float64]:
        """Let a torque that fades with speed take the place of the step between two torques."""
        if "share" not in self.candidate.free:
            return bushing
        n, share = len(self.base.fits), chosen[list(self.candidate.free).index("share")]
        kinetic, drop = np.exp(bushing[n : 2 * n]), np.exp(bushing[2 * n : 3 * n])
        at_rest = kinetic / (1.0 - share)
        begun = bushing.copy()
        begun[n : 2 * n] = np.log(at_rest)
        begun[2 * n : 3 * n] = np.log(np.maximum(drop - (at_rest - kinetic), 0.1 * drop))
        return begun

    def limits(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lowest and highest vectors, shape (n_bushing + n_law,)."""
        middle = self.starts()[0][: self.n_bushing]
        low = [low for low, _, _ in self.candidate.free.values()]
        high = [high for _, high, _ in self.candidate.free.values()]
        n, s = len(self.base.fits), len(self.supports)
        away = np.log([*[1.8] * n, *[1.8] * n, *[20.0] * n, *[3.0] * s])
        return (
            np.concatenate([middle - away, np.log(low)]),
            np.concatenate([middle + away, np.log(high)]),
        )

    def _own(self, vector: NDArray[np.float64]) -> dict[str, float]:
        own = np.exp(vector[self.n_bushing :]).tolist()
        return {**self.candidate.fixed, **dict(zip(self.candidate.free, own, strict=True))}

    def friction(self, vector: NDArray[np.float64]) -> LawSpec:
        """Return the law at a vector, shape (n,), with all its parameters stated."""
        law = friction_law(self.candidate.law)
        given = {} if self.candidate.effect else self._own(vector)
        return LawSpec(law.name, dict(resolve(law.name, law.parameters, given)))

    def effects(self, vector: NDArray[np.float64]) -> tuple[LawSpec, ...]:
        """Return the effect that makes the law at a vector, shape (n,), where one does."""
        if self.candidate.effect is None:
            return ()
        return (LawSpec(self.candidate.effect, self._own(vector)),)

    def rig(self, vector: NDArray[np.float64]) -> Rig:
        """Return the rig at a vector, shape (n,)."""
        n = len(self.base.fits)
        values = np.exp(vector).tolist()
        damping = dict(zip(self.supports, values[3 * n : self.n_bushing], strict=True))
        fits = tuple(
            replace(
                fit, elastomer_stiffness=values[i], kinetic_torque=values[n + i],
                critical_torque=values[n + i] + values[2 * n + i], damping=damping,
            )
            for i, fit in enumerate(self.base.fits)
        )  # fmt: skip
        return replace(
            self.base, fits=fits, friction=self.friction(vector), effects=self.effects(vector)
        )


def simulated_torque(
    rig: Rig, like: Measured, *, seed: int | None = None
) -> tuple[NDArray[np.float64], float]:
    """Simulate the torque at the condition of a recording.

    Parameters
    ----------
    rig : Rig
    like : Measured
    seed : int, optional
        Of what one run of a rig differs from it by; without one it does not.

    Returns
    -------
    torque : ndarray, shape (n,)
        [Nm]
    speed : float
        Of the shaft [rad/s].

    Raises
    ------
    ParameterError
        It cannot be simulated.
    """
    once, at = rig, like.condition
    if seed is not None:
        once, at = perturb_run(rig, at, Scatter(), np.random.default_rng([seed, 0]))
    seconds = min(like.torque.size / like.rate, _SECONDS)
    motion = simulate_motion(
        once, ConstantSpeed(at.speed), interference=at.interference,
        support_stiffness=at.support_stiffness, seconds=_SETTLING + seconds, rate=like.rate,
        tolerance=_TOLERANCE,
    )  # fmt: skip
    return motion.torque[round(_SETTLING * like.rate) :], at.speed


def torque_statistics(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Describe a torque by what does not depend on phases, in units of what repeats differ by.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n_statistics,)
        The signature of the torque, and quantiles of it and of its slope.
    """
    signed = channel_signature(torque, rate, "torque")
    bands, cycle = signed[:-7], signed[-7:]
    cycle = cycle / np.array([0.02, 0.01, 0.02, 0.3, 0.02, 0.02, 0.03])
    mean = float(np.mean(torque))
    step = max(1, round(2e-4 * rate))
    slope = (torque[step:] - torque[:-step]) / mean
    return np.concatenate([
        np.nan_to_num(bands) / 0.25,
        cycle,
        np.quantile(torque, _QUANTILES) / mean / 0.012,
        np.quantile(slope, _QUANTILES) / 0.006,
    ])  # fmt: skip
