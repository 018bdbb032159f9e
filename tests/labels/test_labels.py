"""Labels in time, and the table that links them to conditions."""

import csv
import itertools
import math
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from features.kernels.weighting import a_weighted_level
from models.condition import FIXED, Condition
from models.recording import Channel, Recording
from models.rig_file import load_material_rig
from noise.classifier import LABELS, load_classifier
from noise.cli import main
from noise.labels.rows import label_rows
from noise.labels.segments import (
    FREQUENCY_NAMES,
    Segment,
    file_label,
    label_recording,
    segment_frequency,
)
from noise.labels.table import COLUMNS
from noise.recordings import write_recording
from sim.run import simulate

CLASSIFIER = load_classifier()


def sound(*parts, rate=30_000.0, calibrated=True):
    samples = np.concatenate(parts)[None, :]
    return Recording(samples, rate, (Channel("pressure"),), calibrated=calibrated)


@pytest.fixture(scope="module")
def squeal():
    rig = load_material_rig("fluorocarbon")
    return simulate(rig, 10.0, support_stiffness=3745.0, seconds=2.0).recording["pressure"]


def test_a_squeal_between_silences_is_found_where_it_is(squeal):
    quiet = np.zeros(45_000)
    segments = label_recording(sound(quiet, squeal, quiet), CLASSIFIER)
    assert (segments[0].start, segments[-1].end) == (0.0, pytest.approx(5.0))
    for one, following in itertools.pairwise(segments):
        assert one.end == following.start
        assert one.label != following.label
    assert segments[0].label == "none"
    assert segments[0].level is segments[0].level_dbfs is None
    found = file_label(segments)
    assert found.label == "squeal"
    assert found.start == pytest.approx(1.5, abs=0.05)
    assert found.end == pytest.approx(3.5, abs=0.05)


@pytest.mark.parametrize("over", [None, 20.0], ids=["in silence", "in hiss"])
@pytest.mark.parametrize(
    ("noise", "interference", "stiffness", "speed"),
    [("creak", 0.381e-3, 3745.0, 5.0), ("squawk", 0.279e-3, 2214.0, 5.0)],
)
def test_noises_begin_and_end_where_they_were_put_to_50_ms(
    noise, interference, stiffness, speed, over
):
    rig = load_material_rig("fluorocarbon")
    whole = simulate(
        rig, speed, interference=interference, support_stiffness=stiffness, seconds=3.0
    ).recording["pressure"]
    rng = np.random.default_rng(0)
    for _ in range(3):
        begin, length = rng.uniform(1.0, 2.0), rng.uniform(1.2, 3.0)
        first, n = round(begin * 30_000), round(length * 30_000)
        heard = rng.normal(size=180_000)
        level = -np.inf if over is None else a_weighted_level(whole[:n], 30e3) - over
        heard *= 10 ** (0.05 * (level - a_weighted_level(heard, 30e3)))
        heard[first : first + n] += whole[:n]
        found = file_label(label_recording(sound(heard), CLASSIFIER))
        assert found.label == noise
        assert found.start == pytest.approx(begin, abs=0.05)
        assert found.end == pytest.approx(begin + length, abs=0.05)


def test_what_else_may_be_heard_decides_how_sure_a_name_has_to_be(squeal):
    strict = dict.fromkeys(("any", "rig"), (0.9999,) * 3) | {"car": (0.3,) * 3}
    classifier = replace(CLASSIFIER, thresholds=strict)
    heard = sound(squeal)
    for surroundings, name in ((None, "unknown"), ("any", "unknown"), ("car", "squeal")):
        segments = label_recording(heard, classifier, surroundings=surroundings)
        assert file_label(segments).label == name
    # At a stated condition of a rig nothing else is expected to sound.
    at = replace(heard, condition=Condition(speed=10.0))
    for surroundings, name in ((None, "squeal"), ("rig", "squeal"), ("any", "unknown")):
        segments = label_recording(at, classifier, surroundings=surroundings)
        assert file_label(segments).label == name


def test_levels_are_re_20_upa_or_full_scale():
    tone = 0.1 * math.sqrt(2.0) * np.sin(2 * np.pi * 1000.0 * np.arange(30_000) / 30e3)
    for calibrated, level in ((True, pytest.approx(73.98, abs=0.01)), (False, None)):
        (segment,) = label_recording(sound(tone, calibrated=calibrated), CLASSIFIER)
        assert segment.level == level
        assert segment.level_dbfs == pytest.approx(-20.0, abs=0.01)


def test_what_no_noise_can_be_told_from_is_unknown():
    slow = sound(np.random.default_rng(0).normal(size=400), rate=350.0)
    angle = Recording(np.linspace(0.0, 5.0, 30_000)[None], 30e3, (Channel("angle"),))
    for recording in (slow, angle):
        (segment,) = label_recording(recording, CLASSIFIER)
        assert (segment.label, segment.frequency) == ("unknown", None)


@pytest.mark.parametrize("n", [16, 1000, 15_001, 31_234])
def test_recordings_of_any_length_are_labelled_to_their_end(n):
    noise = np.random.default_rng(0).normal(size=n)
    segments = label_recording(sound(noise), CLASSIFIER)
    assert segments[-1].end == pytest.approx(n / 30e3)


def test_tracks_of_a_plain_file_are_labelled_one_by_one(squeal):
    two = np.stack([squeal, np.zeros_like(squeal)])
    channels = (Channel("pressure"), Channel("pressure_2"))
    recording = Recording(two, 30e3, channels, calibrated=False)
    segments = label_recording(recording, CLASSIFIER, per_track=True)
    assert {s.channel: s.label for s in segments} == {"1": "squeal", "2": "none"}


def test_rows_have_all_columns_and_say_where_a_condition_comes_from():
    condition = Condition(interference=0.279e-3, support_stiffness=FIXED)
    recording = Recording(np.zeros((1, 100)), 100.0, (Channel("pressure"),), condition)
    segment = Segment("all", 0.0, 1.0, "none", dict.fromkeys(LABELS, 0.2), None, 50.0, -44.0)
    (row,) = label_rows("a/b.wav", recording, [segment])
    assert tuple(row) == COLUMNS
    assert row["interference_mm"] == 0.279
    assert row["interference_mm_source"] == "logged"
    assert math.isinf(row["support_stiffness_Nm_rad"])
    assert row["speed_rad_s"] is None
    assert row["speed_rad_s_source"] == row["material_source"] == "missing"


@pytest.mark.parametrize(("stated", "given"), [(3.0, 3.0), (-3.0, 3.0), (3.1, 3.0), (None, 3.0)])
def test_a_speed_is_written_as_it_was_logged_where_the_angle_agrees(stated, given):
    angle = 2.99997 * np.arange(2000) / 1000.0
    recording = Recording(angle[None], 1000.0, (Channel("angle"),), Condition(speed=stated))
    segment = Segment("all", 0.0, 2.0, "none", dict.fromkeys(LABELS, 0.2), None, None, None)
    (row,) = label_rows("run.wav", recording, [segment])
    assert row["speed_rad_s"] == given
    assert row["speed_rad_s_source"] == "logged"
    told = "speed 3 rad/s is that of the channel angle; 3.1 was logged"
    assert row["note"] == (told if stated == 3.1 else None)


def test_speed_of_a_swinging_shaft_is_its_mean_magnitude():
    time = np.arange(60_000) / 30e3
    angle = 0.26 * np.sin(2 * np.pi * 2.0 * time)
    angle += 1e-4 * np.random.default_rng(0).normal(size=angle.size)
    recording = Recording(angle[None], 30e3, (Channel("angle"),))
    segment = Segment("all", 0.0, 2.0, "none", dict.fromkeys(LABELS, 0.2), None, None, None)
    (row,) = label_rows("swing.wav", recording, [segment])
    assert row["speed_rad_s"] == pytest.approx(4 * 0.26 * 2.0, rel=0.03)


def test_one_window_whose_torque_seems_periodic_does_not_tell_the_frequency_of_seven():
    features = np.full((7, len(FREQUENCY_NAMES)), np.nan, dtype=np.float32)
    features[3, FREQUENCY_NAMES.index("torque_fundamental")] = 5.8
    features[:, FREQUENCY_NAMES.index("pressure_high_period_strength")] = 0.5
    features[:, FREQUENCY_NAMES.index("pressure_high_period_rate")] = 2.5
    found = segment_frequency(features, "creak")
    assert found is not None
    assert found > 40.0

    features[:, FREQUENCY_NAMES.index("torque_fundamental")] = 54.0
    assert segment_frequency(features, "creak") == 54.0


DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")


@pytest.mark.skipif(not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings")
def test_every_real_sound_is_labelled(tmp_path):
    folder = Path(DATA) / "audio"
    table = tmp_path / "labels.csv"
    assert main(["label", str(folder), "--out", str(table)]) == 0
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    sounds = {path.relative_to(folder).as_posix() for path in folder.rglob("*.flac")}
    assert {row["file"] for row in rows} == sounds
    assert not any(row["error"] for row in rows)


_CODE = """
import sys
from noise.cli import main
assert main(["label", sys.argv[1], "--out", sys.argv[2]]) == 0
unneeded = ("sim.", "noise.training", "noise.diagnosis", "noise.screening", "noise.pages",
            "sklearn", "matplotlib", "jinja2", "librosa")
print([name for name in sys.modules if name.startswith(unneeded)], file=sys.stderr)
"""


def test_labelling_loads_neither_simulator_nor_training(tmp_path):
    noise = np.random.default_rng(0).normal(size=(1, 20_000))
    path = write_recording(tmp_path / "a", Recording(noise, 20e3, (Channel("pressure"),)))
    call = [sys.executable, "-c", _CODE, str(path), str(tmp_path / "labels.csv")]
    said = subprocess.run(call, capture_output=True, text=True, check=True).stderr
    assert said.splitlines()[-1] == "[]"


@pytest.mark.parametrize("more", [[], ["--fresh"], ["--sensitivity", "2"]], ids=" ".join)
def test_a_label_that_was_changed_in_the_table_alone_is_never_lost(squeal, tmp_path, more):
    write_recording(tmp_path / "run", sound(squeal))
    table = tmp_path / "labels.csv"
    given = ["label", str(tmp_path / "run.wav"), "--out", str(table)]
    assert main(given) == 0
    text = table.read_text(encoding="utf-8")
    assert ",squeal," in text
    table.write_text(text.replace(",squeal,", ",squawk,"), encoding="utf-8")
    assert main([*given, *more]) == 0
    with table.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["label"] == "squawk"]
    assert [row["label_source"] for row in rows] == ["human"]


def test_another_sensitivity_names_anew_what_nobody_corrected(squeal, tmp_path):
    faint = sound(squeal + np.random.default_rng(0).normal(0.0, 2.0 * squeal.std(), squeal.size))
    write_recording(tmp_path / "run", faint)
    given = ["label", str(tmp_path / "run.wav"), "--out", str(tmp_path / "labels.csv")]
    for sensitivity in ("0.1", "10", "1"):
        assert main([*given, "--sensitivity", sensitivity]) == 0
        with (tmp_path / "labels.csv").open(encoding="utf-8", newline="") as file:
            assert {row["label_source"] for row in csv.DictReader(file)} == {"classifier"}
