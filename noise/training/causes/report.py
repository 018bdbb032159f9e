"""What a cause posterior makes of drawn cases that it has not seen, by kind of bench."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.causes.verdict import joint_probabilities, likeliest, needs_explaining

if TYPE_CHECKING:
    from noise.diagnosis.causes.posterior import Posterior
    from noise.training.causes.fit import Known


KEPT_FOR_REPORT = 10
"""One rig of so many is kept from training altogether where a report is asked for."""

PLAIN = 0.15
"""Strength of an effect from which on it counts as plain [-]; what can be seen is not measured."""

_Answer = tuple["Known", tuple[str, ...]]


def is_kept(case: Known) -> bool:
    """Whether a case is of a rig that is kept for the report."""
    return case.rig % KEPT_FOR_REPORT == KEPT_FOR_REPORT - 1


def report(posterior: Posterior, cases: Sequence[Known]) -> str:
    """Score the first look, without gap and fits.

    Parameters
    ----------
    posterior : Posterior
    cases : sequence of Known
        That it has not seen.

    Returns
    -------
    str
        A table, one row for each kind of bench.
    """
    answers = [(case, _verdict(posterior, case)) for case in cases]
    kinds = sorted({name for case in cases for name in case.departures})
    rows = [("all", answers), ("quiet", [a for a in answers if not a[0].departures])]
    rows += [(kind, [a for a in answers if kind in a[0].departures]) for kind in kinds]
    lines = [f"{'bench':12}" + "".join(f"{name:>22}" for name in _SCORES)]
    lines += [f"{name:12}" + "".join(_score(some, *of) for of in _SCORES.values())
              for name, some in rows]  # fmt: skip
    return "\n".join(lines)


def _verdict(posterior: Posterior, case: Known) -> tuple[str, ...]:
    p = posterior.probabilities(case.table)
    if not needs_explaining(p["none"], posterior.alarm):
        return ()
    return likeliest({h: x for h, x in joint_probabilities(p).items() if h})


def _score(
    answers: Sequence[_Answer], counts: Callable[[Known], bool], right: Callable[[_Answer], bool]
) -> str:
    some = [answer for answer in answers if counts(answer[0])]
    share = np.mean([right(answer) for answer in some]) if some else np.nan
    return f"{share:14.3f} ({len(some):4d}) "


def _plain(case: Known) -> bool:
    return all(a >= PLAIN for a in case.truth.strengths)


def _is_first(answer: _Answer) -> bool:
    case, verdict = answer
    return verdict[:1] == (case.truth.effects or (case.truth.kind,))[:1]


def _of(kind: str) -> Callable[[Known], bool]:
    return lambda case: case.truth.kind == kind and _plain(case)


_SCORES: dict[str, tuple[Callable[[Known], bool], Callable[[_Answer], bool]]] = {
    "false alarms": (_of("none"), lambda answer: bool(answer[1])),
    "plain detected": (
        lambda case: case.truth.kind != "none" and _plain(case), lambda answer: bool(answer[1]),
    ),
    "right first": (_of("one"), _is_first),
    "parameters": (_of("parameters"), lambda answer: answer[1] == ("parameters",)),
    "exact pair": (_of("pair"), lambda answer: set(answer[1]) == set(answer[0].truth.effects)),
    "unknown": (_of("unknown"), lambda answer: answer[1] == ("unknown",)),
}  # fmt: skip
"""By name: which cases count, and what is right."""
