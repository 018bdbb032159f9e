"""What a diagnosis said of a case, read from its ``diagnosis.json``.

``probabilities`` (name -> number from 0 to 1) holds, for ``none``, ``parameters``, ``unknown`` and
every effect, how probable it is that the name belongs to the true verdict. The first three exclude
each other and all effects; effects may occur together, so theirs are marginal: the sum of all is
the expected number of names, at least 1. Where the key is absent, the probabilities in ``effects``
stand in for it, whatever name they carry; what they leave of 1 goes to the verdict's names that
have none, or else in equal parts to the three that exclude the effects.

Names declared equivalent beforehand become one, with the sum of their probabilities.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .truth import SPECIAL, Truth

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["Answer", "merged", "read_answer", "same_names"]


@dataclass(frozen=True)
class Answer:
    """What was said; `failed` where nothing was."""

    verdict: tuple[str, ...]
    probability: Mapping[str, float]
    stage: str | None = None
    closed: float | None = None
    interval: tuple[float, float] | None = None
    seconds: float | None = None
    failed: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the verdict; ``none`` where it is empty."""
        return self.verdict or (() if self.failed else ("none",))

    @property
    def ranking(self) -> list[str]:
        """Names, the most probable first; among equals those of the verdict."""
        return sorted(self.probability, key=lambda n: (-self.probability[n], n not in self.names))

    def of(self, name: str) -> float:
        """Return the probability of a name; 0 where nothing was said of it."""
        return self.probability.get(name, 0.0)


def read_answer(diagnosis: Mapping | None, case: str = "diagnosis") -> Answer:
    """Read a diagnosis; None is one that failed.

    Raises
    ------
    ValueError
        A probability is no number from 0 to 1, or there is no verdict; the message names the case.
    """
    if diagnosis is None:
        return Answer((), {}, failed=True)
    if not isinstance(diagnosis.get("verdict"), list):
        raise ValueError(f"{case}: verdict = {diagnosis.get('verdict')!r} must be a list of names")
    verdict = tuple(name for name in diagnosis["verdict"] if name != "none")
    effects = diagnosis.get("effects") or []
    probability = diagnosis.get("probabilities")
    if probability is None:
        given = {e["name"]: e["probability"] for e in effects if e.get("probability") is not None}
        probability = given | _left(given, verdict or ("none",))
    for name, p in probability.items():
        if not (isinstance(p, int | float) and math.isfinite(p) and -1e-9 <= p <= 1.0 + 1e-9):
            raise ValueError(f"{case}: probability of {name} = {p!r} must lie between 0 and 1")
    said = sorted(
        effects, key=lambda e: (e["name"] not in verdict, -(e.get("probability") or 0.0))
    )  # fmt: skip
    first = said[0] if said else {}
    low, high = first.get("closed_low"), first.get("closed_high")
    return Answer(
        verdict,
        {name: min(max(float(p), 0.0), 1.0) for name, p in probability.items()},
        (diagnosis.get("location") or {}).get("stage"),
        first.get("closed"),
        None if low is None or high is None else (low, high),
        diagnosis.get("seconds"),
    )


def _left(given: Mapping[str, float], names: tuple[str, ...]) -> dict[str, float]:
    rest = max(0.0, 1.0 - sum(given.values()))
    silent = [name for name in names if name not in given]
    if not silent:
        silent = [name for name in SPECIAL if name not in given]
    return {name: rest / len(silent) for name in silent}


def same_names(equivalent: Iterable[Iterable[str]]) -> dict[str, str]:
    """Map names that are declared equivalent to one of each class."""
    classes: list[set[str]] = []
    for group in equivalent:
        joined = set(group)
        for other in [c for c in classes if c & joined]:
            joined |= other
            classes.remove(other)
        classes.append(joined)
    return {name: min(group) for group in classes for name in group}


def merged(truth: Truth, answer: Answer, same: Mapping[str, str]) -> tuple[Truth, Answer]:
    """Give equivalent names one name, in truth and answer."""
    if not same:
        return truth, answer
    probability: dict[str, float] = {}
    for said, p in answer.probability.items():
        name = same.get(said, said)
        probability[name] = min(1.0, probability.get(name, 0.0) + p)
    return (
        replace(truth, verdict=_once(same.get(name, name) for name in truth.verdict)),
        replace(
            answer,
            verdict=_once(same.get(name, name) for name in answer.verdict),
            probability=probability,
        ),
    )


def _once(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))
