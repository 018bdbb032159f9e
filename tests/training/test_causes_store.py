"""Training cases in files: what was drawn comes back, and what is there is not drawn again."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from noise.diagnosis.causes.posterior import load_posterior
from noise.training.causes import __main__ as command, store
from noise.training.causes.store import draw_into, load_cases, save_cases
from tests.helpers.made_posteriors import made_cases, made_posterior


def test_cases_come_back_from_their_file(tmp_path):
    cases = made_cases(1, each=1)
    save_cases(tmp_path / "cases-0-9.npz", cases)
    for before, after in zip(cases, load_cases(tmp_path), strict=True):
        assert after.truth == before.truth
        assert (after.rig, after.departures) == (before.rig, before.departures)
        assert after.table.conditions == before.table.conditions
        place = [after.table.names.index(name) for name in before.table.names]
        for part in ("measured", "nominal", "scatter"):
            found = getattr(after.table, part)[:, place]
            assert np.array_equal(found, getattr(before.table, part).astype(np.float32))


def test_files_that_are_there_are_not_drawn_again(tmp_path, monkeypatch):
    drawn = []

    def of_a_rig(seeds):
        drawn.append(seeds)
        return made_cases(seeds.start, each=1)[:4]

    monkeypatch.setattr(store, "known_cases_of_a_rig", of_a_rig)
    seeds = range(400_000, 400_000 + 2 * store.CHUNK)
    paths = sorted(draw_into(tmp_path, seeds))
    assert len(paths) == 2
    assert len(drawn) == len(seeds) / 4
    paths[0].unlink()
    drawn.clear()
    list(draw_into(tmp_path, seeds))
    assert len(drawn) == store.CHUNK / 4
    assert len(load_cases(tmp_path)) == len(seeds)


def test_a_folder_without_cases_and_a_damaged_file_are_refused(tmp_path):
    with pytest.raises(ParameterError, match="draw some first"):
        load_cases(tmp_path)
    (tmp_path / "cases-0-4.npz").write_bytes(b"no archive")
    with pytest.raises(ParameterError, match="no file of drawn cases"):
        load_cases(tmp_path)


def test_the_command_trains_on_files(tmp_path, monkeypatch):
    save_cases(
        tmp_path / "cases-0-9.npz",
        [replace(case, seed=i) for i, case in enumerate(made_cases(3, each=2))],
    )

    def quickly(cases, *, seed):
        return replace(made_posterior(), card={"cases": len(cases)})

    monkeypatch.setattr(command, "train_posterior", quickly)
    target = tmp_path / "causes.npz"
    monkeypatch.setattr(sys, "argv", ["causes", "train", str(tmp_path), "--out", str(target)])
    assert command.main() == 0
    assert load_posterior(target).card["cases"] == len(load_cases(tmp_path))
