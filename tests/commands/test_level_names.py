"""A level of one name is the same number wherever the program tells it of the same samples."""

import html
import json
import re

import numpy as np
import pytest

from features.table import recording_features
from noise.app.opened import open_paths
from noise.app.sounds import SoundCache, bands
from noise.cli import main
from noise.labels.labelling import label
from noise.recordings import read_recording
from tests.helpers.files import csv_rows, pressure_file

LEVELS = ("level_db", "level_dba", "l_afmax_dba")
MOST_ON_A_PAGE = re.compile(r">([^<]*) dB\(A\) Fast maximum<")


def hiss(seconds, rms=0.05, rate=48_000):
    return rms * np.random.default_rng(2).standard_normal(round(seconds * rate))


SOUNDS = {
    "hum below the noise": lambda: (
        hiss(2.0, 0.01) + 0.5 * np.sin(2.0 * np.pi * 50.0 * np.arange(2 * 48_000) / 48_000)
    )
}


@pytest.fixture(scope="module")
def squeal(tmp_path_factory):
    """A simulated squeal, whole, as `simulate` writes it."""
    folder = tmp_path_factory.mktemp("levels")
    call = ["simulate", "--speed", "10", "--support-stiffness", "3745", "--out"]
    assert main([*call, str(folder / "run")]) == 0
    return folder / "run.wav"


@pytest.fixture(scope="module", params=["squeal", *SOUNDS])
def recorded(request, tmp_path_factory):
    if request.param == "squeal":
        return request.getfixturevalue("squeal")
    return pressure_file(tmp_path_factory.mktemp("levels") / "run", SOUNDS[request.param]())


def test_every_part_tells_the_levels_of_the_label_table(recorded, tmp_path):
    (row,) = label(recorded)  # these recordings have one label throughout
    levels = {name: row[name] for name in LEVELS}

    assert main(["render", str(recorded), "--out", str(tmp_path / "heard.wav")]) == 0
    (part,) = json.loads((tmp_path / "heard.json").read_text())["parts"]
    assert {name: part[name] for name in LEVELS} == levels
    assert main(["render", str(recorded), str(recorded), "--out", str(tmp_path / "set")]) == 0
    for one in csv_rows(tmp_path / "set" / "levels.csv"):
        assert {name: float(one[name]) for name in LEVELS} == levels

    recording = read_recording(recorded)
    found = recording_features(recording)
    assert round(found["pressure_level"], 2) == row["level_db"]
    assert round(found["pressure_level_a"], 2) == row["level_dba"]

    page = tmp_path / "review.html"
    assert main(["review", str(recorded), "--out", str(page)]) == 0
    text = html.unescape(page.read_text(encoding="utf-8"))
    assert f"<span>{row['level_dba']:.1f} dB(A)</span>" in text
    assert MOST_ON_A_PAGE.findall(text) == [f"{row['l_afmax_dba']:.1f}"]

    found = bands(SoundCache(open_paths([recorded])).track(0), {})
    assert [found[name] for name in ("level", "level_a", "level_af_max")] == [*levels.values()]
