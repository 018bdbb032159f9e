"""Hierarchical model of a friction law: numbers of each recording, of the rig and of the law.

All are logarithms. No two runs of a rig are alike: each recording has a bushing and torques of its
own, which scatter about those of the rig by a known amount. Those of the rig are to be determined.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Fit, LawSpec, Rig
from noise.base import packaged_toml
from noise.base.arrays import Array
from noise.identification.bushing_fit import Known
from noise.identification.measured import Measured
from noise.identification.outcome import RecordingFit
from noise.identification.prediction import Excerpts, excerpts_of, friction_of, predicted_torque
from sim.bushing import LumpedBushing
from sim.friction import friction_law
from sim.parameters import resolve

_SCATTER = np.array([0.025, 0.025, 0.03, 0.03, 0.02, 0.008, 0.01])
"""Scatter of the numbers `LOCAL` of recordings about those of the rig [-]; that of a support counts
as inertia of its clamp; assumed."""

_MEAN_WIDTH = np.array([0.6, 0.3, 1.0, 0.6])
"""Prior relative standard deviation of the first four numbers of the rig [-]; assumed."""

_USUAL_DAMPING = 0.09
"""Prior damping [Nm s/rad] (Table 5.5)."""

SHARE_ASSUMED = 0.02
"""Relative standard error of a damping share that recordings cannot determine; assumed."""


LOCAL = (
    "elastomer_stiffness", "kinetic_torque", "drop", "damping", "elastomer_inertia",
    "clamp_inertia", "elastomer_damping_share",
)  # fmt: skip
"""Numbers of each recording; the drop is from critical to kinetic torque."""

_LEAST_DROP = 0.004
"""Smallest drop over the kinetic torque: with none a weakening contact chatters; assumed."""

_LARGEST_SHARE = 0.97


@dataclass(frozen=True)
class Candidate:
    """Friction law that is fitted.

    Parameters
    ----------
    name, words : str
        Name in tables, and description on pages.
    law : str
        Of `sim.friction`.
    effect : str, optional
        Of `sim.effects`; the searched parameters then belong to it.
    free : mapping of str to (float, float, sequence of float)
        Searched parameters: lower bound, upper bound and starts [the law's units].
    fixed : mapping of str to float
        Fixed parameters that differ from the law's defaults [the law's units].
    drops : sequence of float
        Starts of the drop, over the difference of the torque levels [-].
    """

    name: str
    words: str
    law: str
    effect: str | None = None
    free: Mapping[str, tuple[float, float, Sequence[float]]] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    drops: Sequence[float] = (1.0,)

    @property
    def in_rig_file(self) -> str:
        """Law, and effect if there is one, as in a rig file."""
        effect = f", with the effect {self.effect}" if self.effect else ""
        return f'law = "{self.law}"{effect}'

    @property
    def sticks(self) -> bool:
        """Whether the contact truly sticks."""
        return self.law == "coulomb"


CANDIDATES = tuple(
    Candidate(name, **row)
    for name, row in packaged_toml("noise.identification", "candidates.toml").items()
)
"""Friction laws that are fitted, by rising number of parameters."""


_LEAST_START = 0.05
"""Smallest drop over the kinetic torque at the start of a search [-]; assumed."""


@dataclass(frozen=True, eq=False)
class Subject:
    """Recording that laws are fitted to.

    Parameters
    ----------
    measured : Measured
    excerpts : Excerpts
    start : ndarray, shape (7,)
        Start of a search: logarithms of `noise.identification.law_model.LOCAL` [-].
    """

    measured: Measured
    excerpts: Excerpts
    start: Array

    @property
    def interference(self) -> float:
        """Interference [m]."""
        return self.measured.condition.interference

    @property
    def support(self) -> float:
        """Stiffness of the support [Nm/rad]."""
        return self.measured.condition.support_stiffness


def subjects_of(recordings: Sequence[RecordingFit], known: Known) -> list[Subject]:
    """Return the recordings that slip, with starts at the medians of their interference.

    Parameters
    ----------
    recordings : sequence of RecordingFit
    known : Known

    Returns
    -------
    list of Subject
    """
    slipping = [one for one in recordings if one.levels.slips]
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
                stiffness, kinetic, max(drop, _LEAST_START) * kinetic, damping,
                known.elastomer_inertia, known.clamp_inertia, known.damping_share,
            ])  # fmt: skip
            subjects.append(Subject(one.measured, excerpts, start))
    return subjects


@dataclass(frozen=True, eq=False)
class LawModel:
    """Model of recordings by a friction law.

    Its vector holds `LOCAL` of each recording, then the means of all groups, then the law's own
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
        """Groups of recordings that share a mean: place in `LOCAL`, and key."""
        return tuple(dict.fromkeys(
            (i, key) for one in self.subjects for i, key in enumerate(_keys(one))
        ))  # fmt: skip

    @cached_property
    def group_of(self) -> NDArray[np.int64]:
        """Index of the group of each number of each recording, shape (n_recordings, 7)."""
        return np.array([
            [self.groups.index((i, key)) for i, key in enumerate(_keys(one))]
            for one in self.subjects
        ])  # fmt: skip

    @property
    def n_local(self) -> int:
        """Length of the vector's part of single recordings."""
        return len(LOCAL) * len(self.subjects)

    @property
    def n_common(self) -> int:
        """Length of the vector without the law's parameters."""
        return self.n_local + len(self.groups)

    def local(self, x: Array) -> Array:
        """Return the numbers of recordings, shape (n_recordings, 7), of a vector, shape (n,)."""
        return x[: self.n_local].reshape(-1, len(LOCAL))

    def means(self, x: Array) -> Array:
        """Return the means of the groups, shape (n_groups,), of a vector, shape (n,)."""
        return x[self.n_local : self.n_common]

    def vector(self, local: Array, law: Array) -> Array:
        """Return a vector in which each group has the median of its recordings.

        Parameters
        ----------
        local : ndarray, shape (n_recordings, 7)
            Logarithms of `LOCAL` [-].
        law : ndarray, shape (n_law,)
            Logarithms of the law's parameters [-].

        Returns
        -------
        ndarray, shape (n,)
            [-]
        """
        flat, group = local.ravel(), self.group_of.ravel()
        means = [np.median(flat[group == g]) for g in range(len(self.groups))]
        return np.concatenate([flat, means, law])

    def law_like(self, other: LawModel, x: Array) -> Array:
        """Return the law's parameters with those that another law's vector has, too.

        Parameters
        ----------
        other : LawModel
        x : ndarray, shape (n,)
            Its vector [-].

        Returns
        -------
        ndarray, shape (n_law,)
            Logarithms [-].
        """
        theirs = dict(zip(other.candidate.free, x[other.n_common :].tolist(), strict=True))
        return np.array([
            min(max(theirs.get(name, math.log(some[0])), math.log(low)), math.log(high))
            for name, (low, high, some) in self.candidate.free.items()
        ])  # fmt: skip

    def limits(self, start: Array) -> tuple[Array, Array]:
        """Return the bounds of a search from a vector, shape (n,)."""
        low = np.log([low for low, _, _ in self.candidate.free.values()])
        high = np.log([high for _, high, _ in self.candidate.free.values()])
        common = start[: self.n_common]
        away = np.log([2.2, 1.6, 40.0, 5.0, 2.5, 2.5, 8.0])
        width = np.concatenate([
            np.tile(away, len(self.subjects)), away[[i for i, _ in self.groups]]
        ])  # fmt: skip
        return np.concatenate([common - width, low]), np.concatenate([common + width, high])

    def specs(self, x: Array) -> tuple[LawSpec, tuple[LawSpec, ...]]:
        """Return law and effects of a vector, shape (n,)."""
        own = np.exp(x[self.n_common :]).tolist()
        values = {**self.candidate.fixed, **dict(zip(self.candidate.free, own, strict=True))}
        if self.candidate.effect is None:
            return LawSpec(self.candidate.law, values), ()
        return LawSpec(self.candidate.law), (LawSpec(self.candidate.effect, values),)

    def predicted(self, x: Array) -> list[Array | None]:
        """Return the predicted excerpts of each recording for a vector, shape (n,).

        Returns
        -------
        list of ndarray, shape (n_excerpts, length)
            Torque of the cell [Nm]; None if it cannot be solved.
        """
        friction = friction_of(*self.specs(x))
        torques: list[Array | None] = []
        for one, own in zip(self.subjects, np.exp(self.local(x)).tolist(), strict=True):
            _, kinetic, drop, *_ = own
            critical = kinetic + max(drop, _LEAST_DROP * kinetic)
            bushing, torque = self.bushing(own, one), None
            with suppress(ParameterError):
                torque = predicted_torque(one.excerpts, bushing, friction, critical, kinetic)
            torques.append(torque)
        return torques

    def bushing(self, own: Sequence[float], one: Subject) -> LumpedBushing:
        """Return the bushing of a recording from its numbers `LOCAL` [SI units]."""
        stiffness, _, _, damping, inertia, clamp, share = own
        share = min(share, _LARGEST_SHARE)
        return LumpedBushing(
            inertia, clamp, stiffness, one.support, share * damping, (1.0 - share) * damping
        )

    def extended(self, part: LawModel, x: Array, places: Sequence[int]) -> Array:
        """Return the vector of all recordings from that of a model of some.

        The others start at the means, or at their own numbers without one.

        Parameters
        ----------
        part : LawModel
        x : ndarray, shape (n,)
            Its vector [-].
        places : sequence of int

        Returns
        -------
        ndarray, shape (n,)
            Of this model [-].
        """
        known = dict(zip(part.groups, part.means(x).tolist(), strict=True))
        begun = self.vector(np.stack([one.start for one in self.subjects]), x[part.n_common :])
        means = np.array([
            known.get(group, own) for group, own in zip(self.groups, self.means(begun), strict=True)
        ])  # fmt: skip
        local = means[self.group_of]
        local[list(places)] = part.local(x)
        return np.concatenate([local.ravel(), means, x[part.n_common :]])

    def rig(self, x: Array, base: Rig, material: str) -> Rig:
        """Return the rig of a vector, shape (n,); damping without a recording is the support's."""
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
            clamp_inertia=values[5, None],
            elastomer_damping_share=min(values[6, None], _LARGEST_SHARE),
            fits=tuple(fits), effects=effects, assumed=(),
            friction=LawSpec(law.name, resolve(law.name, declared.parameters, law.parameters)),
        )  # fmt: skip


def _keys(one: Subject) -> tuple[object, ...]:
    """Return the key by which each number of `LOCAL` of a recording shares a mean."""
    fit = one.interference
    return fit, fit, fit, (fit, one.support), None, None, None


def share_error(model: LawModel) -> float:
    """Return the prior relative standard error of the elastomer's share of the damping [-].

    Ringing in stick determines all of the damping, ringing in slip the elastomer's; with the clamp
    bolted down only the latter is there.

    Parameters
    ----------
    model : LawModel
    """
    if all(math.isinf(one.support) for one in model.subjects):
        return SHARE_ASSUMED
    return model.known.share_error


def priors(model: LawModel, loose: float = 1.0) -> tuple[Array, Array]:
    """Return the prior of a vector x: each row of matrix @ x - target has unit variance.

    Parameters
    ----------
    model : LawModel
    loose : float
        Factor on the scatter of recordings [-].

    Returns
    -------
    matrix : ndarray, shape (n_known, n)
        [-]
    target : ndarray, shape (n_known,)
        [-]
    """
    n = model.n_common + len(model.candidate.free)
    rows, target = [], []

    def row(places: dict[int, float], value: float) -> None:
        line = np.zeros(n)
        for place, factor in places.items():
            line[place] = factor
        rows.append(line)
        target.append(value)

    for r, groups in enumerate(model.group_of.tolist()):
        for i, group in enumerate(groups):
            weight = 1.0 / (loose * _SCATTER[i])
            row({len(LOCAL) * r + i: weight, model.n_local + group: -weight}, 0.0)
    own = np.stack([one.start for one in model.subjects])
    inertia = model.known.inertia_error
    width = np.array([*_MEAN_WIDTH, inertia, inertia, share_error(model)])
    for g, (i, _) in enumerate(model.groups):
        usual = float(np.median(own[model.group_of[:, i] == g, i]))
        if i == LOCAL.index("damping"):
            usual = math.log(_USUAL_DAMPING)
        row({model.n_local + g: 1.0 / width[i]}, usual / width[i])
    for j, (low, high, _) in enumerate(model.candidate.free.values()):
        weight = 2.0 / math.log(high / low)
        row({model.n_common + j: weight}, weight * 0.5 * math.log(low * high))
    return np.array(rows), np.array(target)
