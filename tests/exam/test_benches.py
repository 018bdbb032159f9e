"""Kinds of bench: nothing is the matter on them, and what they differ by is stated or seen."""

import tomllib
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from models.rig_file import load_rig
from noise.diagnosis.case import read_case
from noise.recordings.files import read_recording
from tests.blind.benches import BITS, KINDS, NOISE, Bench, draw_bench
from tests.blind.cases import STARTS, rig_text, run_case, write_case
from tests.blind.design import BLOCKS, draw_design
from tests.blind.effects import DEVELOPMENT, FORMS, SEALED
from tests.blind.gap import gaps_of, null_gap
from tests.blind.laws import CONSTANT, LAWS, draw_law
from tests.helpers.small_rigs import gap_of_case


def _null(kind, index=0, **changes):
    design = draw_design(6, index, DEVELOPMENT, "kind", kind)
    return replace(design, kind="none", forms=(), offsets={}, **changes)


@pytest.mark.parametrize("kind", KINDS)
def test_without_an_effect_a_bench_lies_within_its_own_floor_and_with_one_beyond(kind):
    design = _null(kind, seconds=0.3)
    strong = replace(
        design, kind="one", forms=((FORMS["velocity_strengthening", "root_of_speed"], 1.0),)
    )
    nothing = null_gap(design)
    assert nothing < 3.5  # two repeats of a quiet bench are 1.5 to 2.2 apart
    assert gaps_of(run_case(strong))["gap"] > nothing


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_handed_out_of_each_kind_can_be_read(kind, tmp_path):
    design = _null(kind, 1, seconds=0.3)
    design = replace(design, conditions=design.conditions[:1])
    write_case(run_case(design), tmp_path / "case", None)
    rig = load_rig(tmp_path / "case" / "rig.toml")
    recording = read_recording(tmp_path / "case" / "run01.wav")
    assert recording.channel_names == design.bench.channels
    assert rig.friction.name == LAWS[design.bench.law.name].named
    assert [effect.name for effect in rig.effects] == [x.effect for x in design.bench.listed]
    assert bool(rig.measured) == (design.bench.responses != "none")
    assert ("sensors" in tomllib.loads(rig_text(design))) == design.bench.stated
    assert np.isfinite(recording.samples).all()


def _gap_from_rig_file(case, folder):
    write_case(case, folder, None)
    read = read_case([folder], load_rig(folder / "rig.toml"))
    return gap_of_case(read.recordings, read.rig).distance


@pytest.mark.filterwarnings("ignore:.*is missing from the simulated")
@pytest.mark.parametrize("name", sorted(set(LAWS) - {"constant"}))
def test_the_first_simulator_solves_a_stated_law_as_this_rig_does(name, tmp_path):
    bench = Bench("laws", law=draw_law(name, np.random.default_rng(4)))
    design = _null("quiet", 1, seconds=0.5, bench=bench)
    case = run_case(replace(design, conditions=design.conditions[:2]))
    stated = _gap_from_rig_file(case, tmp_path / "stated")
    constant = replace(case, design=replace(case.design, bench=replace(bench, law=CONSTANT)))
    unstated = _gap_from_rig_file(constant, tmp_path / "unstated")
    assert stated < 2.2
    assert unstated > 1.5 * stated


def test_a_converter_leaves_only_its_steps():
    bench = Bench("sensors", bits=dict.fromkeys(NOISE, BITS))
    assert bench.step_of("torque") == pytest.approx(0.05, rel=0.01)
    assert bench.step_of("acceleration") == pytest.approx(0.48, rel=0.01)
    assert bench.step_of("pressure") == pytest.approx(14e-3, rel=0.01)
    assert bench.step_of("angle") == pytest.approx(6e-3, rel=0.01)
    design = _null("sensors", seconds=0.3)
    design = replace(design, bench=bench, conditions=design.conditions[:1])
    (samples,) = run_case(design).recordings
    for x, name in zip(samples.astype(float), NOISE, strict=True):
        steps = x / bench.step_of(name)
        assert steps == pytest.approx(np.round(steps), abs=1e-3)


@pytest.mark.parametrize("name", sorted(STARTS))
def test_every_start_ends_at_the_stated_speed(name):
    for seed in range(20):
        course = STARTS[name](np.random.default_rng(seed), 0.5)
        assert course(np.array([0.5]))[0] == pytest.approx(1.0, abs=0.03)
        assert (course(np.linspace(0.0, 0.5, 99)) >= 0.0).all()


def test_a_block_of_a_kind_holds_its_quotas_sealed_or_not():
    for kind in ("quiet", "laws"):
        for block, kept_for, least in (
            ("kind", DEVELOPMENT, {"none": 20, "one": 16, "pair": 8, "stranger": 6}),
            ("sealed kind", SEALED, {"none": 75, "one": 60, "pair": 30, "stranger": 20}),
        ):
            designs = [draw_design(8, i, kept_for, block, kind) for i in range(len(BLOCKS[block]))]
            counts = Counter(d.kind for d in designs)
            assert all(counts[name] >= n for name, n in least.items())
            for design in designs:
                names = {form.effect for form, _ in design.forms}
                assert not names & set(design.bench.without)
                assert {form.kept_for for form, _ in design.forms} <= {kept_for}


def test_kinds_of_bench_share_no_chance_and_sizes_reach_a_factor_of_three():
    inertias = {draw_design(1, 0, DEVELOPMENT, "kind", kind).inertias for kind in KINDS}
    assert len(inertias) == len(KINDS)
    rng = np.random.default_rng(0)
    factors = np.array([list(draw_bench("sizes", rng).sizes.values()) for _ in range(300)])
    assert factors.max() == pytest.approx(3.0, rel=0.05)
    assert factors.min() == pytest.approx(1.0 / 3.0, rel=0.05)
