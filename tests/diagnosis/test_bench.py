"""Recordings that cannot be of their rig as it is described are told so, and right ones are not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from models.rig_file import load_material_rig, load_rig
from noise.diagnosis.bench.check import bench_findings
from noise.diagnosis.case import Case, read_case
from noise.diagnosis.diagnose import diagnose, diagnose_case
from noise.diagnosis.outcome import as_json
from noise.diagnosis.sentences import answer
from sim.run import simulate
from tests.helpers.small_rigs import RIG, at, run, write_case
from tests.helpers.wrong_benches import WRONG_BENCHES

SPEEDS = (1.0, 1.6, 1.6, 2.5, 3.5)

RIGHT = {
    "nothing": (),
    "a gain": (("gain_error", {"error": 0.2, "torque": -1.0, "acceleration": 1.0}),),
    "heavy clipping": (("clipping", {"amount": 0.8}),),
    "a late channel": (("channel_delay", {"delay": 1e-3}),),
    "noise": (("background_noise", {"amount": 5.0}),),
    "an uneven drive": (("speed_fluctuation", {"depth": 0.2}),),
    "impacts": (("slip_pulse", {"amplitude": 500.0}),),
    "a film": (("transfer_film", {"torque_ratio": 2.5}),),
    "heat": (("frictional_heating", {"softening": 0.02}),),
}


def _case(recordings):
    return Case(RIG, tuple(f"run{i}.wav" for i in range(len(recordings))), tuple(recordings))


@pytest.fixture(scope="module")
def right():
    return [run(at(speed), seed=i) for i, speed in enumerate(SPEEDS)]


@pytest.mark.parametrize("name", WRONG_BENCHES)
def test_a_wrong_bench_is_told(right, tmp_path, name):
    change, words = WRONG_BENCHES[name]
    data, rig = write_case(tmp_path, change(right, np.random.default_rng(1)))
    case = read_case([data], load_rig(rig))
    findings = (*bench_findings(case), *case.faults)
    assert findings
    assert any(words in text for text in findings)


@pytest.mark.parametrize("name", RIGHT)
def test_an_effect_is_no_wrong_bench(name):
    recordings = [run(at(speed), *RIGHT[name], seed=i) for i, speed in enumerate(SPEEDS[1:4])]
    assert bench_findings(_case(recordings)) == ()


def test_a_shaft_that_turns_backwards_is_no_wrong_bench():
    recordings = [run(at(-speed), seed=i) for i, speed in enumerate(SPEEDS[:3])]
    assert bench_findings(_case(recordings)) == ()


@pytest.mark.parametrize("name", ["fluorocarbon", "PDMS", "natural-rubber", "natural-rubber-film"])
def test_another_material_is_told(name):
    other = load_material_rig(name)
    fit = min(other.fits, key=lambda fit: abs(fit.interference - 0.279e-3)).interference
    fit = 0.279e-3 if len(other.fits) > 1 else fit
    recordings = []
    for i, speed in enumerate(SPEEDS[:4]):
        made = simulate(
            other, speed, interference=fit, seconds=0.4, rng=np.random.default_rng(i)
        ).recording
        recordings.append(replace(made, condition=at(speed)))
    (told,) = bench_findings(_case(recordings))
    assert "another material" in told


def test_a_wrong_bench_has_no_cause_and_its_finding_comes_first(right):
    change, _ = WRONG_BENCHES["acceleration in g"]
    told = diagnose_case(_case(change(right, np.random.default_rng(0))))
    words = "channel acceleration looks like g, not m/s^2 (factor 9.8)"
    assert told.verdict == ("unknown",)
    assert as_json(told)["notes"][0] == words
    assert answer(told)[0] == f"C{words[1:]}."
    assert as_json(told)["headline"] == "Not this rig as it is described"
    assert not any(p for cause, p in told.probabilities.items() if cause != "unknown")


def _filled(recording, channel, value):
    samples = np.array(recording.samples)
    samples[recording.channel_names.index(channel)] = value
    return replace(recording, samples=samples)


@pytest.mark.parametrize(
    ("channel", "value", "at_value"), [("pressure", 0.0, "0"), ("torque", 3.0, "3")]
)
def test_a_dead_channel_is_left_out_and_said_first(right, tmp_path, channel, value, at_value):
    data, rig = write_case(tmp_path, [_filled(one, channel, value) for one in right[:3]])
    told = diagnose(data, rig, quick=True)
    words = f"channel {channel} is dead: it stays at {at_value} in all recordings"
    assert told.faults == (words,)
    assert not told.bench
    assert math.isfinite(told.gap)


def test_a_range_that_the_torque_reaches_is_told(right, tmp_path):
    most = max(float(one["torque"].max()) for one in right[:3])
    range_ = 0.97 * most
    cut = []
    for one in right[:3]:
        samples = np.array(one.samples)
        row = one.channel_names.index("torque")
        samples[row] = np.minimum(samples[row], range_)
        cut.append(replace(one, samples=samples))
    data, rig = write_case(tmp_path, cut)
    assert read_case([data], load_rig(rig)).faults == (f"channel torque clips at {range_:.3g} N m",)
    data, rig = write_case(tmp_path / "whole", right[:3])
    assert read_case([data], load_rig(rig)).faults == ()


@pytest.mark.parametrize("other", ["angle", "acceleration"])
def test_a_torque_in_another_channel_is_told_though_nothing_slips(tmp_path, other):
    smooth = ("velocity_strengthening", {"gain": 0.9, "speed": 2.0})
    sliding = [run(at(speed), smooth, seed=i) for i, speed in enumerate((2.0, 3.0, 4.0))]
    assert bench_findings(_case(sliding)) == ()
    change, words = WRONG_BENCHES[f"torque and {other} swapped"]
    data, rig = write_case(tmp_path, change(sliding, np.random.default_rng(0)))
    (told,) = bench_findings(read_case([data], load_rig(rig)))
    assert words in told
