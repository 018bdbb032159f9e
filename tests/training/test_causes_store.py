"""Training cases in files: what was drawn comes back, and the command trains on it."""

from __future__ import annotations

import ast
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import noise
from models.errors import ParameterError
from noise.diagnosis.causes.posterior import load_posterior
from noise.training.causes import __main__ as command, fit
from noise.training.causes.fit import draw_into, load_cases, train_posterior
from tests.helpers.made_posteriors import made_cases, made_posterior


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Two files of cases that were made instead of simulated."""

    def of_a_rig(seeds):
        made = made_cases(1, each=2)[: len(seeds)]
        return [replace(case, seed=seed) for seed, case in zip(seeds, made, strict=True)]

    monkeypatch.setattr(fit, "known_cases_of_a_rig", of_a_rig)
    assert len(list(draw_into(tmp_path, range(400_000, 400_000 + 2 * fit.CHUNK)))) == 2
    return tmp_path


def test_cases_come_back_from_their_files(folder):
    cases = load_cases(folder)
    assert [case.seed for case in cases] == list(range(400_000, 400_000 + 2 * fit.CHUNK))
    for before, after in zip(made_cases(1, each=2)[:4], cases[:4], strict=True):
        assert after.truth == before.truth
        assert after.table.conditions == before.table.conditions
        assert np.array_equal(after.table.measured, before.table.measured)


def test_a_folder_without_cases_and_a_damaged_file_are_refused(tmp_path):
    with pytest.raises(ParameterError, match="draw some first"):
        load_cases(tmp_path)
    (tmp_path / "cases-0-4.joblib").write_bytes(b"no archive")
    with pytest.raises(ParameterError, match="is damaged"):
        load_cases(tmp_path)


def test_the_command_trains_on_files(folder, monkeypatch):
    def quickly(cases, *, seed):
        return replace(made_posterior(), card={"cases": len(cases), "seed": seed})

    monkeypatch.setattr(command, "train_posterior", quickly)
    target = folder / "causes.npz"
    monkeypatch.setattr(
        sys,
        "argv",
        [
            "causes",
            "train",
            str(folder),
            "--out",
            str(target),
            "--stages",
            str(folder / "stages.npz"),
        ],
    )
    assert command.main() == 0
    assert load_posterior(target).card["cases"] == 2 * fit.CHUNK


def test_no_private_module_of_scikit_learn_is_imported():
    private = {
        node.module
        for path in Path(noise.__file__).parent.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sklearn.")
        if any(part.startswith("_") for part in (node.module or "").split("."))
    }
    assert not private  # they move with any release


def test_training_is_deterministic():
    one, other = (train_posterior(made_cases(4, each=5), seed=4, n_rounds=10) for _ in range(2))
    for name in ("scale", "weights"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    for name in ("roots", "feature", "threshold", "children", "value"):
        assert np.array_equal(getattr(one.trees, name), getattr(other.trees, name))
    assert one.alarm == other.alarm
