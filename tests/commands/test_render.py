from __future__ import annotations

import csv
import json
import re
import sys

import numpy as np
import pytest
import soundfile

from features.kernels.levels import sound_levels
from models.condition import Condition
from models.recording import Channel, Recording
from noise.audio.gain import loudness, true_peak
from noise.cli import main
from noise.recordings import read_recording, write_recording

PASCAL_DB = 93.9794
RATE = 30e3
PEAK = 0.4  # Pa


def recorded(path, sound, rate=48e3, condition=None):
    channels = (Channel("pressure"),)
    run = Recording(np.atleast_2d(sound), rate, channels, condition or Condition())
    return write_recording(path, run)


def tone(frequency=1000.0, rms=1.0, rate=48e3, seconds=2.0):
    time = np.arange(round(seconds * rate)) / rate
    return np.sqrt(2) * rms * np.sin(2 * np.pi * frequency * time)


@pytest.fixture
def runs(tmp_path):
    """Three recordings in a folder: a tone, one 20 dB below it, and clicks."""
    clicks = np.zeros(48000)
    clicks[2000::6000] = 3.0
    recorded(tmp_path / "runs" / "loud", tone(rms=1.0, seconds=1.0))
    recorded(tmp_path / "runs" / "quiet", tone(300.0, 0.1, 30e3, 1.0), 30e3)
    recorded(tmp_path / "runs" / "day2" / "clicks", clicks)
    return tmp_path / "runs"


def rendered(*arguments, code=0):
    assert main(["render", *map(str, arguments)]) == code


def refusal(capsys, *arguments, code=2):
    assert main(["render", *map(str, arguments)]) == code
    out, err = capsys.readouterr()
    assert out == ""
    return err.splitlines()[-1].removeprefix("bushing-noise: error: ")


def table(folder):
    with (folder / "levels.csv").open(encoding="utf-8", newline="") as file:
        return {row["file"]: row for row in csv.DictReader(file)}


@pytest.fixture
def run07(tmp_path):
    """A squeal with its torque, as the rig records it."""
    time = np.arange(6000) / RATE
    samples = np.stack([np.full(6000, 8.0), PEAK * np.sin(2 * np.pi * 1000.0 * time)])
    channels = (Channel("torque"), Channel("pressure"))
    recording = Recording(samples, RATE, channels, Condition(speed=10.0))
    return write_recording(tmp_path / "run07", recording)


@pytest.mark.parametrize(("rate", "bits"), [("44100", "16"), ("48000", "24"), ("48000", "32")])
def test_one_pascal_stays_94_decibels_there_and_back(tmp_path, rate, bits):
    recorded(tmp_path / "pascal", tone(rate=30e3), 30e3)
    out = tmp_path / "sound.wav"
    given = ["--rate", rate, "--bits", bits, "--pascal-per-full-scale", "4"]
    rendered(tmp_path / "pascal.wav", "--out", out, *given)
    (part,) = json.loads(out.with_suffix(".json").read_text())["parts"]
    for told in ("level_db", "level_dba", "l_afmax_dba"):
        assert part[told] == pytest.approx(PASCAL_DB, abs=0.05)
    assert part["third_octaves_db"]["1000"] == pytest.approx(PASCAL_DB, abs=0.05)
    back = read_recording(out)
    assert sound_levels(back["pressure"], back.rate).level == pytest.approx(PASCAL_DB, abs=0.05)
    samples, _ = soundfile.read(out)
    in_file = 20 * np.log10(samples.std())
    assert in_file == pytest.approx(PASCAL_DB - 20 * np.log10(4 / 2e-5), abs=0.05)
    assert part["level_dbfs"] == pytest.approx(in_file, abs=0.05)


def test_one_gain_keeps_how_loud_the_sounds_of_a_set_are_to_each_other(runs, tmp_path, capsys):
    out = tmp_path / "set"
    rendered(runs, "--out", out)
    names = ["day2/clicks.wav", "loud.wav", "quiet.wav"]
    rows = table(out)
    assert list(rows) == names
    written = capsys.readouterr().out.splitlines()
    assert written[-1] == str(out / "levels.csv")
    assert [str(out / name) for name in names] == written[:-1:2]
    heard = {name: soundfile.read(out / name)[0] for name in names}
    for name, samples in heard.items():
        before = read_recording(runs / name)["pressure"]
        assert np.abs(samples).max() < 1.0
        in_file, in_air = 20 * np.log10(samples.std()), 20 * np.log10(before.std() / 2e-5)
        full_scale = float(rows[name]["full_scale_Pa"])
        assert in_file + 20 * np.log10(full_scale / 2e-5) == pytest.approx(in_air, abs=0.1)
        assert float(rows[name]["level_db"]) == pytest.approx(in_air, abs=0.01)
        assert rows[name]["gain"] == "common"
    assert len({row["full_scale_Pa"] for row in rows.values()}) == 1
    loudest = max(true_peak(samples, 48000) for samples in heard.values())
    assert 20 * np.log10(loudest) == pytest.approx(-3.0, abs=0.01)


def test_matched_sounds_are_equally_loud_and_their_peaks_hold_the_limit(runs, tmp_path):
    out = tmp_path / "set"
    rendered(runs, "--match-loudness", "--bits", "16", "--out", out)
    told = table(out)
    heard = {name: soundfile.read(out / name)[0] for name in told}
    loudnesses = [loudness(samples, 48000) for samples in heard.values()]
    assert np.ptp(loudnesses) < 0.2
    assert max(loudnesses) < -22.9
    for name, samples in heard.items():
        assert true_peak(samples, 48000) <= 10 ** (-0.95 / 20)
        assert float(told[name]["loudness_lufs"]) == pytest.approx(loudnesses[0], abs=0.1)
    # Each file keeps a calibration of its own, so its level in the air can still be told.
    read = read_recording(out / "quiet.wav")
    assert sound_levels(read["pressure"], read.rate).level == pytest.approx(PASCAL_DB - 20, abs=0.1)


def test_a_bad_file_is_a_row_and_the_others_are_rendered(runs, tmp_path, capsys):
    (runs / "broken.wav").write_bytes(b"RIFF no sound")
    write_recording(runs / "torque", Recording(np.ones((1, 480)), 3e4, (Channel("torque"),)))
    out = tmp_path / "set"
    rendered(runs, "--out", out, code=1)
    rows = table(out)
    assert len(rows) == 5
    assert rows["broken.wav"]["error"]
    assert "no pressure channel" in rows["torque.wav"]["error"]
    assert rows["loud.wav"]["error"] == ""
    assert len(list(out.rglob("*.wav"))) == 3
    err = capsys.readouterr().err
    assert err.count("refused: ") == 2


def test_a_damaged_recording_alone_is_refused_with_code_1(tmp_path, capsys):
    (tmp_path / "broken.wav").write_bytes(b"RIFF no sound")
    rendered(tmp_path / "broken.wav", "--out", tmp_path / "s.wav", code=1)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "refused: " in captured.err
    assert "broken.wav" in captured.err
    assert not (tmp_path / "s.wav").exists()


def test_without_calibration_levels_are_told_re_full_scale(tmp_path, capsys):
    plain, out = tmp_path / "phone.flac", tmp_path / "s.wav"
    soundfile.write(plain, 0.5 * np.sin(np.arange(48000) / 8), 48000)
    rendered(plain, "--out", out)
    err = capsys.readouterr().err
    assert "dBFS only" in err
    assert "re 20 uPa" not in err
    (part,) = json.loads(out.with_suffix(".json").read_text())["parts"]
    assert part["level_dbfs"] == pytest.approx(-6.0, abs=0.05)  # peak at -3, a sine's rms
    assert not {"level_db", "level_dba", "third_octaves_db"} & set(part)
    assert part["third_octaves_dbfs"]["1000"] == pytest.approx(-6.0, abs=0.1)


def test_sound_quality_is_told_with_the_extra_alone(tmp_path, capsys, monkeypatch):
    pytest.importorskip("mosqito")
    path, out = recorded(tmp_path / "tone", tone(rms=2e-3, seconds=0.5)), tmp_path / "s.wav"
    rendered(path, "--sound-quality", "--out", out)
    (part,) = json.loads(out.with_suffix(".json").read_text())["parts"]
    assert part["loudness_sone"] == pytest.approx(1.0, abs=0.05)
    assert "sone" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "mosqito", None)
    line = refusal(capsys, path, "--sound-quality", "--out", out)
    assert 'pip install "bushing-noise[sound-quality]"' in line


@pytest.mark.parametrize(("bits", "subtype"), [("16", "PCM_16"), ("32", "FLOAT")])
def test_rate_size_and_level_are_those_asked_for(run07, tmp_path, bits, subtype):
    out = tmp_path / "s.wav"
    given = ["--rate", "44100", "--bits", bits, "--pascal-per-full-scale", "2"]
    assert main(["render", str(run07), "--out", str(out), *given]) == 0
    info = soundfile.info(out)
    assert (info.samplerate, info.subtype) == (44100, subtype)
    assert np.abs(soundfile.read(out)[0]).max() == pytest.approx(PEAK / 2, rel=2e-3)


def test_what_would_clip_is_refused_with_the_level_that_would_not(run07, tmp_path, capsys):
    out = tmp_path / "s.wav"
    line = refusal(capsys, run07, "--out", out, "--pascal-per-full-scale", "0.1")
    assert "would clip" in line
    assert not out.exists()
    least = line.split()[-1]
    given = [str(run07), "--out", str(out), "--pascal-per-full-scale", least]
    assert main(["render", *given]) == 0
    assert np.abs(soundfile.read(out)[0]).max() > 0.99


def test_a_plain_sound_file_stays_without_calibration_unless_it_is_given(tmp_path, capsys):
    plain, out = tmp_path / "phone.flac", tmp_path / "s.wav"
    soundfile.write(plain, 0.5 * np.sin(np.arange(4800.0)), 48000)
    assert main(["render", str(plain), "--out", str(out)]) == 0
    assert "not calibrated" in capsys.readouterr().err
    assert json.loads(out.with_suffix(".json").read_text())["calibrated"] is False
    line = refusal(capsys, plain, "--out", out, "--pascal-per-full-scale", "2")
    assert "phone.flac" in line
    assert "--full-scale" in line
    given = ["--full-scale", "4", "--pascal-per-full-scale", "8"]
    assert main(["render", str(plain), "--out", str(out), *given]) == 0
    assert np.abs(read_recording(out)["pressure"]).max() == pytest.approx(2.0, rel=1e-3)


def test_a_recording_sampled_too_slowly_to_be_heard_is_refused_alone_and_in_a_set(tmp_path, capsys):
    slow, heard = tmp_path / "slow.wav", tmp_path / "heard.wav"
    soundfile.write(slow, np.sin(np.arange(300.0)), 39)
    soundfile.write(heard, np.sin(np.arange(4800.0)), 48000)
    assert "sampled at 39 Hz" in refusal(capsys, slow, "--out", tmp_path / "s.wav", code=1)
    assert main(["render", str(slow), str(heard), "--out", str(tmp_path / "set")]) == 1
    assert (tmp_path / "set" / "heard.wav").exists()


@pytest.mark.parametrize("name", ["run07", "run07.wav", "../{folder}/run07.wav"])
def test_the_recording_itself_is_never_overwritten(run07, capsys, monkeypatch, name):
    monkeypatch.chdir(run07.parent)
    before = run07.read_bytes()
    line = refusal(capsys, "run07.wav", "--out", name.format(folder=run07.parent.name))
    assert "would overwrite" in line
    assert run07.read_bytes() == before


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["{runs}", "--out", "{tmp}/s.wav"], "3 sounds are no single file"),
        (["{runs}", "--out", "{tmp}/file.txt"], "is a file; name a folder"),
        (["{runs}", "--out", "{runs}"], "would overwrite"),
        (["{runs}/loud.wav", "--ab", "--out", "{tmp}/s.wav"], "give a second one"),
        (["{runs}", "--ab", "--match-loudness", "--out", "{tmp}/s.wav"], "--match-loudness"),
        (["{runs}/loud.wav", "--gap", "-1", "--out", "{tmp}/s.wav"], "--gap"),
        (["--speed 5 --pitch 3", "--out", "{tmp}/s.wav"], "--pitch"),
        (["", "--out", "{tmp}/s.wav"], "INPUT is empty"),
        (["--speed fast", "--out", "{tmp}/s.wav"], "--speed"),
        (["--interference 0.3", "--out", "{tmp}/s.wav"], "--speed and --oscillate"),
        (["{tmp}/none.toml", "--speed", "5", "--out", "{tmp}/s.wav"], "none.toml"),
        (["{tmp}/none.toml", "--rig", "x.toml", "--speed", "5", "--out", "{tmp}/s"], "rig files"),
        (["{runs}", "{tmp}/phone.wav", "--out", "{tmp}/set"], "is not, so one gain cannot"),
        (
            ["{runs}", "--match-loudness", "--pascal-per-full-scale", "2", "--out", "{tmp}/set"],
            "not allowed with",
        ),
        (["--out", "{tmp}/s.wav"], "a recording, or a condition"),
        (
            ["{runs}/loud.wav", "--speed", "5", "--out", "{tmp}/s.wav"],
            "--speed describes",
        ),
        (
            ["{runs}/loud.wav", "--converter", "--out", "{tmp}/s.wav"],
            "--converter describes",
        ),
        (["--speed", "5", "--full-scale", "2", "--out", "{tmp}/s.wav"], "--full-scale"),
        (["{runs}/loud.wav", "--rate", "96000", "--out", "{tmp}/s.wav"], "--rate"),
        (["{runs}/loud.wav", "--bits", "8", "--out", "{tmp}/s.wav"], "--bits"),
        (
            ["{runs}/loud.wav", "--pascal-per-full-scale", "0", "--out", "{tmp}/s.wav"],
            "--pascal-per-full-scale",
        ),
        (["nowhere.wav", "--out", "{tmp}/s.wav"], "nowhere.wav"),
    ],
)
def test_calls_that_make_no_sense_are_refused(runs, tmp_path, capsys, given, said):
    (tmp_path / "file.txt").write_text("notes")
    soundfile.write(tmp_path / "phone.wav", np.sin(np.arange(4800.0)), 48000)
    assert said in refusal(capsys, *(part.format(runs=runs, tmp=tmp_path) for part in given))
    assert not (tmp_path / "s.wav").exists()
    assert not (tmp_path / "set").exists()


def faint_lines(capsys):
    err = capsys.readouterr().err.splitlines()
    return [line for line in err if "nearly inaudible" in line]


@pytest.fixture
def faint(tmp_path):
    """A set of which one sound is near a rig's squawk, one 40 dB louder."""
    recorded(tmp_path / "faint" / "squawk", tone(rms=0.03))
    recorded(tmp_path / "faint" / "loud", tone(rms=3.0))
    return tmp_path / "faint"


def test_a_calibrated_set_says_what_of_it_can_hardly_be_heard(faint, tmp_path, capsys):
    out = tmp_path / "set"
    rendered(faint, "--pascal-per-full-scale", "20", "--out", out)
    (line,) = faint_lines(capsys)
    in_air = 20 * np.log10(0.03 / 2e-5)
    in_file = 20 * np.log10(soundfile.read(out / "squawk.wav")[0].std())
    levels = re.search(r"squawk \((.*) dB\(A\) at the microphone, (.*) dBFS\(A\) in the file", line)
    assert [float(level) for level in levels.groups()] == pytest.approx([in_air, in_file], abs=0.2)
    assert "calibrated to 20 Pa" in line
    assert "loud (" not in line
    rows = table(out)
    assert "nearly inaudible" in rows["squawk.wav"]["note"]
    assert rows["loud.wav"]["note"] == ""
    told = json.loads((out / "squawk.json").read_text(encoding="utf-8"))["render"]["note"]
    assert told == rows["squawk.wav"]["note"]
    assert "note" not in json.loads((out / "loud.json").read_text(encoding="utf-8"))["render"]


PLAIN_RIG = """
name = "plain"
material = "our rubber"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = {torque}
kinetic_torque_Nm = 8.0
damping_Nms_rad = 0.09
"""


def test_two_rig_files_are_heard_back_to_back_at_one_gain(tmp_path):
    for name, torque in (("old", 10.7), ("new", 8.5)):
        (tmp_path / f"{name}.toml").write_text(PLAIN_RIG.format(torque=torque))
    out = tmp_path / "ab.wav"
    rigs = [tmp_path / "old.toml", tmp_path / "new.toml"]
    given = ["--speed", "2", "--seconds", "0.5", "--gap", "0.25"]
    rendered("--ab", *rigs, *given, "--out", out)
    about = json.loads(out.with_suffix(".json").read_text())
    assert [part["name"] for part in about["parts"]] == ["old", "new"]
    assert [part["start_s"] for part in about["parts"]] == [0.0, 0.75]
    assert [part["conditions"]["material"] for part in about["parts"]] == ["our rubber"] * 2
    heard = read_recording(out)
    assert heard.duration == pytest.approx(1.25)
    assert heard.condition.speed == 2.0
    parts = heard["pressure"][:24000], heard["pressure"][36000:]
    told = about["parts"][0]["level_db"] - about["parts"][1]["level_db"]
    found = 20 * np.log10(parts[0].std() / parts[1].std())
    assert found == pytest.approx(told, abs=0.1)
    assert abs(told) > 1.0


def test_recordings_and_conditions_in_quotes_can_be_compared(tmp_path):
    tone = 0.1 * np.sin(2 * np.pi * 1000 * np.arange(24000) / 48e3)[np.newaxis]
    write_recording(tmp_path / "measured", Recording(tone, 48e3, (Channel("pressure"),)))
    out = tmp_path / "ab"
    condition = "--interference 0.381 --material PDMS"
    given = ["--speed", "5", "--seconds", "0.2"]
    rendered("--ab", tmp_path / "measured.wav", condition, *given, "--out", out)
    parts = json.loads((tmp_path / "ab.json").read_text())["parts"]
    simulated = "interference-0.381-material-PDMS"
    assert [part["name"] for part in parts] == ["measured.wav", simulated]
