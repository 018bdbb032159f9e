"""Diagnoses whose score is known: none always, a random answer, and one that knows the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .truth import Truth

__all__ = ["BASELINES", "always_none", "oracle", "random_answer"]

STAGES = ("drive", "friction", "structure", "radiation", "measurement")


def _diagnosis(verdict, stage, probability, closed=None) -> dict:
    entries = [
        {"name": name, "probability": p, "closed": closed, "closed_low": closed,
         "closed_high": closed}
        for name, p in probability.items()
        if name in verdict
    ]  # fmt: skip
    return {
        "verdict": list(verdict),
        "location": {"stage": stage},
        "effects": entries,
        "probabilities": probability,
        "seconds": 0.0,
    }


def always_none(truth: Truth, causes: Sequence[str], rng: np.random.Generator) -> dict:
    """Say that nothing is the matter."""
    return _diagnosis((), None, {"none": 1.0})


def random_answer(truth: Truth, causes: Sequence[str], rng: np.random.Generator) -> dict:
    """Say one name of all at random, with probabilities that are uniform on the simplex."""
    names = ["none", "parameters", "unknown", *causes]
    p = rng.dirichlet(np.ones(len(names)))
    name = names[int(np.argmax(p))]
    probability = dict(zip(names, map(float, p), strict=True))
    verdict = () if name == "none" else (name,)
    return _diagnosis(verdict, str(rng.choice(STAGES)), probability, float(rng.random()))


def oracle(truth: Truth, causes: Sequence[str], rng: np.random.Generator) -> dict:
    """Say the truth, and be sure of it."""
    stage = truth.stages[0] if truth.stages else None
    return _diagnosis(truth.verdict, stage, dict.fromkeys(truth.names, 1.0), truth.closed)


BASELINES = {"none": always_none, "random": random_answer, "oracle": oracle}
