"""Cases say nothing of their answers but by what was recorded, and come out the same each time."""

import ast
import json
from collections import Counter
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from tests.blind.benches import KINDS
from tests.blind.cases import (
    Case,
    responses_of,
    run_case,
    structures_of,
    write_case,
)
from tests.blind.design import CLASSES, Condition, draw_design
from tests.blind.effects import CAUSES, DEVELOPMENT, FORMS, SEALED
from tests.blind.rig import Parameters, plain

ROOT = Path(__file__).parents[2]
PACKAGES = ("models", "sim", "features", "noise")
SLOW, FAST = Condition(1.5, 0.279, 2214.0), Condition(3.0, 0.381, 2214.0)


def _design(seconds=0.15, conditions=(SLOW, FAST), **changes):
    for index in range(40):
        design = draw_design(5, index, DEVELOPMENT)
        if design.kind == "none":
            return replace(design, conditions=conditions, seconds=seconds, rate=30_000, **changes)
    raise AssertionError("no null case among 40")


@pytest.fixture(scope="module")
def nothing():
    return run_case(_design()).recordings


CHANNEL_OF = {"drive": 0, "friction": 0, "structure": 1, "radiation": 2}


@pytest.mark.parametrize("key", sorted(FORMS), ids=":".join)
def test_a_form_is_nothing_at_strength_zero_and_shows_at_full_strength(key, nothing):
    form = FORMS[key]
    _assert_untouched_at_zero(form)
    strong = run_case(_design(forms=((form, 1.0),))).recordings
    own = [CHANNEL_OF[form.stage]] if form.stage in CHANNEL_OF else range(3)
    changed = [_difference(a, b, i) for a, b in zip(strong, nothing, strict=True) for i in own]
    assert max(changed) > 0.05
    assert all(np.abs(x).max() < 1e5 for x in strong)
    before = {"structure": 1, "radiation": 2}.get(form.stage, 0)
    if not form.effect.startswith("stranger_"):
        for a, b in zip(strong, nothing, strict=True):
            assert a[:before].tobytes() == b[:before].tobytes()


def _assert_untouched_at_zero(form):
    one, other = (plain(Parameters(), 1.5, rate=9e4, seconds=0.01, settling=0.0) for _ in range(2))
    form.apply(one, 0.0, np.random.default_rng(1), np.random.default_rng(2))
    for field in fields(one):
        a, b = getattr(one, field.name), getattr(other, field.name)
        assert np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b


def _difference(a, b, channel):
    return np.std(a[channel] - b[channel]) / np.std(b[channel])


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(tmp_path):
    index = next(i for i in range(20) if draw_design(1, i, SEALED).kind == "pair")
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        design = replace(draw_design(seed, index, SEALED), seconds=0.2)
        write_case(run_case(design), tmp_path / name, tmp_path / f"{name}.json")
    assert _bytes(tmp_path / "a") == _bytes(tmp_path / "b")
    assert _bytes(tmp_path / "a") != _bytes(tmp_path / "c")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def _bytes(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.mark.parametrize("kept_for", [DEVELOPMENT, SEALED])
def test_classes_have_their_shares_and_causes_come_evenly(kept_for):
    designs = [draw_design(7, i, kept_for) for i in range(840)]
    kinds = Counter(d.kind for d in designs)
    assert kinds == {kind: 42 * CLASSES.count(kind) for kind in set(CLASSES)}
    singles = Counter(d.forms[0][0].effect for d in designs if d.kind == "one")
    assert set(singles) == set(CAUSES)
    assert set(singles.values()) == {16}
    for design in designs:
        effects = [form.effect for form, _ in design.forms]
        assert len(set(effects)) == len(effects)
        assert all(form.kept_for == kept_for for form, _ in design.forms)
        assert bool(design.offsets) == (design.kind == "parameters")
        assert all(0.08 <= abs(x - 1.0) <= 0.2 for x in design.offsets.values())
        assert 4 <= len(design.conditions) <= 9
        repeats = [n for n in Counter(design.conditions).values() if n > 1]
        assert repeats == [2, 2]


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_handed_out_beside_the_samples_does_not_depend_on_what_is_the_matter(
    kind, tmp_path
):
    clipping = ((FORMS["clipping", "wrapped_converter"], 1.0),)
    drawn = draw_design(17, 0, DEVELOPMENT, kind=kind)
    silence = (np.zeros((4, 8), np.float32),) * len(drawn.conditions)
    files = []
    for forms, offsets in (((), {}), (clipping, {}), ((), {"damping": 1.2})):
        design = replace(drawn, forms=forms, offsets=offsets)
        responses = responses_of(design, structures_of(design))
        folder = tmp_path / str(len(files))
        write_case(Case(design, silence, responses, {}), folder, None)
        files.append(_bytes(folder))
    assert files[0] == files[1] == files[2]
    sidecar = json.loads(files[0]["run01.json"])
    assert sidecar["calibrated"] is True
    assert all(set(channel) == {"name", "unit"} for channel in sidecar["channels"])


def _imports(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module


def test_generator_and_packages_import_nothing_of_each_other():
    makers = list((ROOT / "tests" / "blind").rglob("*.py"))
    assert len(makers) > 10
    for path in makers:
        assert not [m for m in _imports(path) if m.split(".")[0] in PACKAGES], path
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            assert not [m for m in _imports(path) if m.startswith("tests")], path
