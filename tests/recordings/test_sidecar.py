from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.condition import FIXED, Condition
from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from models.units import CHANNEL_UNITS
from noise.recordings.sidecar import (
    Sidecar,
    find_sidecar,
    parse_sidecar,
    read_sidecar,
    sidecar_text,
)

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


def test_everything_that_the_format_knows_is_read():
    found = parse_sidecar(json.dumps(FULL))
    assert [channel.name for channel in found.channels] == [
        "torque",
        "acceleration",
        "pressure",
        "angle",
    ]
    assert found.channels[1].position == (0.08, 0.0, 0.0)
    assert found.scales == (None, None, 63.0, None)
    assert found.calibrated is True
    condition = found.condition
    assert condition.interference == pytest.approx(0.279e-3, rel=1e-12)
    assert (condition.speed, condition.support_stiffness) == (5.0, 2214.0)
    assert (condition.material, condition.temperature) == ("fluorocarbon", 23.0)


def test_nothing_need_be_said():
    assert parse_sidecar("{}") == Sidecar()
    assert parse_sidecar('{"conditions": {}}').condition == Condition()


def test_notes_of_others_are_passed_over():
    assert parse_sidecar('{"operator": "me", "conditions": {"humidity": "wet"}}') == Sidecar()


def test_null_support_is_the_fixed_clamp_and_a_missing_one_unknown():
    fixed = parse_sidecar('{"conditions": {"support_stiffness_Nm_rad": null}}')
    assert fixed.condition.support_stiffness == FIXED
    assert parse_sidecar('{"conditions": {}}').condition.support_stiffness is None


@pytest.mark.parametrize(
    ("key", "ours"),
    [
        ("speed_rpm", "speed_rad_s"),
        ("interference_m", "interference_mm"),
        ("temperature_F", "temperature_C"),
        ("support_stiffness_Nmm_rad", "support_stiffness_Nm_rad"),
    ],
)
def test_a_condition_in_another_unit_is_refused_by_name(key, ours):
    with pytest.raises(RecordingError, match=f"'{key}', which is not read; state {ours}"):
        parse_sidecar(json.dumps({"conditions": {key: 48.0}}))


def test_null_is_unknown_for_the_other_conditions():
    names = ("speed_rad_s", "interference_mm", "material", "temperature_C")
    text = json.dumps({"conditions": dict.fromkeys(names)})
    assert parse_sidecar(text).condition == Condition()


def test_a_shaft_may_turn_backwards():
    assert parse_sidecar('{"conditions": {"speed_rad_s": -5}}').condition.speed == -5.0


def test_the_name_of_a_material_is_kept_as_given():
    assert parse_sidecar('{"conditions": {"material": "pDmS"}}').condition.material == "pDmS"


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("torque", "N m"),
        ("torque", "Nm"),
        ("torque", "N·m"),
        ("acceleration_2", "m/s^2"),
        ("acceleration_2", "m/s2"),
        ("acceleration_2", "m/s²"),
        ("speed", "rad/s"),
        ("force", "N"),
    ],
)
def test_spellings_of_one_unit_are_alike(name, unit):
    found = parse_sidecar(json.dumps({"channels": [{"name": name, "unit": unit}]}))
    assert found.channels == (Channel(name),)


@pytest.mark.parametrize("unit", ["kN", "kN m", "nm", "mN m", "", 5, None, ["N m"]])
def test_other_units_are_refused(unit):
    message = refusal(one_channel(unit=unit))
    assert "channel 'torque' has unit" in message
    assert message.endswith("expected 'N m'")


def test_a_direction_is_made_a_unit_vector():
    found = parse_sidecar(json.dumps(one_channel(direction=[0, -3, 4])))
    assert found.channels[0].direction == pytest.approx((0.0, -0.6, 0.8))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "is no JSON"),
        ("{", "is no JSON"),
        (b"\xff\xfe\xfa", "is no JSON"),
        ("[" * 100_000, "is no JSON"),
        ('{"a": ' + "1" * 5000 + "}", "is no JSON"),
        ("[]", "expected an object"),
        ("null", "expected an object"),
        ({"calibrated": "yes"}, "calibrated is 'yes', expected true or false"),
        ({"calibrated": 1}, "calibrated is 1"),
        ({"channels": {}}, "channels is {}, expected a list"),
        ({"channels": ["torque"]}, "channel 1 is 'torque'"),
        ({"channels": [{"unit": "N m"}]}, "channel 1 has name None"),
        ({"channels": [{"name": "temperature"}]}, "channel 1 has name 'temperature'"),
        ({"channels": [{"name": "torque_1"}]}, "channel 1 has name 'torque_1'"),
        ({"channels": [{"name": "torque_" + "9" * 5000}]}, "channel 1 has name"),
        ({"channels": [{"name": "angle"}] * 3}, "channel 'angle' is named 3 times"),
        (one_channel(scale=0), "channel 'torque': scale is 0, expected a positive number"),
        (one_channel(scale=-1.0), "expected a positive number"),
        (one_channel(scale="2"), "expected a positive number"),
        (one_channel(scale=math.nan), "expected a positive number"),
        (one_channel(position_m=[1, 2]), "expected three numbers"),
        (one_channel(position_m=[1, 2, None]), "expected three numbers"),
        (one_channel(position_m=[1, 2, "3"]), "expected a finite number"),
        (one_channel(position_m=0.08), "expected three numbers"),
        (one_channel(direction=[0, 0, 0]), "expected a vector with a length"),
        ({"conditions": []}, "conditions is [], expected an object"),
        ({"conditions": {"speed_rad_s": "5"}}, "speed_rad_s is '5', expected a finite number"),
        ({"conditions": {"speed_rad_s": True}}, "speed_rad_s is True"),
        ({"conditions": {"speed_rad_s": math.nan}}, "speed_rad_s is nan"),
        ({"conditions": {"speed_rad_s": -math.inf}}, "speed_rad_s is -inf"),
        ({"conditions": {"speed_rad_s": 10**400}}, "speed_rad_s is 1000"),
        ({"conditions": {"interference_mm": -0.1}}, "interference_mm is -0.1, expected"),
        ({"conditions": {"support_stiffness_Nm_rad": 0}}, "expected a positive number"),
        ({"conditions": {"support_stiffness_Nm_rad": math.inf}}, "expected a positive number"),
        ({"conditions": {"support_stiffness_Nm_rad": "fixed"}}, "support_stiffness_Nm_rad"),
        ({"conditions": {"temperature_C": -300}}, "expected a number of -273.15 or more"),
        ({"conditions": {"material": 3}}, "material is 3"),
        ({"conditions": {"material": " "}}, "material is ' '"),
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
    assert read_sidecar(sidecar).calibrated is False


def test_a_sidecar_that_cannot_be_opened_is_refused(tmp_path):
    with pytest.raises(RecordingError, match="is a folder, not a file"):
        read_sidecar(tmp_path)


finite = st.floats(allow_nan=False, allow_infinity=False, width=32)
vectors = st.none() | st.tuples(finite, finite, finite)
conditions = st.builds(
    Condition,
    speed=st.none() | finite,
    interference=st.none() | st.floats(0, 1e-2),
    support_stiffness=st.none() | st.just(FIXED) | st.floats(1.0, 1e6),
    material=st.none() | st.text(min_size=1).filter(str.strip),
    temperature=st.none() | st.floats(-200, 500),
)


@given(st.lists(st.sampled_from(list(CHANNEL_UNITS)), unique=True), conditions, vectors)
def test_what_is_written_is_read_back(names, condition, position):
    channels = tuple(Channel(name, position, (0.6, 0.0, -0.8)) for name in names)
    recording = Recording(np.zeros((len(names), 16)), 30e3, channels, condition)
    found = parse_sidecar(sidecar_text(recording))
    assert found.channels == channels
    fit = found.condition.interference
    assert fit == (condition.interference and pytest.approx(condition.interference, rel=1e-11))
    for key in ("speed", "support_stiffness", "material", "temperature"):
        assert getattr(found.condition, key) == getattr(condition, key)


@pytest.mark.parametrize(
    ("channels", "condition"),
    [
        ((Channel("torque"),), Condition(speed=math.nan)),
        ((Channel("torque"),), Condition(speed=math.inf)),
        ((Channel("torque"),), Condition(interference=-1e-4)),
        ((Channel("torque", position=(0.0, math.nan, 0.0)),), Condition()),
    ],
)
def test_what_could_not_be_read_back_is_not_written(channels, condition):
    recording = Recording(np.zeros((len(channels), 16)), 30e3, channels, condition, name="run07")
    with pytest.raises(ParameterError, match="recording 'run07'"):
        sidecar_text(recording)


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
