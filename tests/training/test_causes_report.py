"""What is said of drawn cases that were not learned: by bench, and of forms never drawn."""

from __future__ import annotations

import sys
from dataclasses import replace

from noise.diagnosis.causes.posterior import load_posterior
from noise.training.causes import __main__ as command
from noise.training.causes.report import is_kept, report
from noise.training.causes.store import save_cases
from tests.helpers.made_posteriors import made_cases, made_posterior


def test_a_report_has_a_row_for_each_kind_of_bench():
    cases = [
        replace(case, departures=("laws",) if i % 2 else ())
        for i, case in enumerate(made_cases(9, each=2))
    ]
    head, *rows = report(made_posterior(), cases).splitlines()
    assert [row.split()[0] for row in rows] == ["all", "quiet", "laws"]
    assert "right first" in head
    right_first = rows[0].split(")")[2].split("(")[0]  # the third share
    assert float(right_first) > 0.9


def test_the_command_trains_on_files_and_reports_on_rigs_that_it_kept(
    tmp_path, monkeypatch, capsys
):
    cases = made_cases(3, each=2)
    save_cases(tmp_path / "cases-0-9.npz", [replace(c, seed=i) for i, c in enumerate(cases)])
    learned = []

    def quickly(cases, *, seed):
        learned.extend(cases)
        return replace(made_posterior(), card={"cases": len(cases)})

    monkeypatch.setattr(command, "train_posterior", quickly)
    target = tmp_path / "causes.npz"
    monkeypatch.setattr(sys, "argv", [
        "causes", "train", str(tmp_path), "--report", "--out", str(target),
    ])  # fmt: skip
    assert command.main() == 0
    assert "right first" in capsys.readouterr().out
    assert learned
    assert not any(is_kept(case) for case in learned)
    assert load_posterior(target).card["cases"] == len(learned)
