"""What a fit of a law searches: numbers of each recording, their means over a rig, the law's own.

All are logarithms. A rig is never quite the same twice: each recording has a bushing and torques of
its own, which scatter about those of the rig, and these are what is to be found.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.rig import Fit, LawSpec
from noise.identification.prediction import foretold, friction_of
from sim.bushing import LumpedBushing
from sim.friction import friction_law
from sim.parameters import resolve

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from noise.identification.bushing_fit import Known
    from noise.identification.law_candidates import Candidate
    from noise.identification.subjects import Subject

__all__ = ["LOCAL", "LawModel"]

LOCAL = (
    "elastomer_stiffness", "kinetic_torque", "drop", "damping", "elastomer_inertia",
    "clamp_inertia",
)  # fmt: skip
"""Numbers that each recording has of its own; the drop is from critical to kinetic torque."""

SCATTER = np.array([0.025, 0.025, 0.03, 0.03, 0.02, 0.008])
"""By which they scatter about the rig's [-]; a support's counts as its clamp's inertia."""

_MEAN_WIDTH = np.array([0.6, 0.3, 1.0, 0.6])
"""Relative standard deviation of the rig's about what is usual, or where a search begins [-]."""

_USUAL_DAMPING = 0.09
"""[Nm s/rad] (Table 5.5)"""

_LEAST_DROP = 0.004
"""Over the kinetic torque; equal torques make a weakening contact chatter."""

_STUCK, _ELASTIC = (0.95, 1.0, 1.05), (0.8, 1.0, 1.25, 1.6)
"""Factors on stiffness that are tried; an elastic contact hides some of the elastomer's [-]."""

_DAMPED = (0.55, 1.1)
"""And on damping [-]."""


@dataclass(frozen=True, eq=False)
class LawModel:
    """A law and recordings.

    The vector holds `LOCAL` of each recording, then the means of all groups, then the law's own
    parameters.

    Parameters
    ----------
    candidate : Candidate
    subjects : tuple of Subject
    known : Known
    """

    candidate: Candidate
    subjects: tuple[Subject, ...]
    known: Known

    @cached_property
    def groups(self) -> tuple[tuple[int, object], ...]:
        """Place in `LOCAL` and key of each group of recordings that share a mean."""
        return tuple(dict.fromkeys(
            (i, key) for one in self.subjects for i, key in enumerate(_keys(one))
        ))  # fmt: skip

    @cached_property
    def group_of(self) -> NDArray[np.int64]:
        """Group of each number of each recording, shape (n_recordings, 6)."""
        return np.array([
            [self.groups.index((i, key)) for i, key in enumerate(_keys(one))]
            for one in self.subjects
        ])  # fmt: skip

    @property
    def n_local(self) -> int:
        """Numbers of the recordings' own."""
        return len(LOCAL) * len(self.subjects)

    @property
    def n_common(self) -> int:
        """Numbers that any law has."""
        return self.n_local + len(self.groups)

    def local(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Numbers of the recordings' own, shape (n_recordings, 6), of a vector of shape (n,)."""
        return x[: self.n_local].reshape(-1, len(LOCAL))

    def means(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Means of the groups, shape (n_groups,), of a vector of shape (n,)."""
        return x[self.n_local : self.n_common]

    def vector(self, local: NDArray[np.float64], law: NDArray[np.float64]) -> NDArray[np.float64]:
        """Put a vector together, each group with the median of its recordings."""
        flat, group = local.ravel(), self.group_of.ravel()
        means = [np.median(flat[group == g]) for g in range(len(self.groups))]
        return np.concatenate([flat, means, law])

    def starts(self) -> Iterator[tuple[NDArray[np.float64], list[NDArray[np.float64]]]]:
        """Give places to begin at.

        Yields
        ------
        law : ndarray, shape (n_law,)
            The law's own parameters [-].
        local : list of ndarray, shape (n_recordings, 6)
            Numbers of the recordings that go with it; each recording may take another [-].
        """
        own = np.stack([one.start for one in self.subjects])
        sticks = self.candidate.sticks
        grid = list(itertools.product(
            np.log(self.candidate.drops), np.log(_STUCK if sticks else _ELASTIC), np.log(_DAMPED)
        ))  # fmt: skip
        for chosen in itertools.product(*(some for _, _, some in self.candidate.free.values())):
            begun = self._begun(own, chosen)
            yield (
                np.log(chosen),
                [
                    begun + np.array([stiffer, 0.0, drop, damped, 0.0, 0.0])
                    for drop, stiffer, damped in grid
                ],
            )

    def _begun(self, local: NDArray[np.float64], chosen: tuple[float, ...]) -> NDArray[np.float64]:
        """Let a torque that fades with speed take the place of the step between two torques."""
        if "share" not in self.candidate.free:
            return local
        share = chosen[list(self.candidate.free).index("share")]
        begun = local.copy()
        begun[:, 1] -= math.log(1.0 - share)
        return begun

    def law_like(self, other: LawModel, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the law's own parameters from another law's vector, as far as both have them."""
        theirs = dict(zip(other.candidate.free, x[other.n_common :].tolist(), strict=True))
        return np.array([
            min(max(theirs.get(name, math.log(some[0])), math.log(low)), math.log(high))
            for name, (low, high, some) in self.candidate.free.items()
        ])  # fmt: skip

    def limits(self, start: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lowest and highest vectors, shape (n,)."""
        low = np.log([low for low, _, _ in self.candidate.free.values()])
        high = np.log([high for _, high, _ in self.candidate.free.values()])
        common = start[: self.n_common]
        away = np.log([2.2, 1.6, 40.0, 5.0, 2.5, 2.5])
        width = np.concatenate([
            np.tile(away, len(self.subjects)), away[[i for i, _ in self.groups]]
        ])  # fmt: skip
        return np.concatenate([common - width, low]), np.concatenate([common + width, high])

    def specs(self, x: NDArray[np.float64]) -> tuple[LawSpec, tuple[LawSpec, ...]]:
        """Return law and effects at a vector, shape (n,)."""
        own = np.exp(x[self.n_common :]).tolist()
        values = {**self.candidate.fixed, **dict(zip(self.candidate.free, own, strict=True))}
        if self.candidate.effect is None:
            return LawSpec(self.candidate.law, values), ()
        return LawSpec(self.candidate.law), (LawSpec(self.candidate.effect, values),)

    def foretell(self, x: NDArray[np.float64]) -> list[NDArray[np.float64] | None]:
        """Foretell the excerpts of each recording at a vector, shape (n,).

        Returns
        -------
        list of ndarray, shape (n_excerpts, length)
            Torque of the cell [Nm]; None where it cannot be solved.
        """
        friction = friction_of(*self.specs(x))
        found: list[NDArray[np.float64] | None] = []
        for one, own in zip(self.subjects, np.exp(self.local(x)).tolist(), strict=True):
            _, kinetic, drop, *_ = own
            critical = kinetic + max(drop, _LEAST_DROP * kinetic)
            try:
                found.append(
                    foretold(one.excerpts, self.bushing(own, one), friction, critical, kinetic)
                )
            except ParameterError:
                found.append(None)
        return found

    def bushing(self, own: Sequence[float], one: Subject) -> LumpedBushing:
        """Bushing of a recording by its numbers, as `LOCAL` has them [SI units]."""
        stiffness, _, _, damping, inertia, clamp = own
        share = self.known.damping_share
        return LumpedBushing(
            inertia, clamp, stiffness, one.support, share * damping, (1.0 - share) * damping
        )

    def extended(
        self, part: LawModel, x: NDArray[np.float64], places: Sequence[int]
    ) -> NDArray[np.float64]:
        """Take over the vector of a model of some recordings, at these places among all.

        The others begin at the means, or where they are by themselves if there is none.
        """
        known = dict(zip(part.groups, part.means(x).tolist(), strict=True))
        begun = self.vector(np.stack([one.start for one in self.subjects]), x[part.n_common :])
        means = np.array([
            known.get(group, own) for group, own in zip(self.groups, self.means(begun), strict=True)
        ])  # fmt: skip
        local = means[self.group_of]
        local[list(places)] = part.local(x)
        return np.concatenate([local.ravel(), means, x[part.n_common :]])

    def rig(self, x: NDArray[np.float64], base: Rig, material: str) -> Rig:
        """Return the rig at a vector, shape (n,); damping where nothing slid is the support's."""
        values = dict(zip(self.groups, np.exp(self.means(x)).tolist(), strict=True))
        cells = {
            (one.interference, one.support): values[3, (one.interference, one.support)]
            for one in self.subjects
        }
        supports = sorted({support for _, support in cells})

        def damping(fit: float, support: float) -> float:
            alike = [value for (_, at), value in cells.items() if at == support]
            return float(cells.get((fit, support), np.exp(np.mean(np.log(alike)))))

        fits = []
        for fit in sorted({one.interference for one in self.subjects}):
            stiffness, kinetic, drop = (values[i, fit] for i in range(3))
            fits.append(
                Fit(
                    fit, stiffness, kinetic + max(drop, _LEAST_DROP * kinetic), kinetic,
                    {support: damping(fit, support) for support in supports},
                )
            )  # fmt: skip
        law, effects = self.specs(x)
        declared = friction_law(law.name)
        return replace(
            base, material=material, elastomer_inertia=values[4, None],
            clamp_inertia=values[5, None], elastomer_damping_share=self.known.damping_share,
            fits=tuple(fits), effects=effects, assumed=(),
            friction=LawSpec(law.name, resolve(law.name, declared.parameters, law.parameters)),
        )  # fmt: skip

    def priors(self, loose: float = 1.0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return matrix and target of what is known: residuals are matrix @ x - target."""
        n = self.n_common + self.candidate.n_parameters
        rows, target = [], []

        def row(places: dict[int, float], value: float) -> None:
            line = np.zeros(n)
            for place, factor in places.items():
                line[place] = factor
            rows.append(line)
            target.append(value)

        for r, groups in enumerate(self.group_of.tolist()):
            for i, group in enumerate(groups):
                weight = 1.0 / (loose * SCATTER[i])
                row({len(LOCAL) * r + i: weight, self.n_local + group: -weight}, 0.0)
        own = np.stack([one.start for one in self.subjects])
        width = np.array([*_MEAN_WIDTH, self.known.inertia_error, self.known.inertia_error])
        for g, (i, _) in enumerate(self.groups):
            usual = float(np.median(own[self.group_of[:, i] == g, i]))
            if i == LOCAL.index("damping"):
                usual = math.log(_USUAL_DAMPING)
            row({self.n_local + g: 1.0 / width[i]}, usual / width[i])
        for j, (low, high, _) in enumerate(self.candidate.free.values()):
            weight = 2.0 / math.log(high / low)
            row({self.n_common + j: weight}, weight * 0.5 * math.log(low * high))
        return np.array(rows), np.array(target)


def _keys(one: Subject) -> tuple[object, ...]:
    """Say what each number of `LOCAL` of a recording shares its mean with."""
    fit = one.interference
    return fit, fit, fit, (fit, one.support), None, None
