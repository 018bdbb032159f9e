"""The main job: one call, one folder."""

import csv
import html
import re

import numpy as np
import pytest

from features.modal.hammer import estimate_transfer_function
from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from noise.cli import main
from noise.demo import CASES
from noise.demo_hits import ARM, N_HITS
from noise.recordings import read_recording
from noise.recordings.hits import find_hits, read_hit

NAMES = [case.name for case in CASES]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("demo") / "new" / "folder"
    assert main(["demo", "--out", str(out)]) == 0
    return out


def table(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_folder_holds_what_the_readme_says(folder):
    expected = {"report.html", "labels.csv", "features.csv", "recordings", "audio", "hits"}
    assert {path.name for path in folder.iterdir()} == expected
    for part in ("recordings", "audio"):
        found = {path.name for path in (folder / part).iterdir()}
        assert found == {f"{name}.{ending}" for name in NAMES for ending in ("wav", "json")}


def test_the_page_tells_the_levels_of_the_label_table(folder):
    text = html.unescape((folder / "report.html").read_text(encoding="utf-8"))
    rows = table(folder / "labels.csv")
    most = re.findall(r"</sub> at most ([^<]*) dB\(A\)<", text)
    assert most == [f"{float(row['l_afmax_dba']):.1f}" for row in rows]
    assert all(f"{float(row['level_dba']):.1f} dB(A) re 20 µPa" in text for row in rows)


def test_every_recording_carries_its_label_linked_to_its_condition(folder):
    rows = table(folder / "labels.csv")
    assert [row["file"] for row in rows] == [f"{name}.wav" for name in NAMES]
    assert [row["label"] for row in rows] == NAMES
    for row, case in zip(rows, CASES, strict=True):
        assert float(row["speed_rad_s"]) == pytest.approx(case.speed, rel=0.01)
        assert float(row["interference_mm"]) == pytest.approx(1e3 * case.interference)
        assert float(row["support_stiffness_Nm_rad"]) == case.support_stiffness
        assert row["material"] == case.material
        assert row["calibrated"] == "true"


def test_features_have_one_row_a_recording(folder):
    rows = table(folder / "features.csv")
    assert [row["file"] for row in rows] == [f"{name}.wav" for name in NAMES]
    assert all(row["pressure_level"] for row in rows)


def test_sounds_never_clip_and_silence_stays_quiet(folder):
    peaks = {name: abs(read_recording(folder / "audio" / f"{name}.wav").samples) for name in NAMES}
    scales = {
        name: read_recording(folder / "audio" / f"{name}.wav").channels[0].full_scale
        for name in NAMES
    }
    assert all(peaks[name].max() < scales[name] for name in NAMES)
    assert peaks["none"].max() < 0.2 * scales["none"]


def test_its_hits_give_the_response_of_the_modelled_structure(folder):
    hits = [read_hit(path, arm=ARM)[0] for path in find_hits([folder / "hits"])]
    assert len(hits) == N_HITS
    found = estimate_transfer_function(hits, input_unit="N m", output_unit="m/s^2")
    paths = impulse_responses(load_material_rig("fluorocarbon"), 0.279e-3, 2214.0, 90e3)
    band = (found.frequencies >= 100.0) & (found.frequencies <= 5000.0)
    n = 1 << 17
    exact = np.interp(
        found.frequencies[band],
        np.fft.rfftfreq(n, 1.0 / paths.rate),
        np.abs(np.fft.rfft(paths.torque_to_acceleration, n)),
    )
    off = 20.0 * np.log10(np.abs(found.response[band]) / exact)
    assert np.median(np.abs(off)) < 0.2
    assert np.median(found.coherence[band]) > 0.98
