from __future__ import annotations

import numpy as np
import pytest

from models.condition import FIXED, Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.audio.sequence import back_to_back

RATE = 48000


def run(name, amplitude, *, rate=RATE, seconds=0.5, condition=None, calibrated=True):
    time = np.arange(round(seconds * rate)) / rate
    samples = amplitude * np.sin(2 * np.pi * 1000 * time)[np.newaxis]
    known = condition or Condition()
    return Recording(samples, rate, (Channel("pressure"),), known, calibrated, name)


def test_parts_keep_their_loudness_and_the_gap_is_silent():
    pair = back_to_back([run("A", 1.0), run("B", 0.25, rate=30e3)], RATE, gap=0.2)
    (a, b) = pair.parts
    assert (a.name, b.name) == ("A", "B")
    assert (a.start, a.end) == (0.0, 0.5)
    assert (b.start, b.end) == pytest.approx((0.7, 1.2))
    heard = [pair.sound.whole()[round(p.start * RATE) : round(p.end * RATE)] for p in pair.parts]
    levels = [20 * np.log10(part[2400:-2400].std()) for part in heard]
    assert levels[0] - levels[1] == pytest.approx(20 * np.log10(4), abs=0.01)
    assert not pair.sound.whole()[round(0.5 * RATE) : round(0.7 * RATE)].any()


def test_each_part_is_faded_by_itself():
    pair = back_to_back([run("A", 1.0), run("B", 1.0)], RATE, gap=0.0, fade=0.05)
    seam = pair.sound.whole()[RATE // 2 - 480 : RATE // 2 + 480]
    assert np.abs(seam).max() < 0.15


def test_the_whole_knows_what_holds_for_all_parts():
    a = Condition(speed=5.0, interference=0.279e-3, support_stiffness=FIXED, material="PDMS")
    b = Condition(speed=5.0, interference=0.381e-3, support_stiffness=FIXED)
    whole = back_to_back([run("A", 1, condition=a), run("B", 1, condition=b)]).recording
    assert whole.condition == Condition(speed=5.0, support_stiffness=FIXED)


def test_calibrated_and_uncalibrated_sounds_share_no_gain():
    with pytest.raises(ParameterError, match="A is calibrated and B is not"):
        back_to_back([run("A", 1.0), run("B", 1.0, calibrated=False)])
