"""Labels along a run-up and a swing of the simulated rig, and each named cell from any channels."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from models.rig_file import load_material_rig
from noise.classifier import load_classifier
from noise.labels.segments import file_label, label_recording
from noise.noise_definition import label_by_physics
from sim.run import simulate
from sim.shaft import Oscillation, SpeedRamp

CREAKS = [(0.381e-3, k, v, "creak") for k in (2214.0, 3745.0) for v in (1.0, 2.5, 5.0, 7.5, 10.0)]
CELLS = [
    *CREAKS,
    (0.279e-3, 2214.0, 5.0, "squawk"),
    (0.279e-3, 2214.0, 7.5, "squawk"),
    (0.279e-3, 3745.0, 5.0, "squawk"),
    (0.178e-3, 2214.0, 1.0, "squawk"),
    (0.178e-3, 2214.0, 2.5, "squawk"),
    (0.279e-3, 3745.0, 10.0, "squeal"),
    (0.279e-3, 2214.0, 10.0, "none"),
    (0.178e-3, 2214.0, 5.0, "none"),
    (0.178e-3, 2214.0, 7.5, "none"),
    (0.178e-3, 2214.0, 10.0, "none"),
]


def run(shaft, interference, stiffness, seconds):
    rig = load_material_rig("fluorocarbon")
    return simulate(
        rig, shaft, interference=interference, support_stiffness=stiffness, seconds=seconds
    )


def sound_alone(recording):
    row = recording.channel_names.index("pressure")
    return replace(recording, samples=recording.samples[[row]], channels=(recording.channels[row],))


@pytest.mark.parametrize(("interference", "stiffness", "speed", "noise"), CELLS)
def test_conditions_whose_noise_the_thesis_names_carry_its_label(
    interference, stiffness, speed, noise
):
    made = run(speed, interference, stiffness, 1.0)
    assert label_by_physics(made) == noise
    recording = made.recording
    for heard in (recording, sound_alone(recording)):
        assert file_label(label_recording(heard, load_classifier())).label == noise


def test_a_swing_at_a_tight_fit_is_one_creak():
    recording = run(Oscillation(np.radians(15.0), 2.0), 0.381e-3, 2214.0, 3.0).recording
    for heard in (recording, sound_alone(recording)):
        assert [s.label for s in label_recording(heard, load_classifier())] == ["creak"]


def test_a_run_up_goes_from_squawk_to_squeal_to_silence_without_flicker():
    recording = run(SpeedRamp(0.0, 10.0, 6.0), 0.279e-3, np.inf, 6.0).recording
    segments = label_recording(recording, load_classifier())
    assert [s.label for s in segments[-3:]] == ["squawk", "squeal", "none"]
    assert len(segments) <= 4
    assert segments[-1].start == pytest.approx(5.29, abs=0.2)  # 8.8 rad/s; V_crit2 is 8.25
    for one, following in pairwise(segments):
        assert one.end == following.start
