from __future__ import annotations

import math

import pytest
from hypothesis import given, strategies as st

from noise.recordings.meaning import stated_full_scale


@pytest.mark.parametrize(
    ("text", "level"),
    [
        ("2019-10-17_SLM_012_Audio_FS129.9dB(PK)_00.wav", 129.9),
        ("FS133.0dB(PK).wav", 133.0),
        ("run_fs94dB_PK_.wav", 94.0),
        ("run FS117,8 dB(PK)", 117.8),
        ("Sound: 0dBFS = 109.7 dBSPL Time Zone: UTC-06:00 (DST)", 109.7),
        ("0 dBFS=94 dB SPL", 94.0),
    ],
)
def test_a_level_is_that_of_the_peak_at_full_scale(text, level):
    found = stated_full_scale(text)
    assert found.kind == "pressure"
    assert 20 * math.log10(found.value / 20e-6) == pytest.approx(level, abs=1e-9)


@pytest.mark.parametrize("unit", ["mps2", "m/s2", "m/s^2", "m/s²"])
def test_a_vibration_meter_states_an_acceleration(unit):
    found = stated_full_scale(f"Vibration: 0dBFS = 2.40 {unit} Time Zone: UTC-09:00")
    assert (found.kind, found.value) == ("acceleration", 2.4)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "run07.wav",
        "OFFS94.0dB(PK).wav",
        "FS94.0dB(PKW).wav",
        "FS48000.wav",
        "FS99999dB(PK)",
        "0dBFS = 0 mps2",
        "0dBFS = -3 mps2",
        "-10dBFS = SPL",
        "0dBFS = 94 dBSPLASH",
    ],
)
def test_other_texts_state_nothing(text):
    assert stated_full_scale(text) is None


@given(st.text(alphabet="0dBFSPKL =().,-_9mps2²", max_size=40))
def test_whatever_is_found_is_a_positive_number(text):
    found = stated_full_scale(text)
    assert found is None or 0 < found.value < math.inf
