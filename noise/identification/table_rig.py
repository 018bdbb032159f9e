"""A rig from a table of measured numbers alone: a known rig, changed until it gives them.

At each interference of the table stiffness, damping and torques are searched, and the parameters
of the law of friction for all; what the numbers do not tell stays as it was.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED
from models.rig import LawSpec, Rig
from models.rig_file import rig_text
from noise.base import SURE_90
from noise.identification.evidence import UNITS, table_evidence, with_evidence
from noise.identification.outcome import Identification, Number
from noise.identification.static_test import static_evidence, static_notes
from noise.identification.table_fit import TableFit, TableNumber, fit_table, score_table
from noise.screening.environments import FIT_PARAMETERS, scaled_fit

if TYPE_CHECKING:
    from noise.identification.measured import Beforehand, Measurements


_WIDTH = 0.4
"""Relative standard deviation of what is searched about the known rig [-]; assumed."""

_SLOPE_STEP = 0.05
"""Of the logarithms, for the curvature at the end."""

_ROUNDS = 5


def identify_from_table(
    table: Sequence[TableNumber], beforehand: Beforehand, measurements: Measurements,
    progress: Callable[[str], None] | None = None,
) -> Identification:  # fmt: skip
    """Identify a rig from measured numbers and static tests.

    Parameters
    ----------
    table : sequence of TableNumber
    beforehand : Beforehand
        Of its rig the search departs, and its law of friction stays.
    measurements : Measurements
        Of which the static tests count.
    progress : callable, optional
        Told how well the numbers are met.

    Returns
    -------
    Identification
        With the law that was known, and no recordings.
    """
    started = time.perf_counter()
    tell = progress or (lambda _text: None)
    known = beforehand.rig
    tested = static_evidence(measurements.static, beforehand.known)
    given = table
    table = [*table, *(_row(one) for one in with_evidence((), tested) if one.interference)]
    places = sorted({number.interference for number in table})
    # what a row states of the rig itself need not be searched
    stated = with_evidence((), table_evidence(table))
    base = replace(known, fits=tuple(known.fit(place) for place in places))
    own = [k for k, v in base.friction.parameters.items() if not isinstance(v, str) and v > 0.0]
    names = [(name, place) for place in places for name in FIT_PARAMETERS]
    begin = np.zeros(len(names) + len(own))
    for i, (name, place) in enumerate(names):
        said = [n for n in stated if n.name == name and n.interference == place]
        if said:
            begin[i] = math.log(said[0].value / _value(base, name, place, said[0]))

    def rig_at(vector: NDArray[np.float64]) -> Rig:
        factors = np.exp(vector).tolist()
        by_place = {
            place: {n: f for (n, at), f in zip(names, factors, strict=False) if at == place}
            for place in places
        }
        law = dict(base.friction.parameters)
        for name, factor in zip(own, factors[len(names) :], strict=True):
            law[name] = float(law[name]) * factor
        return replace(
            base, fits=tuple(scaled_fit(fit, by_place[fit.interference]) for fit in base.fits),
            friction=LawSpec(base.friction.name, law),
        )  # fmt: skip

    fit = fit_table(
        rig_at, table, begin, rounds=_ROUNDS, width=_WIDTH,
        progress=lambda score: tell(f"the numbers are met to {score.cost:.2f} standard errors"),
    )  # fmt: skip
    spread = _spread(rig_at, table, fit)
    numbers = []
    for i, (name, place) in enumerate(names):
        for support in base.fit(place).damping if name == "damping" else (None,):
            # damping said of one support is no measurement of another
            of = [n for n in stated if (n.name, n.interference) == (name, place)]
            other = (
                name == "damping" and bool(of) and support not in {n.support_stiffness for n in of}
            )
            away = math.exp(SURE_90 * (_WIDTH if other else spread[i]))
            at = fit.rig.fit(place)
            value = at.damping[support] if support is not None else float(getattr(at, name))
            numbers.append(
                Number(name, UNITS[name], value, value / away, value * away, 0, place, support)
            )
    for i, name in enumerate(own, start=len(names)):
        value, away = float(fit.rig.friction.parameters[name]), math.exp(SURE_90 * spread[i])
        numbers.append(Number(f"friction.{name}", "", value, value / away, value * away, 0))
    return Identification(
        assumed=("what the numbers do not tell, and the law of friction, are the known rig's",),
        rig_toml=rig_text(fit.rig, _HEAD, beforehand.structure), numbers=tuple(numbers), laws=(),
        law=base.friction.name, seen=(), refused=measurements.refused, static=measurements.static,
        not_found=tuple(
            f"torques from {one.name}: nothing slips there" for one in measurements.used
        ),
        notes=(_LAW_NOTE, *static_notes(measurements.static)),
        measured=tuple((number, fit.score.found[number]) for number in given),
        seconds=time.perf_counter() - started,
    )  # fmt: skip


def _row(said: Number) -> TableNumber:
    assert said.interference is not None  # of the bushing, not of the clamp
    support = FIXED if said.support_stiffness is None else said.support_stiffness
    error = 0.5 * math.log(said.high / said.low) / SURE_90
    return TableNumber(said.name, said.value, said.interference, support, (), 1.0 / error, "table")


_HEAD = (
    "Identified from measured numbers; intervals are in identification.json.",
    "What the numbers do not tell is that of the rig that was known.",
)
_LAW_NOTE = (
    "the law of friction is that of the known rig: numbers alone do not compare laws; record "
    "torque and angle at several speeds"
)


def _value(base: Rig, name: str, place: float, said: Number) -> float:
    fit = base.fit(place)
    if name != "damping":
        return float(getattr(fit, name))
    support = said.support_stiffness
    return fit.damping.get(
        math.inf if support is None else support, next(iter(fit.damping.values()))
    )


def _spread(
    rig_at: Callable[[NDArray[np.float64]], Rig], table: Sequence[TableNumber], fit: TableFit
) -> NDArray[np.float64]:
    """Return the vector's standard errors by the curvature, those of the known rig at most."""

    def weighted(vector: NDArray[np.float64]) -> NDArray[np.float64]:
        found = score_table(rig_at(vector), table).found or fit.score.found
        return np.array([n.weight * n.misfit(found[n]) for n in table])

    steps = _SLOPE_STEP * np.eye(fit.vector.size)
    slopes = [
        (weighted(fit.vector + s) - weighted(fit.vector - s)) / (2.0 * _SLOPE_STEP) for s in steps
    ]
    normal = np.array(slopes) @ np.array(slopes).T + np.eye(fit.vector.size) / _WIDTH**2
    # numbers that are met worse than their errors say are less sure
    worse = max(fit.score.cost, 1.0)
    return np.asarray(np.minimum(worse * np.sqrt(np.diag(np.linalg.inv(normal))), _WIDTH))
