"""Bands to listen to: what they keep, what they take out, and that they shift nothing."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.audio.sound import in_band, pressure_recording
from noise.cli import main
from noise.recordings import write_recording

RATE = 48_000
TIME = np.arange(2 * RATE) / RATE
INSIDE = slice(RATE // 2, -RATE // 2)


def tone(frequency):
    return np.sqrt(2.0) * np.sin(2.0 * np.pi * frequency * TIME)


def left(band, frequency):
    """Level of a tone in a band, over that before [dB]."""
    kept = in_band(tone(frequency), float(RATE), band)[INSIDE]
    return 20.0 * np.log10(np.sqrt(np.mean(kept**2)) + 1e-12)


@settings(max_examples=20)
@given(st.floats(50.0, 2000.0), st.floats(1.5, 8.0))
def test_a_band_keeps_what_lies_in_it_is_6_db_down_at_its_ends_and_takes_out_the_rest(low, ratio):
    band = (low, low * ratio)
    assert left(band, low * np.sqrt(ratio)) == pytest.approx(0.0, abs=1.5)
    assert left(band, low) == pytest.approx(-6.0, abs=0.3)
    assert left(band, low * ratio) == pytest.approx(-6.0, abs=0.3)
    assert left(band, low / 2.0) < -40.0


def test_a_slip_stays_where_it_was():
    click = np.zeros(RATE)
    click[RATE // 2] = 1.0
    kept = in_band(click, float(RATE), (200.0, 4000.0))
    assert int(np.argmax(np.abs(kept))) == RATE // 2
    before, after = kept[RATE // 2 - 9999 : RATE // 2], kept[RATE // 2 + 1 : RATE // 2 + 10000]
    assert before[::-1] == pytest.approx(after, abs=1e-6)


def test_a_frequency_beyond_the_recording_is_refused_by_its_name():
    hiss = Recording(np.zeros((1, 100)), 8000.0, (Channel("pressure"),), name="run07")
    with pytest.raises(ParameterError, match=r"run07: a filter at 4000 Hz .* stay below 4000 Hz"):
        pressure_recording(hiss, (200.0, 4000.0))


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    sound = tone(100.0) + tone(974.0)
    write_recording(tmp_path / "run", Recording(sound[None], float(RATE), (Channel("pressure"),)))
    return tmp_path


def test_render_tells_what_the_filter_takes_away_and_levels_of_what_is_left(run):
    assert main(["render", "run.wav", "--band", "500..2000", "--out", "band.wav"]) == 0
    words = "500 to 2000 Hz, zero-phase; 3.0 dB below the whole sound"
    told = json.loads(Path("band.json").read_text())
    (part,) = told["parts"]
    assert part["level_db"] == pytest.approx(93.98, abs=0.05)
    assert part["notes"] == [f"filtered: {words}"]
