"""What fits tell of causes, counted on cases whose cause is known.

Each case is diagnosed as a user's would be, as far as the fits; what these leave of the recordings
is kept, so that the weights of `noise.diagnosis.fit.closing` can be learned again in minutes
when the first answer has changed. The weights are those by which the true hypotheses become
likeliest, held to the ones before by a ridge, since cases are few.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.optimize import minimize

from models.errors import ParameterError
from models.rig_file import load_rig
from noise.base.files import atomic, check_target
from noise.diagnosis.bench.check import bench_findings
from noise.diagnosis.case import read_case
from noise.diagnosis.causes.location import stage_findings
from noise.diagnosis.causes.posterior import load_posterior
from noise.diagnosis.causes.stage_nulls import load_stage_nulls
from noise.diagnosis.causes.verdict import Hypothesis, normalised
from noise.diagnosis.findings import StageFinding
from noise.diagnosis.first_answer import first_answer
from noise.diagnosis.fit.closing import ClosingOdds, load_closing_odds
from noise.diagnosis.fit.hypothesis_fits import CaseFits, HypothesisFit, judge, settled, updated
from sim.effects import EFFECTS

_LOOKED = 50
"""The likeliest hypotheses of a case that are looked at, beside those that were fitted."""

_SCALE = (2.0, 4.0, 2.0, 3.0, 3.0, 1.0, 3.0, 2.0, 2.0)
"""How far each weight may be off the one before, as one standard deviation [-]."""

_ENOUGH = (0.005, 0.02, 0.05, 0.1, 0.2, 0.3)
"""Shares tried that a fit has to close for its effects to be named."""

_WRONG = 0.01
"""Part of the cases that a wrong truth, or one that no hypothesis has, is allowed for."""


@dataclass(frozen=True, eq=False)
class FittedCase:
    """A case whose cause is known, as far as the fits.

    Parameters
    ----------
    truth : frozenset of str
        The hypothesis that is right.
    hypotheses : mapping of frozenset of str to float
        Probabilities before any fit [-].
    stages : mapping of str to StageFinding
    fits : CaseFits
    """

    truth: Hypothesis
    hypotheses: Mapping[Hypothesis, float]
    stages: Mapping[str, StageFinding]
    fits: CaseFits


def fitted_cases(folders: Sequence[Path], store: Path) -> Iterator[FittedCase]:
    """Diagnose cases whose cause is known, as far as the fits.

    Parameters
    ----------
    folders : sequence of Path
        Each with ``data/CASE``, in which are recordings and ``rig.toml``, and with
        ``answers/CASE.json``, of which ``verdict`` is read.
    store : Path
        Folder of what fits leave, one file a case; what is there is not fitted again.

    Yields
    ------
    FittedCase
        Of each case that raises the alarm, as the first answer has it.

    Raises
    ------
    ParameterError
        A folder holds no cases, or the store cannot be written to.
    """
    check_target(store / "case.json", "--store")
    posterior, nulls = load_posterior(), load_stage_nulls()
    for folder in folders:
        answers = sorted((folder / "answers").glob("*.json"))
        if not answers:
            raise ParameterError(f"{folder}: has no answers/CASE.json; see --help")
        for answer in answers:
            truth = frozenset(json.loads(answer.read_text(encoding="utf-8"))["verdict"])
            data, kept = folder / "data" / answer.stem, store / answer.name
            case = read_case([data], load_rig(data / "rig.toml"))
            if bench_findings(case, EFFECTS):
                continue
            first = first_answer(case, EFFECTS, posterior)
            if not first.verdict:
                continue
            stages = stage_findings(first.table, nulls, first.flat)
            if not kept.exists():
                fits = judge(case, first, stages, EFFECTS, 0, lambda _text: None).fits
                assert fits is not None  # there is something to explain
                _keep(kept, fits)
            yield FittedCase(truth, first.hypotheses, stages, _kept(kept))


def _keep(path: Path, fits: CaseFits) -> None:
    said = {
        "held": fits.held,
        "before": fits.before.tolist(),
        "recalibrated": fits.recalibrated.tolist(),
        "fits": {"+".join(fit.names): fit.squared.tolist() for fit in fits.of.values()},
    }
    with atomic(path) as target:
        target.write_text(json.dumps(said), encoding="utf-8")


def _kept(path: Path) -> CaseFits:
    said: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    nothing: Any = SimpleNamespace(library=EFFECTS)  # the fits themselves are not asked again
    fits = {
        frozenset(names.split("+")): HypothesisFit(tuple(names.split("+")), nothing, np.array(x))
        for names, x in said["fits"].items()
    }
    before, recalibrated = np.array(said["before"]), np.array(said["recalibrated"])
    return CaseFits(nothing, (), tuple(said["held"]), nothing, before, recalibrated, fits)


def learn_closing_odds(cases: Sequence[FittedCase], *, ridge: float = 10.0) -> ClosingOdds:
    """Learn weights by which the true hypotheses become likeliest.

    Parameters
    ----------
    cases : sequence of FittedCase
    ridge : float
        How strongly the weights are held to those before [-].
    """
    before = load_closing_odds()
    looked, middle = [_shortened(case) for case in cases], _numbers(before)
    enough = min(_ENOUGH, key=lambda share: mean_loss(replace(before, enough=share), looked))

    def loss(x: np.ndarray[Any, np.dtype[np.float64]]) -> float:
        odds = _odds(middle + x * _SCALE, enough)
        return len(looked) * mean_loss(odds, looked) + ridge * float(x @ x)

    found = minimize(
        loss, np.zeros(middle.size), method="Powell", options={"maxiter": 3, "ftol": 1e-3}
    )
    return _odds(middle + found.x * _SCALE, enough)


def mean_loss(odds: ClosingOdds, cases: Sequence[FittedCase]) -> float:
    """Mean of the negative logarithm of what a true hypothesis is given [-].

    Parameters
    ----------
    odds : ClosingOdds
    cases : sequence of FittedCase
    """
    total = 0.0
    for case in cases:
        fits = replace(case.fits, odds=odds)
        now = settled(updated(case.hypotheses, fits, case.stages), fits)
        total -= math.log((1.0 - _WRONG) * now.get(case.truth, 0.0) + _WRONG / _LOOKED)
    return total / len(cases)


def write_odds(path: Path, odds: ClosingOdds, cases: Sequence[FittedCase]) -> None:
    """Write weights as the diagnosis reads them, with what they were learned from.

    Parameters
    ----------
    path : Path
    odds : ClosingOdds
    cases : sequence of FittedCase
    """
    fits = [(h <= case.truth) for case in cases for h in case.fits.of]
    card = {
        "cases": f"{len(cases)} cases of known cause with an alarm; {len(fits)} fits, {sum(fits)} "
        "of a cause that was at work",
        "how": "largest likelihood of the true hypotheses after the fits, with a ridge towards "
        "the weights before; python -m noise.training.causes closing",
        "mean loss": {
            "as learned": round(mean_loss(odds, cases), 3),
            "before": round(mean_loss(load_closing_odds(), cases), 3),
            "without fits": round(mean_loss(_odds(np.zeros(len(_SCALE)), -1.0), cases), 3),
        },
    }
    with atomic(path) as target:
        target.write_text(json.dumps(asdict(odds) | {"fitted_on": card}, indent=2) + "\n", "utf-8")


def _shortened(case: FittedCase) -> FittedCase:
    kept = dict(list(case.hypotheses.items())[:_LOOKED])
    asked = (case.truth, *map(frozenset, ((), ("parameters",), ("unknown",))))
    kept |= {h: case.hypotheses[h] for h in (*asked, *case.fits.of) if h in case.hypotheses}
    return replace(case, hypotheses=normalised(kept))


def _numbers(odds: ClosingOdds) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([*odds.none.values(), *odds.parameters.values(), *odds.effects.values()])


def _odds(x: np.ndarray[Any, np.dtype[np.float64]], enough: float) -> ClosingOdds:
    one, room, alone, left, closed, *effects = np.round(x, 2).tolist()
    return ClosingOdds(
        {"one": one, "room": room},
        {"one": alone, "left": left, "closed": closed},
        dict(zip(("room", "closed", "stage", "more"), effects, strict=True)),
        enough,
    )
