from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings, strategies as st

from models.condition import FIXED, Condition
from models.errors import RecordingError
from models.recording import Channel, Recording
from models.units import CHANNEL_UNITS
from noise.recordings import read_recording, write_recording
from noise.recordings.sidecar import Sidecar, find_sidecar, parse_sidecar, sidecar_of, sidecar_text

FULL = {
    "channels": [
        {"name": "torque", "unit": "N m"},
        {"name": "acceleration", "unit": "m/s^2", "position_m": [0.08, 0, 0]},
        {"name": "pressure", "unit": "Pa", "scale": 63.0},
        {"name": "angle", "unit": "rad"},
    ],
    "conditions": {
        "speed_rad_s": 5.0,
        "interference_mm": 0.279,
        "support_stiffness_Nm_rad": 2214.0,
        "material": "fluorocarbon",
        "temperature_C": 23.0,
    },
    "calibrated": True,
}


def refusal(content: object) -> str:
    text = content if isinstance(content, str | bytes) else json.dumps(content)
    with pytest.raises(RecordingError) as raised:
        parse_sidecar(text, "run07.json")
    message = str(raised.value)
    assert message.startswith("run07.json: ")
    assert "\n" not in message
    assert len(message) < 250
    return message


def one_channel(**entries: object) -> dict[str, object]:
    return {"channels": [{"name": "torque", "unit": "N m", **entries}]}


OF_OTHERS = [
    "[]",
    '[{"start": 0.0, "end": 1.5, "text": "creak"}]',
    {"streams": [{"codec_type": "audio", "channels": 2}], "format": {"duration": "3.0"}},
    {"conditions": "cloudy", "date": "2024-05-01"},
    {"calibrated": "2024-05-01", "microphone": "4189"},
]


@pytest.mark.parametrize("content", OF_OTHERS)
def test_a_file_of_another_program_is_passed_over_with_a_note(tmp_path, content):
    text = content if isinstance(content, str) else json.dumps(content)
    found = parse_sidecar(text, "run07.json")
    assert "belongs to another program" in found.note
    assert replace(found, note="") == Sidecar()
    path = tmp_path / "run07.wav"
    soundfile.write(path, np.full(480, 0.5), 48_000)
    path.with_suffix(".json").write_text(text)
    run = read_recording(path)
    assert (run.channel_names, run.calibrated) == (("pressure",), False)
    assert run.notes == (found.note,)


def test_null_support_is_the_fixed_clamp_and_a_missing_one_unknown():
    fixed = parse_sidecar('{"conditions": {"support_stiffness_Nm_rad": null}}')
    assert fixed.condition.support_stiffness == FIXED
    assert parse_sidecar('{"conditions": {}}').condition.support_stiffness is None


def conditions_of(**entries: object) -> dict[str, object]:
    return {"conditions": entries}


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("[" * 100_000, "is no JSON"),
        ({"calibrated": "yes"}, "calibrated = 'yes' must be true or false"),
        ({"calibrated": True, "channels": 2, "operator": "me"}, "channels = 2 must be a list"),
        ({"channels": [{"unit": "N m"}]}, "channel 1: name is missing"),
        ({"channels": [{"name": "torque_1"}]}, "name = 'torque_1' must be one of"),
        ({"channels": [{"name": "angle"}] * 3}, "channel 'angle' is named 3 times"),
        *(
            (one_channel(unit=unit), "channel 'torque': unit = ")
            for unit in ("kN", "kN m", "nm", "mN m", "", 5, ["N m"])
        ),
        (one_channel(scale=0), "channel 'torque': scale = 0 must be a number above 0"),
        (one_channel(position_m=[1, 2]), "must be a list of 3 numbers"),
        ({"conditions": []}, "conditions must be a table"),
        (conditions_of(speed_rad_s="5"), "speed_rad_s = '5' must be a number"),
        (conditions_of(interference_mm=-0.1), "mm = -0.1 must be a number from 0 to 10 mm"),
        (conditions_of(support_stiffness_Nm_rad=0), "support_stiffness_Nm_rad = 0 must be"),
        (conditions_of(temperature_C=-300), "C = -300 must be a number from -273.15"),
        (conditions_of(material=" "), "material = ' ' must be a name"),
        (conditions_of(speed_rpm=48), "'speed_rpm', which is not read; state speed_rad_s"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(content, reason):
    assert reason in refusal(content)


def test_the_sidecar_is_the_file_of_the_same_stem(tmp_path):
    recording = tmp_path / "a_FS129.9dB(PK).00.wav"
    assert find_sidecar(recording) is None
    sidecar = tmp_path / "a_FS129.9dB(PK).00.json"
    sidecar.write_bytes(b"\xef\xbb\xbf" + b'{"calibrated": false}')
    assert find_sidecar(recording) == sidecar
    assert sidecar_of(recording).calibrated is False


finite = st.floats(allow_nan=False, allow_infinity=False, width=32)
vectors = st.none() | st.tuples(finite, finite, finite)
conditions = st.builds(
    Condition,
    speed=st.none() | st.floats(-1e6, 1e6),
    interference=st.none() | st.floats(0, 1e-2),
    support_stiffness=st.none() | st.just(FIXED) | st.floats(1.0, 1e6),
    material=st.none() | st.text(min_size=1).filter(str.strip),
    temperature=st.none() | st.floats(-200, 500),
)


@settings(max_examples=40)
@given(st.lists(st.sampled_from(list(CHANNEL_UNITS)), unique=True), conditions, vectors)
def test_what_is_written_is_read_back(names, condition, position):
    channels = tuple(Channel(name, position, (0.6, 0.0, -0.8)) for name in names)
    recording = Recording(np.zeros((len(names), 16)), 30e3, channels, condition)
    found = parse_sidecar(sidecar_text(recording))
    assert tuple(one.channel for one in found.channels) == channels
    fit = found.condition.interference
    assert fit == (condition.interference and pytest.approx(condition.interference, rel=1e-11))
    for key in ("speed", "support_stiffness", "material", "temperature"):
        assert getattr(found.condition, key) == getattr(condition, key)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=6,
)


@given(st.data(), json_values)
def test_a_sidecar_with_any_value_exchanged_is_read_or_refused(data, value):
    content = json.loads(json.dumps(FULL))
    place = content
    key = data.draw(st.sampled_from(sorted(content)))
    while isinstance(place[key], dict | list) and place[key] and data.draw(st.booleans()):
        place = place[key]
        keys = sorted(place) if isinstance(place, dict) else range(len(place))
        key = data.draw(st.sampled_from(keys))
    place[key] = value
    try:
        found = parse_sidecar(json.dumps(content))
    except RecordingError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert isinstance(found, Sidecar)


# A call that is killed while it writes

DYING = """
import sys
from pathlib import Path
import numpy as np
import os
from models.recording import Channel, Recording
from noise.recordings import write_recording

moved = Path.replace
def dying(self, target):
    if str(target).endswith(sys.argv[2]):
        os._exit(9)
    return moved(self, target)
Path.replace = dying
samples = np.random.default_rng(2).normal(0, 3, (1, 4800))
write_recording(sys.argv[1], Recording(samples, 48e3, (Channel("acceleration"),), name="run"))
"""


@pytest.fixture
def torque(tmp_path):
    samples = np.random.default_rng(1).normal(0, 3, (1, 4800))
    run = Recording(samples, 48e3, (Channel("torque"),), Condition(speed=5.0), name="run07.wav")
    return write_recording(tmp_path / "run07", run)


@pytest.mark.parametrize("last", [".json", ".wav"])
def test_a_call_killed_while_it_writes_leaves_no_wrong_description(torque, last):
    done = subprocess.run([sys.executable, "-c", DYING, torque, last], check=False)
    assert done.returncode == 9
    assert not torque.with_suffix(".json").exists()
    assert not read_recording(torque).calibrated
