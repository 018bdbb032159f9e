"""``render``: levels there and back, gains of a set, what is refused and what is noted."""

import json
import re

import numpy as np
import pytest
import soundfile

from features.kernels.weighting import sound_levels
from models.recording import Channel, Recording
from noise.audio.gain import loudness, true_peak
from noise.base.labels import LABELS
from noise.cli import main
from noise.recordings import read_recording, write_recording
from tests.helpers.files import csv_rows, pressure_file
from tests.helpers.small_rigs import RIG_FILE

PASCAL_DB = 93.9794


def tone(frequency=1000.0, rms=1.0, rate=48e3, seconds=1.0):
    time = np.arange(round(seconds * rate)) / rate
    return np.sqrt(2) * rms * np.sin(2 * np.pi * frequency * time)


@pytest.fixture
def runs(tmp_path):
    """Three recordings in a folder: a tone, one 20 dB below it, and clicks."""
    clicks = np.zeros(48000)
    clicks[2000::6000] = 3.0
    pressure_file(tmp_path / "runs" / "loud", tone())
    pressure_file(tmp_path / "runs" / "quiet", tone(300.0, 0.1, 30e3), 30e3)
    pressure_file(tmp_path / "runs" / "day2" / "clicks", clicks)
    return tmp_path / "runs"


def render(*arguments, code=0):
    assert main(["render", *map(str, arguments)]) == code


def table(folder):
    return {row["file"]: row for row in csv_rows(folder / "levels.csv")}


def sidecar(path):
    return json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))


def test_one_pascal_stays_94_decibels_there_and_back(tmp_path):
    pressure_file(tmp_path / "pascal", tone(rate=30e3, seconds=2.0), 30e3)
    out = tmp_path / "sound.wav"
    render(tmp_path / "pascal.wav", "--out", out, "--pascal-per-full-scale", "4")
    info = soundfile.info(out)
    assert (info.samplerate, info.subtype) == (48_000, "PCM_24")
    (part,) = sidecar(out)["parts"]
    for level in ("level_db", "level_dba", "l_afmax_dba"):
        assert part[level] == pytest.approx(PASCAL_DB, abs=0.05)
    assert part["third_octaves_db"]["1000"] == pytest.approx(PASCAL_DB, abs=0.05)
    back = read_recording(out)
    assert sound_levels(back["pressure"], back.rate).level == pytest.approx(PASCAL_DB, abs=0.05)
    in_file = 20 * np.log10(soundfile.read(out)[0].std())
    assert in_file == pytest.approx(PASCAL_DB - 20 * np.log10(4 / 2e-5), abs=0.05)
    assert part["level_dbfs"] == pytest.approx(in_file, abs=0.05)


def test_one_gain_keeps_how_loud_the_sounds_of_a_set_are_and_a_bad_file_is_a_row(runs, capsys):
    (runs / "broken.wav").write_bytes(b"RIFF no sound")
    write_recording(runs / "torque", Recording(np.ones((1, 480)), 3e4, (Channel("torque"),)))
    soundfile.write(runs / "slow.wav", np.sin(np.arange(300.0)), 39)
    out = runs.parent / "set"
    render(runs, "--out", out, code=1)
    rows = table(out)
    names = ["day2/clicks.wav", "loud.wav", "quiet.wav"]
    assert [*rows] == ["broken.wav", *names, "slow.wav", "torque.wav"]
    assert rows["broken.wav"]["error"]
    assert "sampled at 39 Hz" in rows["slow.wav"]["error"]
    assert "no pressure channel" in rows["torque.wav"]["error"]
    printed, err = capsys.readouterr()
    assert err.count("refused: ") == 3
    for name in names:  # named by the classifier, with the level that tables have
        stem = re.escape(name.removesuffix(".wav"))
        assert re.search(rf"{stem}: ({'|'.join(LABELS)}), .*\d dB\(A\), L_AFmax", err), err
    assert [str(out / name) for name in names] == printed.splitlines()[:-1:2]
    assert printed.splitlines()[-1] == str(out / "levels.csv")
    sounds = {name: soundfile.read(out / name)[0] for name in names}
    assert len({rows[name]["full_scale_Pa"] for name in names}) == 1
    for name, samples in sounds.items():
        in_air = 20 * np.log10(read_recording(runs / name)["pressure"].std() / 2e-5)
        in_file, full_scale = 20 * np.log10(samples.std()), float(rows[name]["full_scale_Pa"])
        assert in_file + 20 * np.log10(full_scale / 2e-5) == pytest.approx(in_air, abs=0.1)
        assert float(rows[name]["level_db"]) == pytest.approx(in_air, abs=0.01)
        assert rows[name]["gain"] == "common"
    loudest = max(true_peak(samples, 48000) for samples in sounds.values())
    assert 20 * np.log10(loudest) == pytest.approx(-3.0, abs=0.01)


def test_matched_sounds_are_equally_loud_and_their_peaks_hold_the_limit(runs, tmp_path):
    out = tmp_path / "set"
    render(runs, "--match-loudness", "--out", out)
    rows = table(out)
    sounds = {name: soundfile.read(out / name)[0] for name in rows}
    loudnesses = [loudness(samples, 48000) for samples in sounds.values()]
    assert np.ptp(loudnesses) < 0.2
    assert max(loudnesses) < -22.9
    for name, samples in sounds.items():
        assert true_peak(samples, 48000) <= 10 ** (-0.95 / 20)
        assert float(rows[name]["loudness_lufs"]) == pytest.approx(loudnesses[0], abs=0.1)
    # Each file keeps a calibration of its own, so its level in the air can still be told.
    read = read_recording(out / "quiet.wav")
    assert sound_levels(read["pressure"], read.rate).level == pytest.approx(PASCAL_DB - 20, abs=0.1)


def test_a_damaged_recording_alone_is_refused_with_code_1(tmp_path, capsys):
    (tmp_path / "broken.wav").write_bytes(b"RIFF no sound")
    render(tmp_path / "broken.wav", "--out", tmp_path / "s.wav", code=1)
    out, err = capsys.readouterr()
    assert out == ""
    assert "refused: " in err
    assert "broken.wav" in err
    assert not (tmp_path / "s.wav").exists()


def test_without_calibration_levels_are_told_re_full_scale(tmp_path, capsys):
    plain, out = tmp_path / "phone.flac", tmp_path / "s.wav"
    soundfile.write(plain, 0.5 * np.sin(np.arange(48000) / 8), 48000)
    render(plain, "--out", out)
    err = capsys.readouterr().err
    assert "not calibrated" in err
    assert "re 20 uPa" not in err
    assert sidecar(out)["calibrated"] is False
    (part,) = sidecar(out)["parts"]
    assert part["level_dbfs"] == pytest.approx(-6.0, abs=0.05)  # peak at -3, a sine's rms
    assert not {"level_db", "level_dba", "third_octaves_db"} & set(part)
    render(plain, "--out", out, "--full-scale", "4", "--pascal-per-full-scale", "8")
    assert np.abs(read_recording(out)["pressure"]).max() == pytest.approx(2.0, rel=1e-3)


def test_rig_files_conditions_and_recordings_are_heard_back_to_back_at_one_gain(tmp_path):
    for name, torque in (("old", 10.7), ("new", 8.5)):
        text = RIG_FILE.replace("10.7", str(torque)).replace("fluorocarbon", "our rubber")
        (tmp_path / f"{name}.toml").write_text(text)
    measured = pressure_file(tmp_path / "measured", 0.1 * tone(seconds=0.5))
    out = tmp_path / "ab.wav"
    inputs = [tmp_path / "old.toml", tmp_path / "new.toml", "PDMS"]
    given = ["--speed", "2", "--seconds", "0.5", "--gap", "0.25"]
    render("--ab", *inputs, measured, *given, "--out", out)
    parts = sidecar(out)["parts"]
    assert [part["name"] for part in parts] == ["old", "new", "PDMS", "measured.wav"]
    assert [part["start_s"] for part in parts] == [0.0, 0.75, 1.5, 2.25]
    assert [part["conditions"]["material"] for part in parts[:2]] == ["our rubber"] * 2
    heard = read_recording(out)
    assert heard.duration == pytest.approx(2.75)
    one, other = heard["pressure"][:24000], heard["pressure"][36000:60000]
    told = parts[0]["level_db"] - parts[1]["level_db"]
    assert 20 * np.log10(one.std() / other.std()) == pytest.approx(told, abs=0.1)
    assert abs(told) > 1.0


def test_a_sound_of_two_tracks_is_said_to_be_rendered_by_one(tmp_path, capsys):
    soundfile.write(
        tmp_path / "two.wav", np.stack([0.1 * tone(), 0.1 * tone(300.0)], axis=1), 48_000
    )
    render(tmp_path / "two.wav", "--out", tmp_path / "sound.wav")
    assert capsys.readouterr().err.count("two.wav: 1 of 2 channels of sound pressure") == 1
