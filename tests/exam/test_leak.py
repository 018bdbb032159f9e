"""A case's files give its class away by nothing but what was recorded."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from tests.blind.benches import KINDS
from tests.blind.cases import (
    Case,
    answer_of,
    responses_of,
    run_case,
    structures_of,
    write_case,
)
from tests.blind.design import draw_design
from tests.blind.effects import DEVELOPMENT
from tests.exam.leak import leak, seen_of


def _classes(design):
    """The class, and of single effects the stage."""
    stage = design.forms[0][0].stage if design.kind == "one" else ""
    return design.kind, f"{design.kind} {stage}"


def _seen(tmp_path, count, change=None, kinds=("quiet",)):
    """Write cases with silence for samples, which the check does not look at, and look at them."""
    seen, classes = [], []
    for index in range(count):
        design = draw_design(17, index, DEVELOPMENT, kind=kinds[index % len(kinds)])
        n = round(design.seconds * design.rate)
        silence = (np.zeros((4, n), np.float32),) * len(design.conditions)
        case = Case(design, silence, responses_of(design, structures_of(design)), answer_of(design))
        folder = tmp_path / f"case-{index + 1:04d}"
        write_case(case, folder, None)
        if change is not None:
            change(folder, design)
        seen.append(seen_of(folder))
        classes.append(_classes(design))
    assert kinds != ("quiet",) or len({len(row) for row in seen}) == 1
    return seen, classes


@pytest.mark.slow
@pytest.mark.parametrize("kinds", [("quiet",), tuple(KINDS)], ids=["quiet", "all"])
def test_what_is_no_sound_tells_no_class(tmp_path, kinds):
    seen, classes = _seen(tmp_path, 66, kinds=kinds)
    found = leak(seen, ["nothing" if kind in ("none", "parameters") else "something"
                        for kind, _ in classes], shuffles=20)  # fmt: skip
    assert found.p_value > 0.05


def test_a_leak_of_a_few_bytes_is_found(tmp_path):
    def longer(folder, design):
        if design.kind not in ("none", "parameters"):
            text = json.loads((folder / "run02.json").read_text())
            (folder / "run02.json").write_text(json.dumps(text, indent=1) + "\n\n")

    seen, classes = _seen(tmp_path, 60, longer)
    found = leak(seen, ["nothing" if kind in ("none", "parameters") else "something"
                        for kind, _ in classes], shuffles=20)  # fmt: skip
    assert found.p_value < 0.05
    assert found.share > found.by_chance + 0.1


@pytest.mark.slow
def test_levels_tell_no_class_once_effects_are_off(tmp_path):
    seen, classes = [], []
    for index in range(600):
        design = replace(draw_design(17, index, DEVELOPMENT), seconds=0.1)
        names = frozenset(form.effect for form, _ in design.forms)
        write_case(run_case(design, names, plain=True), tmp_path / "case", None)
        seen.append(seen_of(tmp_path / "case", levels=True))
        classes.append(design.kind)
        shutil.rmtree(tmp_path / "case")
    assert leak(seen, classes, shuffles=60).p_value > 0.02


@pytest.mark.slow
def test_what_is_no_sound_tells_no_class_in_600_cases(tmp_path):
    seen, classes = _seen(tmp_path, 600)
    for names in zip(*classes, strict=True):
        assert leak(seen, list(names), shuffles=60).p_value > 0.02


def test_samples_are_in_their_units_and_have_no_scale_of_their_own(tmp_path):
    design = replace(draw_design(17, 0, DEVELOPMENT), kind="none", forms=(), offsets={})
    silence = (np.zeros((4, 8), np.float32),) * len(design.conditions)
    write_case(
        Case(design, silence, responses_of(design, structures_of(design)), {}), tmp_path / "c", None
    )
    for path in (tmp_path / "c").glob("run*.json"):
        said = json.loads(path.read_text())
        assert said["calibrated"] is True
        assert all(set(channel) == {"name", "unit"} for channel in said["channels"])
