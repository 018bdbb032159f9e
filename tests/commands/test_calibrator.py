"""``--calibrator`` in the commands that read plain sound files."""

import csv
import json

import numpy as np
import pytest
import soundfile

from noise.cli import main

GAIN = 0.05
"""Full scale of a pascal on the recorder."""


def sine(frequency, amplitude, seconds=2.0):
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(int(seconds * 48_000)) / 48e3)


@pytest.fixture
def recorder(tmp_path, monkeypatch):
    """A recorder's files: the calibrator, and a sound of 80 dB."""
    monkeypatch.chdir(tmp_path)
    soundfile.write("tone.wav", GAIN * sine(1000.0, 1.0024 * np.sqrt(2.0)), 48_000)
    soundfile.write("sound.wav", GAIN * sine(700.0, 0.2 * np.sqrt(2.0)), 48_000)
    return tmp_path


def test_features_and_labels_have_levels_in_decibels(recorder, capsys):
    by_tone = ("--calibrator", "tone.wav", "--level", "94")
    assert main(["features", "sound.wav", *by_tone, "--out", "features.csv"]) == 0
    assert "tone.wav: 94 dB at 1000 Hz make full scale 20" in capsys.readouterr().err
    assert main(["label", "sound.wav", *by_tone, "--out", "labels.csv"]) == 0
    for table, column in (("features.csv", "pressure_level"), ("labels.csv", "level_db")):
        lines = (recorder / table).read_text(encoding="utf-8").splitlines()
        row = next(csv.DictReader(lines))
        assert float(row[column]) == pytest.approx(80.0, abs=0.1)


def test_a_rendered_sound_and_a_page_keep_the_calibration(recorder, capsys):
    by_tone = ("--calibrator", "tone.wav", "--level", "94")
    assert main(["render", "sound.wav", *by_tone, "--out", "heard"]) == 0
    sound = json.loads((recorder / "heard.json").read_text())
    assert sound["channels"][0]["scale"] == pytest.approx(0.4, rel=0.02)
    page = ("--no-labelling", "--out", "page.html")
    assert main(["review", "sound.wav", *by_tone, *page]) == 0
    assert "Calibrated sounds" in (recorder / "page.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        (["--calibrator", "tone.wav"], "--calibrator needs --level"),
        (["--level", "94"], "--level a --calibrator"),
        (["--calibrator", "sound.wav", "--level", "94"], "--calibrator sound.wav: is no calib"),
        (["--calibrator", "tune.wav", "--level", "94"], "--calibrator tune.wav: there is no such"),
        (["--calibrator", "tone.wav", "--level", "ninety"], "--level"),
        (["--calibrator", "tone.wav", "--level", "94", "--full-scale", "20"], "not allowed with"),
    ],
)
@pytest.mark.parametrize("command", ["features", "label", "render", "review"])
def test_what_tells_no_calibration_is_refused_in_one_line(recorder, capsys, command, given, reason):
    assert main([command, "sound.wav", *given, "--out", "out.csv"]) == 2
    line = capsys.readouterr().err.splitlines()[-1]
    assert line.startswith("bushing-noise: error: ")
    assert reason in line
    assert not (recorder / "out.csv").exists()
