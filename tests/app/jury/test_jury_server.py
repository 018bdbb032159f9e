"""What the server tells of a jury: nothing that tells sounds apart, but the sounds."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest
import soundfile

from models.recording import Channel, Recording
from noise.base.tables import read_table
from noise.recordings.wav import write_recording
from tests.helpers.jury_sounds import NAMES, RATE, tone, write_tones
from tests.helpers.opened_app import served_app

ASKED = {"sounds": [0, 1, 2, 3], "question": "Which is louder?"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = write_tones(tmp_path_factory.mktemp("tones"))
    write_recording(folder / "z-short.wav", tone(1000.0, 1.0, 0.2))
    torque = Recording(np.ones((1, RATE)), RATE, (Channel("torque"),), calibrated=True)
    write_recording(folder / "z-torque.wav", torque)
    soundfile.write(folder / "z-uncalibrated.wav", 0.1 * np.ones(RATE), RATE)
    (folder / "zz-broken.wav").write_bytes(b"no sound")
    return folder


@pytest.fixture(scope="module")
def app(folder):
    with served_app(folder, save=folder) as running:
        yield running


def heard(app, jury, place, side):
    status, said = app.request(f"api/juries/{jury}/heard/{place}/{side}")
    assert status == 200, said
    samples, rate = soundfile.read(io.BytesIO(said))
    assert rate == RATE
    return samples


def rms(samples):
    return float(np.sqrt(np.mean(samples[RATE // 10 : -RATE // 10] ** 2)))


def planned(folder, jury):
    rows = read_table(folder / f"{folder.name}-votes.csv")[1]
    return [(row["first"], row["second"]) for row in rows if row["jury"] == str(jury)]


def test_a_jury_is_asked_without_a_name_and_heard_at_one_gain(app, folder):
    begun = app.json("api/juries", ASKED)
    assert begun["total"] == 6
    status, said = app.request(f"api/juries/{begun['jury']}")
    assert status == 200
    assert b".wav" not in said
    full_scale = float(re.search(rb"full scale = ([\d.]+) Pa", said)[1])
    assert full_scale == pytest.approx(10.0 ** (3.0 / 20.0), rel=0.01)  # of headroom
    for place, names in enumerate(planned(folder, begun["jury"])):
        for side, name in zip("ab", names, strict=True):
            level = rms(heard(app, begun["jury"], place, side))
            wanted = 0.5 ** NAMES.index(name) / np.sqrt(2.0)
            assert full_scale * level == pytest.approx(wanted, rel=0.01)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"sounds": [0]}, "2 to 40 can be compared"),
        ({"sounds": list(range(41))}, "2 to 40 can be compared"),
        ({"sounds": "all"}, "must be a list"),
        ({"sounds": [0, 99]}, "there is no recording 99"),
        ({"question": " "}, "must say what is asked"),
        ({"question": "x" * 201}, "at most 200 characters"),
        ({"sounds": [0, 5]}, "z-torque.wav: has no sound pressure"),
        ({"sounds": [0, 6]}, "z-uncalibrated.wav is not, so one gain cannot keep"),
        ({"sounds": [0, 7]}, "zz-broken.wav: cannot be heard"),
    ],
)
def test_what_cannot_be_compared_is_said_and_begins_nothing(app, said, told):
    before = len(app.json("api/juries")["juries"])
    status, answer = app.request("api/juries", ASKED | said)
    assert status == 400
    assert told in answer.decode()
    assert len(app.json("api/juries")["juries"]) == before
