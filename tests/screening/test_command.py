"""``bushing-noise screen``: what it writes, and what it refuses."""

import csv
from functools import partial

import pytest

from models.errors import ParameterError
from noise.cli import main
from noise.screening.parts import noisy_parts
from noise.screening.standing import SHARED
from tests.helpers.quick_screens import no_advice

QUICK = ["--speed", "1,5,9", "--support-stiffness", "2214", "--sounds", "1"]
MUTE = ["--sounds", "0"]
BAD = """\
[design]
colour = "red"
"""


def rows(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_maps_margins_ranking_and_pictures_are_written(tmp_path, capsys):
    out = tmp_path / "new" / "screen"
    given = ["screen", "PDMS", "fluorocarbon-thesis", "--interference", "0.279", *QUICK]
    assert main([*given, "--out", str(out)]) == 0
    names = sorted(path.name for path in out.iterdir())
    assert names == [
        "advice.csv", "critical_speeds.csv", "designs.csv", "map-1.png", "map-2.png",
        "map.csv", "report.html",
    ]  # fmt: skip
    points = rows(out / "map.csv")
    assert len(points) == 6
    assert set(points[0]) >= {
        "design", "environment", "temperature_C", "speed_rad_s", "interference_mm",
        "support_stiffness_Nm_rad", "regime", "label", "persists", "label_by_physics", "level_dba",
        "how",
    }  # fmt: skip
    quiet, loud = points[0], points[3]
    assert (quiet["design"], quiet["label"], quiet["level_dba"]) == ("PDMS", "none", "")
    assert loud["regime"] == "stick-slip"
    assert float(loud["level_dba"]) > 30.0
    assert {row["how"] for row in points} == {"simulated"}
    ranked = rows(out / "designs.csv")
    assert [(row["rank"], row["design"]) for row in ranked] == [
        ("1", "PDMS"), ("2", "fluorocarbon-thesis"),
    ]  # fmt: skip
    shares = [float(ranked[1][f"share_{x}"]) for x in SHARED]
    assert sum(shares) == pytest.approx(1.0, abs=1e-3)
    critical = rows(out / "critical_speeds.csv")
    assert [row["v_crit2_stability_rad_s"] for row in critical] == ["0.0", "0.0"]
    printed = capsys.readouterr().out
    assert printed.startswith("1. PDMS, dry: quiet in its use (3 conditions)")
    for word in ("exposure", "risk"):
        assert word not in printed
    advice = rows(out / "advice.csv")
    assert {row["design"] for row in advice} == {"fluorocarbon-thesis"}
    assert {row["ends_noise"] for row in advice} <= {"True", "False", "true", "false"}
    assert "each design at the same 3 points: " in printed


def test_a_swing_has_frequencies_in_its_map(tmp_path):
    given = ["--oscillate", "15,1..2/2", "--support-stiffness", "fixed", "--sounds", "0"]
    assert main(["screen", "PDMS", *given, "--out", str(tmp_path)]) == 0
    points = rows(tmp_path / "map.csv")
    assert {row["motion"] for row in points} == {"swinging"}
    assert [row["frequency_hz"] for row in points[:2]] == ["1.0", "2.0"]
    assert float(points[1]["speed_rad_s"]) == pytest.approx(3.28987, rel=1e-5)
    assert {row["support_stiffness_Nm_rad"] for row in points} == {"fixed"}
    assert (tmp_path / "map.png").is_file()


def test_one_bad_design_among_several_is_named_and_the_others_are_screened(tmp_path, capsys):
    bad = tmp_path / "bad.toml"
    bad.write_text(BAD, encoding="utf-8")
    assert main(["screen", str(bad), "PDMS", *QUICK, "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr()
    assert "unknown key 'colour'" in told.err
    assert told.out.startswith("1. PDMS")
    last = rows(tmp_path / "out" / "designs.csv")[-1]
    assert last["design"] == str(bad)
    assert "unknown key 'colour'" in last["error"]


STATED = """\
material = "fluorocarbon-thesis"
[design]
name = "mine"
interference_mm = 0.279
support_stiffness_Nm_rad = 3745
[tolerances]
damping = 0.1
kinetic_torque = 0.05
"""


@pytest.fixture
def few(monkeypatch):
    """Few parts, and no advice."""
    monkeypatch.setattr("noise.screening.screen.noisy_parts", partial(noisy_parts, parts=8))
    with no_advice():
        yield


def test_a_design_with_tolerances_tells_what_its_parts_do(tmp_path, capsys, few):
    given = tmp_path / "given.toml"
    given.write_text(STATED, encoding="utf-8")
    out = tmp_path / "out"
    assert main(["screen", str(given), "PDMS", "--speed", "7,9", "--out", str(out), *MUTE]) == 0
    told = {row["design"]: row for row in rows(out / "designs.csv")}
    assert told["PDMS"]["p_noisy_part"] == ""
    without = ["--speed", "7", "--no-tolerances", "--out", str(tmp_path / "without"), *MUTE]
    assert main(["screen", str(given), *without]) == 0
    assert rows(tmp_path / "without" / "designs.csv")[0]["p_noisy_part"] == ""
    mine = told["mine"]
    low, value, high = (float(mine[f"p_noisy_part{end}"]) for end in ("_low", "", "_high"))
    assert low <= value <= high
    assert "how sure: " in capsys.readouterr().out


def test_what_fails_is_told_and_loses_nothing_else(tmp_path, capsys, monkeypatch):
    def fails(design, *_, **__):
        raise ParameterError("no fit")

    monkeypatch.setattr("noise.screening.screen.advise", fails)
    given = ["PDMS", "fluorocarbon-thesis", "--interference", "0.279", *QUICK]
    assert main(["screen", *given, "--out", str(tmp_path)]) == 1
    assert "advice or tolerances: no fit" in capsys.readouterr().err
    noisy, last = rows(tmp_path / "designs.csv")[-2:]
    assert (noisy["design"], noisy["rank"]) == ("fluorocarbon-thesis", "2")
    assert last["design"] == "fluorocarbon-thesis, in part"
    assert last["error"] == "advice or tolerances: no fit"


def test_a_map_is_the_same_bytes_whatever_the_number_of_workers(tmp_path):
    for workers in ("1", "2"):
        out = tmp_path / workers
        given = ["--speed", "1..12/12", "--interference", "0.279", "--support-stiffness", "2214"]
        given += ["--workers", workers, "--sounds", "0", "--out", str(out)]
        with no_advice():
            assert main(["screen", "fluorocarbon-thesis", *given]) == 0
    for name in ("map.csv", "critical_speeds.csv", "designs.csv", "map.png"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()
