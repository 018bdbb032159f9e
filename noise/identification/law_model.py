"""Laws of friction as a fit searches them, and what they predict of excerpts of recordings.

A fit searches numbers of each recording, their means over a rig, and the law's own.

All are logarithms. A rig is never quite the same twice: each recording has a bushing and torques of
its own, which scatter about those of the rig, and these are what is to be found.

Excerpts begin where the recording has them, and what recordings scatter by is known beforehand.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Fit, LawSpec, Rig
from noise.base import packaged_toml
from noise.base.arrays import Array
from noise.identification.bushing_fit import Known
from noise.identification.static_test import Evidence
from noise.identification.subjects import Excerpts, Subject
from sim.bushing import LumpedBushing
from sim.contact import CRITICAL, KINETIC, N_CONTACT, address_of, call_law_at
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.friction.law import FrictionLaw
from sim.motion import contact_hooks
from sim.parameters import resolve
from sim.solvers.contact_solver import ContactRun, Hook

_SCATTER = np.array([0.025, 0.025, 0.03, 0.03, 0.02, 0.008, 0.01])
"""By which they scatter about the rig's [-]; a support's counts as its clamp's inertia;
assumed."""

_MEAN_WIDTH = np.array([0.6, 0.3, 1.0, 0.6])
"""Relative standard deviation of the rig's about what is usual, or where a search begins [-];
assumed."""

_USUAL_DAMPING = 0.09
"""[Nm s/rad] (Table 5.5)"""

SHARE_ASSUMED = 0.02
"""Relative standard error of a share that the recordings cannot tell; assumed."""


def share_error(model: LawModel) -> float:
    """Relative standard error of the elastomer's share of the damping beforehand [-].

    What rings while the contact sticks tells all of it, while it slides the elastomer's; a
    clamp that is bolted down only this.

    Parameters
    ----------
    model : LawModel
    """
    if all(math.isinf(one.support) for one in model.subjects):
        return SHARE_ASSUMED
    return model.known.share_error


def fitted_evidence(model: LawModel) -> dict[Evidence, int]:
    """Return the group that each piece of evidence speaks of, where the fit has one.

    Parameters
    ----------
    model : LawModel

    Returns
    -------
    dict of Evidence to int
        Torques are left out: those that a table states are levels, a law's are not.
    """
    places = {group: g for g, group in enumerate(model.groups)}
    found = {}
    for one in model.evidence:
        if one.name not in LOCAL or one.name == "kinetic_torque":
            continue
        fit, support = one.interference, one.support_stiffness
        i = LOCAL.index(one.name)
        key: object = {"elastomer_stiffness": fit, "damping": (fit, support)}.get(one.name)
        if (i, key) in places:
            found[one] = places[i, key]
    return found


def priors(model: LawModel, loose: float = 1.0) -> tuple[Array, Array]:
    """Return what is known of a vector x: matrix @ x - target is away by one each.

    Parameters
    ----------
    model : LawModel
    loose : float
        Factor on what recordings may differ by [-].

    Returns
    -------
    matrix : ndarray, shape (n_known, n)
        [-]
    target : ndarray, shape (n_known,)
        [-]
    """
    n = model.n_common + model.candidate.n_parameters
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
    for one, g in fitted_evidence(model).items():
        i = model.groups[g][0]
        error = math.hypot(one.error, _SCATTER[i])
        row({model.n_local + g: 1.0 / error}, math.log(one.value) / error)
    for j, (low, high, _) in enumerate(model.candidate.free.values()):
        weight = 2.0 / math.log(high / low)
        row({model.n_common + j: weight}, weight * 0.5 * math.log(low * high))
    return np.array(rows), np.array(target)


@dataclass(frozen=True)
class Candidate:
    """A law to be tried.

    Parameters
    ----------
    name, words : str
        In tables, and on pages.
    law : str
        Of `sim.friction`.
    effect : str, optional
        Of `sim.effects`; then it is what the searched parameters belong to.
    free : mapping of str to (float, float, sequence of float)
        Parameters that are searched: lowest, highest and some starts [the law's units].
    fixed : mapping of str to float
        Others that differ from the law's own [the law's units].
    drops : sequence of float
        What the critical torque exceeds the kinetic one by where a search begins, over what the
        levels differ by [-].
    """

    name: str
    words: str
    law: str
    effect: str | None = None
    free: Mapping[str, tuple[float, float, Sequence[float]]] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    drops: Sequence[float] = (1.0,)

    @property
    def sticks(self) -> bool:
        """Whether its contact truly sticks."""
        return self.law == "coulomb"

    @property
    def n_parameters(self) -> int:
        """Numbers that it has beyond the two torques of each fit."""
        return len(self.free)


CANDIDATES = tuple(
    Candidate(name, **row)
    for name, row in packaged_toml("noise.identification", "candidates.toml").items()
)
"""By rising number of parameters."""


_TOLERANCE = 1e-6
"""Of the solver, over one cycle."""

_SUBSTEPS = 12
"""Between two samples, of a contact that is driven: it settles within microseconds."""


@dataclass(frozen=True, eq=False)
class Friction:
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
    found = friction_law(law.name)
    values = resolve(f"friction law {law.name!r}", found.parameters, law.parameters)
    hooks = contact_hooks(activated(effects, EFFECTS), np.random.default_rng(0))
    return Friction(found, found.coefficients(values), hooks)


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


def foretold(
    excerpts: Excerpts, bushing: LumpedBushing, friction: Friction, critical: float, kinetic: float
) -> Array:
    """Foretell the torque of the cell in each excerpt.

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


LOCAL = (
    "elastomer_stiffness", "kinetic_torque", "drop", "damping", "elastomer_inertia",
    "clamp_inertia", "elastomer_damping_share",
)  # fmt: skip
"""Numbers that each recording has of its own; the drop is from critical to kinetic torque."""

_LEAST_DROP = 0.004
"""Over the kinetic torque; equal torques make a weakening contact chatter; assumed."""

_LARGEST_SHARE = 0.97


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
    evidence : tuple of Evidence
        Of the rig's numbers from elsewhere than stick-slip.
    """

    candidate: Candidate
    subjects: tuple[Subject, ...]
    known: Known
    evidence: tuple[Evidence, ...] = ()

    @cached_property
    def groups(self) -> tuple[tuple[int, object], ...]:
        """Place in `LOCAL` and key of each group of recordings that share a mean."""
        return tuple(dict.fromkeys(
            (i, key) for one in self.subjects for i, key in enumerate(_keys(one))
        ))  # fmt: skip

    @cached_property
    def group_of(self) -> NDArray[np.int64]:
        """Group of each number of each recording, shape (n_recordings, 7)."""
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

    def local(self, x: Array) -> Array:
        """Numbers of the recordings' own, shape (n_recordings, 7), of a vector of shape (n,)."""
        return x[: self.n_local].reshape(-1, len(LOCAL))

    def means(self, x: Array) -> Array:
        """Means of the groups, shape (n_groups,), of a vector of shape (n,)."""
        return x[self.n_local : self.n_common]

    def vector(self, local: Array, law: Array) -> Array:
        """Put a vector together, each group with the median of its recordings.

        Parameters
        ----------
        local : ndarray, shape (n_recordings, 7)
            Logarithms of `LOCAL` [-].
        law : ndarray, shape (n_law,)
            Of the law's own parameters [-].

        Returns
        -------
        ndarray, shape (n,)
            [-]
        """
        flat, group = local.ravel(), self.group_of.ravel()
        means = [np.median(flat[group == g]) for g in range(len(self.groups))]
        return np.concatenate([flat, means, law])

    def law_like(self, other: LawModel, x: Array) -> Array:
        """Take the law's own parameters from another law's vector, as far as both have them.

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
        """Return the lowest and highest vectors, shape (n,)."""
        low = np.log([low for low, _, _ in self.candidate.free.values()])
        high = np.log([high for _, high, _ in self.candidate.free.values()])
        common = start[: self.n_common]
        away = np.log([2.2, 1.6, 40.0, 5.0, 2.5, 2.5, 8.0])
        width = np.concatenate([
            np.tile(away, len(self.subjects)), away[[i for i, _ in self.groups]]
        ])  # fmt: skip
        return np.concatenate([common - width, low]), np.concatenate([common + width, high])

    def specs(self, x: Array) -> tuple[LawSpec, tuple[LawSpec, ...]]:
        """Return law and effects at a vector, shape (n,)."""
        own = np.exp(x[self.n_common :]).tolist()
        values = {**self.candidate.fixed, **dict(zip(self.candidate.free, own, strict=True))}
        if self.candidate.effect is None:
            return LawSpec(self.candidate.law, values), ()
        return LawSpec(self.candidate.law), (LawSpec(self.candidate.effect, values),)

    def foretell(self, x: Array) -> list[Array | None]:
        """Foretell the excerpts of each recording at a vector, shape (n,).

        Returns
        -------
        list of ndarray, shape (n_excerpts, length)
            Torque of the cell [Nm]; None where it cannot be solved.
        """
        friction = friction_of(*self.specs(x))
        found: list[Array | None] = []
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
        stiffness, _, _, damping, inertia, clamp, share = own
        share = min(share, _LARGEST_SHARE)
        return LumpedBushing(
            inertia, clamp, stiffness, one.support, share * damping, (1.0 - share) * damping
        )

    def extended(self, part: LawModel, x: Array, places: Sequence[int]) -> Array:
        """Take over the vector of a model of some recordings, at these places among all.

        The others begin at the means, or where they are by themselves if there is none.

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
            clamp_inertia=values[5, None],
            elastomer_damping_share=min(values[6, None], _LARGEST_SHARE),
            fits=tuple(fits), effects=effects, assumed=(),
            friction=LawSpec(law.name, resolve(law.name, declared.parameters, law.parameters)),
        )  # fmt: skip


def _keys(one: Subject) -> tuple[object, ...]:
    """Say what each number of `LOCAL` of a recording shares its mean with."""
    fit = one.interference
    return fit, fit, fit, (fit, one.support), None, None, None
