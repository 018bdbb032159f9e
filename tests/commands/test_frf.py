"""The command frf from hits to files."""

import csv
import io
import os
from pathlib import Path

import numpy as np
import pytest

from models.condition import Condition
from models.radiation.impulse_responses import convolve
from models.recording import Channel, Recording
from models.structure.modal import ModalModel
from models.transfer_functions.files import read_transfer_function
from noise.cli import main
from noise.recordings import write_recording
from tests.helpers.files import csv_rows

RATE = 16000
N = 16000
FREQUENCY = np.array([180.0, 620.0, 1500.0, 2900.0])
DAMPING = np.array([0.01, 0.008, 0.006, 0.005])
STRUCTURE = ModalModel(
    FREQUENCY,
    DAMPING,
    np.ones((4, 1)),
    np.zeros((1, 4)),
    np.array([[1.0, -0.7, 0.8, 0.6]]),
    np.zeros((1, 1)),
)
IMPULSE = STRUCTURE.impulse_response(RATE, N)[0, 0]
TIME = np.arange(N) / RATE


def hit(rng, double=0.0):
    force = np.zeros(N)
    pulse = np.sin(np.pi * np.arange(0.4, 6) / 6)
    force[10:16] = rng.uniform(50, 90) * pulse
    force[400:406] += double * 80 * pulse
    response = convolve(force, IMPULSE)
    noise = 0.002 * np.abs(response).max()
    return force + 0.01 * rng.standard_normal(N), response + noise * rng.standard_normal(N)


@pytest.fixture
def hits(tmp_path, monkeypatch):
    """Four hits: rows of an NPY, columns of an NPY, CSV, a recording."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(0)
    np.save("rows.npy", np.stack([TIME, *hit(rng)]))
    np.save("columns.npy", np.stack([TIME, *hit(rng)], axis=1))
    np.savetxt("hit.csv", np.stack([TIME, *hit(rng)], axis=1), delimiter=",", header="t,F,a")
    channels = (Channel("acceleration"), Channel("force"))
    write_recording("run", Recording(np.stack(hit(rng)[::-1]), RATE, channels, Condition()))
    return ["rows.npy", "columns.npy", "hit.csv", "run.wav"]


def test_hits_of_every_kind_give_the_response_to_a_torque(hits, capsys):
    out = Path("new") / "beam.uff"
    assert main(["frf", *hits, "--arm", "0.05", "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}\n"
    frf = read_transfer_function(out, input_unit="N m", output_unit="m/s^2")
    assert (frf.input_unit, frf.output_unit) == ("N m", "m/s^2")
    band = (frf.frequencies > 100) & (frf.frequencies < 1800)
    true = STRUCTURE.frequency_response(frf.frequencies[band])[0, 0] / 0.05
    difference = 20 * np.log10(np.abs(frf.response[band] / true))
    assert np.median(np.abs(difference)) < 0.3
    assert np.median(frf.coherence[band]) > 0.99


def test_modes_of_the_structure_are_found(hits):
    assert main(["frf", *hits, "--modes", "modes.csv", "--band", "100..3500"]) == 0
    rows = csv_rows("modes.csv")
    frequency = np.array([float(row["frequency_hz"]) for row in rows])
    damping = np.array([float(row["damping_ratio"]) for row in rows])
    strong = np.array([float(row["peak"]) for row in rows]) > 5
    np.testing.assert_allclose(frequency[strong], FREQUENCY, rtol=2e-3)
    np.testing.assert_allclose(damping[strong], DAMPING, rtol=0.1)


def test_a_call_says_what_it_averages_and_how_far_that_is_to_be_trusted(hits, capsys):
    np.save("short.npy", np.load(hits[0])[:, :12000])
    assert main(["frf", *hits, "short.npy"]) == 0
    out, err = capsys.readouterr()
    rows = list(csv.DictReader(io.StringIO(out)))
    assert list(rows[0]) == ["frequency_hz", "real", "imag", "coherence"]
    assert len(rows) == 6001
    assert "cut to the shortest, 12000 samples" in err
    assert "coherence is below 0.8 in " in err
    sound = np.stack(hit(np.random.default_rng(4)))
    write_recording("sound", Recording(sound, RATE, (Channel("force"), Channel("pressure_2"))))
    assert main(["frf", "sound.wav", "--response", "pressure_2", "--out", "sound.npz"]) == 0
    assert "a single hit has no coherence" in capsys.readouterr().err
    written = np.load("sound.npz")
    assert "coherence" not in written.files
    assert written["output_unit"] == "Pa"
    assert main(["frf", "sound.wav", "--response", "speed", "--out", "speed.npz"]) == 1
    assert not Path("speed.npz").exists()


def test_bad_hits_are_named_and_the_others_averaged(hits, capsys):
    rng = np.random.default_rng(1)
    force, response = hit(rng, double=0.5)
    np.save("double.npy", np.stack([TIME, force, response]))
    force, response = hit(rng)
    np.save("clipped.npy", np.stack([TIME, np.minimum(force, 30.0), response]))
    np.save("slower.npy", np.stack([2 * TIME, force, response]))
    Path("broken.npy").write_bytes(b"no numbers")
    bad = ["double.npy", "clipped.npy", "slower.npy", "broken.npy"]
    assert main(["frf", *hits, *bad, "--out", "beam.npz"]) == 1
    told = capsys.readouterr().err
    assert "refused: double.npy: double hit" in told
    assert "refused: clipped.npy: force is clipped" in told
    assert "refused: slower.npy: is sampled at 8000 Hz" in told
    assert "refused: broken.npy: is damaged" in told
    assert "4 hits averaged, 4 refused" in told
    assert Path("beam.npz").is_file()


def ringing_on(rng, zeta=0.0005, seconds=0.5):
    """Hit on a mode of 400 Hz and 2 kg that is far from its end when the record is."""
    n, w0 = int(RATE * seconds), 2 * np.pi * 400.0
    force = np.zeros(n)
    force[160:172] = rng.uniform(50, 90) * np.sin(np.pi * (np.arange(12) + 0.5) / 12)
    w = 2 * np.pi * np.fft.rfftfreq(16 * n, 1 / RATE)
    h = -(w**2) / 2 / (w0**2 - w**2 + 2j * zeta * w0 * w)
    response = np.fft.irfft(np.fft.rfft(force, 16 * n) * h, 16 * n)[:n]
    noise = 1e-4 * np.abs(response).max() * rng.standard_normal(n)
    return np.stack([np.arange(n) / RATE, force, response + noise])


def test_a_response_that_has_not_died_away_is_noted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(0)
    for number in range(3):
        np.save(f"hit-{number}.npy", ringing_on(rng))
    files = [f"hit-{number}.npy" for number in range(3)]
    assert main(["frf", *files, "--modes", "modes.csv"]) == 0
    assert "of a response has not died away" in capsys.readouterr().err


@pytest.mark.parametrize("n_hits", [1, 4])
def test_what_noise_makes_at_a_null_of_the_force_is_no_mode(tmp_path, monkeypatch, n_hits):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(0)
    for number in range(n_hits):
        np.save(f"hit-{number}.npy", ringing_on(rng, zeta=0.01))
    files = [f"hit-{number}.npy" for number in range(n_hits)]
    assert main(["frf", *files, "--modes", "modes.csv"]) == 0
    modes = csv_rows("modes.csv")
    null = 1.5 * RATE / 12
    assert not [m for m in modes if abs(float(m["frequency_hz"]) / null - 1) < 0.03]
    assert [m for m in modes if abs(float(m["frequency_hz"]) / 400 - 1) < 0.002]
    assert all(m["coherence"] in ("", "nan") or float(m["coherence"]) >= 0.8 for m in modes)


DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")
REAL = pytest.mark.skipif(
    not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings"
)


def real_hits():
    return sorted(str(path) for path in (Path(DATA) / "hammer").glob("*.npy"))


@REAL
def test_real_hits_cohere_and_have_their_modes(tmp_path):
    out, modes = tmp_path / "beam.uff", tmp_path / "modes.csv"
    assert main(["frf", *real_hits(), "--out", str(out), "--modes", str(modes)]) == 0
    frf = read_transfer_function(out, input_unit="N", output_unit="m/s^2")
    band = (frf.frequencies >= 100) & (frf.frequencies <= 5000)
    assert np.median(frf.coherence[band]) > 0.998
    found = np.array([float(row["frequency_hz"]) for row in csv_rows(modes)])
    for mode in (810, 900, 2640, 3669, 4128, 4163):
        assert np.abs(found / mode - 1).min() < 0.005
