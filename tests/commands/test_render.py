from __future__ import annotations

import json

import numpy as np
import pytest
import soundfile

from models.condition import Condition
from models.recording import Channel, Recording
from noise.cli import main
from noise.recordings import read_recording, write_recording

RATE = 30e3
PEAK = 0.4  # Pa


@pytest.fixture
def run07(tmp_path):
    """A squeal with its torque, as the rig records it."""
    time = np.arange(6000) / RATE
    samples = np.stack([np.full(6000, 8.0), PEAK * np.sin(2 * np.pi * 1000.0 * time)])
    channels = (Channel("torque"), Channel("pressure"))
    recording = Recording(samples, RATE, channels, Condition(speed=10.0))
    return write_recording(tmp_path / "run07", recording)


def refusal(capsys, *arguments, code=2):
    assert main(["render", *map(str, arguments)]) == code
    out, err = capsys.readouterr()
    assert out == ""
    return err.splitlines()[-1].removeprefix("bushing-noise: error: ")


def test_a_recording_becomes_sound_that_reads_back_calibrated(run07, tmp_path, capsys):
    out = tmp_path / "audio" / "squeal"
    assert main(["render", str(run07), "--out", str(out)]) == 0
    written = capsys.readouterr().out.splitlines()
    assert written == [f"{out}.wav", f"{out}.json"]
    info = soundfile.info(written[0])
    assert (info.samplerate, info.subtype, info.channels) == (48000, "PCM_24", 1)
    fractions, _ = soundfile.read(written[0])
    assert 20 * np.log10(np.abs(fractions).max()) == pytest.approx(-3.0, abs=0.01)
    sound = read_recording(written[0])
    assert sound.condition == Condition(speed=10.0)
    assert np.abs(sound["pressure"]).max() == pytest.approx(PEAK, rel=2e-3)


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
        ([], "a recording, or a condition"),
        (["{run}", "--speed", "5"], "--speed describes a run to simulate"),
        (["{run}", "--converter"], "--converter describes a run to simulate"),
        (["--speed", "5", "--full-scale", "2"], "--full-scale"),
        (["{run}", "--rate", "96000"], "--rate"),
        (["{run}", "--bits", "8"], "--bits"),
        (["{run}", "--pascal-per-full-scale", "0"], "--pascal-per-full-scale"),
        (["nowhere.wav"], "nowhere.wav"),
    ],
)
def test_calls_that_make_no_sense_are_refused(run07, tmp_path, capsys, given, said):
    arguments = [part.format(run=run07) for part in given]
    assert said in refusal(capsys, *arguments, "--out", tmp_path / "s.wav")
    assert not (tmp_path / "s.wav").exists()
