"""The improved rig: what a diagnosis writes, what reads it, and when there is none."""

from __future__ import annotations

import contextlib
import io
import json
from dataclasses import replace

import pytest
from hypothesis import given, settings, strategies as st

from models.change import changed_rig, multiplied
from models.condition import FIXED
from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import base_name, changed_rig_text, load_material_rig, load_rig
from noise.cli import main
from noise.diagnosis.diagnose import diagnose
from noise.diagnosis.improved_file import check_base, improved_text
from noise.diagnosis.outcome import Improvement
from noise.screening.design import load_design
from tests.helpers.answered_diagnoses import as_the_contract_has_it
from tests.helpers.small_rigs import RIG_FILE, at, run, write_case

WEAK = ("velocity_weakening", {"form": "exponential", "share": 0.4, "speed": 5.0})
CONDITIONS = [at(v, FIXED) for v in (1.0, 1.6, 1.6, 2.5)]


@pytest.fixture(scope="module")
def weak():
    return [run(c, WEAK, seed=60 + i) for i, c in enumerate(CONDITIONS)]


@pytest.fixture(scope="module")
def improved(weak, tmp_path_factory):
    folder = tmp_path_factory.mktemp("weak")
    data, rig = write_case(folder, weak)
    out = folder / "not" / "there" / "yet"
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["diagnose", str(data), "--rig", str(rig), "--out", str(out)]) == 0
    return data, out, printed.getvalue().split()


def test_the_whole_answer_has_the_contracts_keys_and_a_page(improved):
    _, out, printed = improved
    assert printed[:2] == [str(out / "report.html"), str(out / "diagnosis.json")]
    told = json.loads((out / "diagnosis.json").read_text())
    as_the_contract_has_it(told)
    assert told["held_out"]
    assert set(told["held_out"]) < {f"run{i:02d}.wav" for i in range(1, 5)}
    for effect in told["effects"]:
        if effect["closed"] is not None:
            assert effect["gap_floor"] == 1.0
            before, after = effect["gap_before"], max(effect["gap_after"], 1.0)
            assert effect["closed"] == pytest.approx((before - after) / (before - 1.0), abs=2e-3)
            assert effect["closed_low"] <= effect["closed"] + 1e-3
            assert effect["closed"] <= effect["closed_high"] + 1e-3
    assert "<html" in (out / "report.html").read_text()[:200].lower()


def test_a_diagnosis_writes_the_rig_that_closes_its_gap(improved):
    data, out, _ = improved
    told = json.loads((out / "diagnosis.json").read_text())
    assert told["improved"] == "improved.toml"
    named = next(one for one in told["effects"] if one["name"] == "velocity_weakening")
    assert named["closed"] > 0.5
    assert named["gap_after"] < named["gap_recalibrated"]
    rig = load_rig(out / "improved.toml")
    assert [spec.name for spec in rig.effects] == ["velocity_weakening"]
    again = diagnose(data, rig, quick=True)  # a rig, as a notebook gives it
    assert again.verdict == ()
    assert again.improved is None
    assert again.gap < 0.5 * told["gap"]


def test_an_improved_rig_says_from_what_it_is_and_how_sure(improved):
    data, out, _ = improved
    text = (out / "improved.toml").read_text()
    for name in (path.name for path in data.glob("*.wav")):
        assert name in text
    assert "Do not trust it" in text
    assert 'base = "../../../rig.toml"' in text
    stated = {one.name: one for one in load_design(out / "improved.toml").tolerances}
    share = load_rig(out / "improved.toml").effects[0].parameters["share"]
    assert abs(share - 0.4) <= 3.0 * 0.4 * stated["velocity_weakening.share"].spread
    assert 0.0 < stated["kinetic_torque"].spread < 0.1


def test_a_rig_is_not_written_over_itself_or_its_base(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "improved.toml").write_text('base = "PDMS"')
    (tmp_path / "mine.toml").write_text('base = "out/improved.toml"')
    check_base(tmp_path / "mine.toml", tmp_path)
    for rig in (out / "improved.toml", tmp_path / "mine.toml"):
        with pytest.raises(ParameterError, match="name another folder"):
            check_base(rig, out)


def test_what_looks_like_a_listed_effect_is_a_matter_of_parameters(weak, tmp_path):
    faint = 'effects = ["velocity_weakening:form=exponential,share=0.01,speed=5"]'
    data, rig = write_case(tmp_path, weak, RIG_FILE.replace("effects = []", faint))
    found = diagnose(data, rig, quick=True)
    assert found.verdict == ("parameters",)
    assert any("velocity_weakening, which the rig file lists" in note for note in found.notes)


@pytest.mark.parametrize(
    "listed",
    [
        [("plate_modes", {"amount": 0.8, "frequency": 900.0}), ("mains_hum", {"amount": 0.3})],
        [
            ("slip_pulse", {"amplitude": 60.0}),
            ("room_reflections", {"amount": 0.5}),
            ("mount_resonance", {"amount": 0.5, "frequency": 3000.0}),
        ],
    ],
)
def test_against_a_rig_with_the_effects_there_is_no_gap(listed, tmp_path):
    recordings = [run(c, *listed, seed=80 + i) for i, c in enumerate(CONDITIONS)]
    specs = f"effects = {json.dumps([str(LawSpec(*one)) for one in listed])}"
    data, rig = write_case(tmp_path, recordings, RIG_FILE.replace("effects = []", specs))
    assert diagnose(data, rig, quick=True).verdict == ()


AMOUNTS = st.floats(0.7, 1.4)


@settings(max_examples=25)
@given(AMOUNTS, AMOUNTS, AMOUNTS, st.floats(0.01, 0.9))
def test_an_improved_rig_file_reads_as_the_rig_it_was_written_of(
    tmp_path_factory, damping, inertia, stiffness, share
):
    rig = load_material_rig("fluorocarbon-thesis")
    factors = {
        "damping": damping, "elastomer_inertia": inertia, "elastomer_stiffness": stiffness
    }  # fmt: skip
    effect = LawSpec("partial_slip", {"form": "mindlin", "share": float(f"{share:.6g}")})
    changed = changed_rig(rig, multiplied(rig, {}, factors), "rig")
    made = replace(changed, effects=(*rig.effects, effect))
    found = Improvement(made, factors, (effect,), {"damping": 0.1}, (), ("a",), ("b",), 3.0, 1.0)
    path = tmp_path_factory.mktemp("rig") / "improved.toml"
    path.write_text(improved_text(found, "fluorocarbon-thesis"))
    assert load_rig(path) == made


def test_a_base_is_named_from_where_the_file_lies(tmp_path):
    (tmp_path / "PDMS").write_text('name = "a file like a material"')
    assert base_name(tmp_path / "PDMS", tmp_path) == "./PDMS"
    rig = tmp_path / "bench" / "mein Prüfstand.toml"
    rig.parent.mkdir()
    rig.write_text('name = "bench"\nmaterial = "PDMS"')
    out = tmp_path / "out"
    out.mkdir()
    (out / "improved.toml").write_text(
        changed_rig_text(base_name(rig, out), {}, (), {}), encoding="utf-8"
    )
    assert load_rig(out / "improved.toml").material == "PDMS"
