"""Kinds of bench: nothing is the matter on them, and what they differ by is stated or seen."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from models.rig_file import load_rig
from noise.diagnosis.case import read_case
from noise.recordings.files import read_recording
from tests.blind.benches import BITS, KINDS, NOISE, Bench
from tests.blind.cases import rig_text, run_case, write_case
from tests.blind.design import draw_design
from tests.blind.effects import DEVELOPMENT, FORMS
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
