"""A rig from a table of measured numbers: what it reads, what it changes, what it leaves alone."""

import json
import math
from dataclasses import replace

import pytest

import noise
from models.condition import FIXED
from models.errors import ParameterError
from models.rig_file import load_material_rig, load_rig
from noise.cli import main
from noise.identification.bushing_fit import Known
from noise.identification.evidence import Evidence, table_evidence, with_evidence
from noise.identification.measured import Beforehand, Measurements
from noise.identification.outcome import Number
from noise.identification.table_fit import COLUMNS, TableNumber, read_numbers, score_table
from noise.identification.table_rig import identify_from_table

KNOWN = load_material_rig("fluorocarbon-thesis")
HEADER = ",".join(COLUMNS) + "\n"


def identified(table, known=KNOWN):
    beforehand = Beforehand(known, Known(1.5e-5, 8e-4, 0.5), frozenset())
    return identify_from_table(table, beforehand, Measurements((), ()))


def numbers_of(rig):
    """What a rig would be measured to have, exactly."""
    table = [
        TableNumber("elastomer_stiffness", 1.0, 0.279e-3, FIXED, (), 100.0, "table"),
        TableNumber("slip_frequency", 1.0, 0.279e-3, FIXED, (1.0,), 50.0, "table"),
        TableNumber("mean_torque", 1.0, 0.279e-3, FIXED, (1.0,), 100.0, "table"),
        TableNumber("highest_torque", 1.0, 0.279e-3, FIXED, (1.0,), 100.0, "table"),
    ]
    found = score_table(rig, table).found
    return [replace(number, value=found[number]) for number in table]


def test_a_known_rig_that_gives_the_numbers_is_left_as_it_is():
    found = identified(numbers_of(KNOWN))
    assert found.number("critical_torque").value == pytest.approx(10.7)
    assert found.number("elastomer_stiffness").value == pytest.approx(665.0)


def test_numbers_of_another_rig_change_the_known_one_towards_it():
    other = KNOWN.changed(elastomer_stiffness="x1.2", critical_torque="x1.1", kinetic_torque="x1.1")
    found = identified(numbers_of(other))
    fit = other.fit(0.279e-3)
    assert found.number("elastomer_stiffness").value == pytest.approx(798.0, rel=0.02)
    for name in ("critical_torque", "kinetic_torque"):
        number = found.number(name)
        assert number.value == pytest.approx(getattr(fit, name), rel=0.03)
        assert number.low < getattr(fit, name) < number.high


def test_what_no_number_tells_has_a_wide_interval():
    found = identified(numbers_of(KNOWN)[:1])
    stiffness, kinetic = found.number("elastomer_stiffness"), found.number("kinetic_torque")
    assert stiffness.high / stiffness.low < 1.05
    assert kinetic.high / kinetic.low > 2.0


def test_a_stiffness_in_series_with_beams_says_that_of_the_elastomer():
    series = 1.0 / (1.0 / 665.0 + 1.0 / 2214.0)
    (said,) = table_evidence(
        [TableNumber("effective_stiffness", series, 0.279e-3, 2214.0, weight=50.0)]
    )
    assert said.value == pytest.approx(665.0)
    assert said.error > 0.02  # the beams' own compliance says nothing of the elastomer


def test_evidence_draws_a_number_to_it_by_how_sure_it_is():
    slips = Number("elastomer_stiffness", "Nm/rad", 600.0, 540.0, 667.0, 6, 0.279e-3)
    (sure,) = with_evidence([slips], [Evidence("elastomer_stiffness", 630.0, 0.001, 0.279e-3)])
    (vague,) = with_evidence([slips], [Evidence("elastomer_stiffness", 630.0, 0.5, 0.279e-3)])
    assert 615.0 < sure.value < 630.0
    assert vague.value == pytest.approx(600.0, rel=0.01)
    assert math.log(sure.high / sure.low) < math.log(slips.high / slips.low)


def test_contradicting_evidence_makes_a_number_less_sure_than_agreeing():
    slips = Number("elastomer_stiffness", "Nm/rad", 600.0, 588.0, 612.0, 6, 0.279e-3)
    agrees, contradicts = (
        with_evidence([slips], [Evidence("elastomer_stiffness", k, 0.01, 0.279e-3)])[0]
        for k in (602.0, 700.0)
    )
    assert contradicts.high / contradicts.low > agrees.high / agrees.low


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("slip_freq,1,Hz,0.279,fixed,1,", "did you mean 'slip_frequency'"),
        ("slip_frequency,1,rad/s,0.279,fixed,1,", "unit 'rad/s' of slip_frequency must be 'Hz'"),
        ("slip_frequency,many,Hz,0.279,fixed,1,", "value = 'many' must be a number above 0"),
        ("slip_frequency,155,Hz,0.279,fixed,,", "speed_rad_s = '' must be"),
        ("slip_frequency,155,Hz,0.279,,1,", "support_stiffness_Nm_rad = '' must be"),
    ],
)
def test_a_row_that_cannot_be_used_is_named(row, message, tmp_path):
    path = tmp_path / "measured.csv"
    path.write_text(HEADER + row + "\n")
    with pytest.raises(ParameterError, match=rf"row 1: .*{message}"):
        read_numbers(path)


def test_the_command_takes_a_table_alone(tmp_path, capsys):
    (tmp_path / "measured.csv").write_text(
        HEADER + "effective_stiffness,464,Nm/rad,0.279,2214,,\n"
        "elastomer_stiffness,665,Nm/rad,0.279,fixed,,\nslip_frequency,155,Hz,0.279,fixed,1,3\n"
    )
    (tmp_path / "known.toml").write_text('base = "fluorocarbon-thesis"\n')
    out = tmp_path / "mine"
    assert main([
        "identify", "--numbers", str(tmp_path / "measured.csv"),
        "--rig", str(tmp_path / "known.toml"), "--out", str(out),
    ]) == 0  # fmt: skip
    found = json.loads((out / "identification.json").read_text())
    assert [row["item"] for row in found["measured"]][-1] == "slip_frequency"
    assert load_rig(out / "rig.toml").fits[0].elastomer_stiffness < 665.0
    assert "This rig" in (out / "report.html").read_text()
    assert main(["identify"]) == 2
    assert "name recordings, or --numbers" in capsys.readouterr().err


def test_a_notebook_takes_a_table_too(tmp_path):
    path = tmp_path / "measured.csv"
    path.write_text(HEADER + "elastomer_stiffness,700,Nm/rad,0.279,fixed,,1\n")
    found = noise.identify(numbers=path)
    assert found.number("elastomer_stiffness").value == pytest.approx(700.0, rel=0.01)
