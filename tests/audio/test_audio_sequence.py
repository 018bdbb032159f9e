"""Recordings behind one another in one sound."""

from __future__ import annotations

import json

import numpy as np
import pytest

from models.condition import FIXED, Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.audio.render import FullScale, joined, measure, render

RATE = 48000


def run(name, amplitude, *, rate=RATE, seconds=0.5, condition=None, calibrated=True):
    time = np.arange(round(seconds * rate)) / rate
    samples = amplitude * np.sin(2 * np.pi * 1000 * time)[np.newaxis]
    known = condition or Condition()
    return Recording(samples, rate, (Channel("pressure"),), known, calibrated, name)


def test_parts_keep_their_loudness_and_the_gap_is_silent():
    samples, times = joined([run("A", 1.0), run("B", 0.25, rate=30e3)], RATE, gap=0.2)
    assert times == [(0.0, 0.5), pytest.approx((0.7, 1.2))]
    heard = [samples[round(start * RATE) : round(end * RATE)] for start, end in times]
    levels = [20 * np.log10(part[2400:-2400].std()) for part in heard]
    assert levels[0] - levels[1] == pytest.approx(20 * np.log10(4), abs=0.01)
    assert not samples[round(0.5 * RATE) : round(0.7 * RATE)].any()


def test_each_part_is_faded_by_itself():
    samples, _ = joined([run("A", 1.0), run("B", 1.0)], RATE, gap=0.0, fade=0.05)
    assert np.abs(samples[RATE // 2 - 480 : RATE // 2 + 480]).max() < 0.15


def test_the_whole_knows_what_holds_for_all_parts(tmp_path):
    a = Condition(speed=5.0, interference=0.279e-3, support_stiffness=FIXED, material="PDMS")
    b = Condition(speed=5.0, interference=0.381e-3, support_stiffness=FIXED)
    runs = [run("A", 1, condition=a), run("B", 1, condition=b)]
    render(tmp_path / "ab.wav", runs, measure(runs), FullScale(2.0, "common"))
    about = json.loads((tmp_path / "ab.json").read_text())
    assert about["conditions"] == {"speed_rad_s": 5.0, "support_stiffness_Nm_rad": None}
    assert [part["conditions"]["interference_mm"] for part in about["parts"]] == [0.279, 0.381]


def test_calibrated_and_uncalibrated_sounds_share_no_gain():
    with pytest.raises(ParameterError, match="A is calibrated and B is not"):
        joined([run("A", 1.0), run("B", 1.0, calibrated=False)])
