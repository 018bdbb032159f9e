"""What fits tell of causes is learned from cases whose cause is known."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from models.errors import ParameterError
from noise.diagnosis.causes.verdict import normalised
from noise.diagnosis.findings import StageFinding
from noise.diagnosis.fit.closing import load_closing_odds
from noise.diagnosis.fit.hypothesis_fits import CaseFits, HypothesisFit
from noise.training.causes import closing
from noise.training.causes.closing import (
    FittedCase,
    fitted_cases,
    learn_closing_odds,
    mean_loss,
    write_odds,
)
from sim.effects import EFFECTS

STAGES = {"friction": StageFinding(5.0, 0.9, 0.001)}
SLIP, UNKNOWN = frozenset({"partial_slip"}), frozenset({"unknown"})
FIRST = normalised({SLIP: 0.4, UNKNOWN: 0.4, frozenset({"parameters"}): 0.1, frozenset(): 0.1})


def fits_of(after):
    """Fits of a case whose gap of six floors the parameters leave as it is."""
    left = HypothesisFit(("partial_slip",), None, np.full(4, after**2))
    whole = np.full(4, 36.0)
    return CaseFits(
        SimpleNamespace(library=EFFECTS), (0, 1), (2, 3), None, whole, whole - 0.1, {SLIP: left}
    )


def cases(rng, names_close):
    """Cases where fits of right names close much and those of wrong ones little, or the reverse."""
    return [
        FittedCase(
            SLIP if right else UNKNOWN, FIRST, STAGES,
            fits_of(rng.uniform(1.0, 2.0) if right == names_close else rng.uniform(4.0, 5.5)),
        )
        for right in (True, False)
        for _ in range(6)
    ]  # fmt: skip


def test_what_fits_tell_is_learned_and_found_again_on_others():
    rng = np.random.default_rng(0)
    told, misled = (learn_closing_odds(cases(rng, close)) for close in (True, False))
    assert told.effects["closed"] > misled.effects["closed"]
    others = cases(rng, True)
    assert mean_loss(told, others) <= mean_loss(load_closing_odds(), others) + 0.01
    assert mean_loss(told, others) < mean_loss(misled, others)


def test_what_is_learned_is_read_as_it_is_shipped(tmp_path, monkeypatch):
    odds = replace(load_closing_odds(), enough=0.07)
    write_odds(tmp_path / "data" / "closing.json", odds, cases(np.random.default_rng(0), True))
    monkeypatch.setattr("noise.diagnosis.fit.closing.resources.files", lambda _package: tmp_path)
    assert load_closing_odds.__wrapped__() == odds


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Folder of two cases, of which the second raises no alarm; and the fits that were made."""
    made: list[str] = []

    def judged(case, *_rest):
        made.append(case)
        return SimpleNamespace(fits=fits_of(1.5))

    for name, found in {
        "read_case": lambda paths, _rig: paths[0].name,
        "load_rig": lambda _path: None,
        "bench_findings": lambda *_: (),
        "first_answer": lambda case, *_: SimpleNamespace(
            verdict=("partial_slip",) if case == "a" else (),
            table=None,
            hypotheses=FIRST,
            flat=("torque",),
        ),
        "stage_findings": lambda *given: STAGES if ("torque",) in given else {},
        "judge": judged,
    }.items():
        monkeypatch.setattr(closing, name, found)
    (tmp_path / "answers").mkdir()
    for name in "ab":
        (tmp_path / "answers" / f"{name}.json").write_text(json.dumps({"verdict": ["clipping"]}))
    return tmp_path, made


def test_what_was_fitted_is_not_fitted_again(folder):
    path, made = folder
    (first,) = fitted_cases([path], path / "store")
    (second,) = fitted_cases([path], path / "store")
    assert made == ["a"]
    assert second.truth == {"clipping"}
    assert first.stages == STAGES  # as a user's are, by the channels whose peaks are flat
    assert second.fits.held_out(second.fits.before).tolist() == [36.0, 36.0]
    assert second.fits.of[SLIP].squared.tolist() == first.fits.of[SLIP].squared.tolist()


def test_a_folder_without_answers_is_said(tmp_path):
    with pytest.raises(ParameterError, match=r"answers/CASE\.json"):
        list(fitted_cases([tmp_path], tmp_path / "store"))
