"""Spring and friction identified from the force on a pulled slider, simulated and recorded."""

import os
from pathlib import Path

import numpy as np
import pytest

from models.recording import Channel, Recording
from tests.studies.pulled_slider import (
    SLIDER_TERMS,
    PulledRecord,
    Slider,
    identify_slider,
    read_pulled_record,
)

DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")
needs_records = pytest.mark.skipif(
    not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings"
)
RATE = 2000.0


def recorded(slider, stiffness, pull, seconds=30.0):
    force = slider.force(stiffness, pull, RATE, round(seconds * RATE))
    force = force + 5e-4 * np.random.default_rng(1).standard_normal(force.size)
    return PulledRecord(
        Recording(force[np.newaxis], RATE, (Channel("force"),), calibrated=False, name="run"),
        stiffness, pull,
    )  # fmt: skip


@pytest.mark.parametrize("stiffness", [120.0, 168.0, 500.0])
def test_spring_and_friction_of_a_simulated_slider_are_found(stiffness):
    found = identify_slider(recorded(Slider(0.3, 0.4, 0.3), stiffness, 5e-4))
    assert found.stiffness == pytest.approx(stiffness / 0.3, rel=0.05)
    assert found.static == pytest.approx(0.4, rel=0.01)
    assert found.kinetic == pytest.approx(0.3, rel=0.03)


def test_ageing_of_a_simulated_slider_is_found():
    aged = SLIDER_TERMS[0].put(Slider(0.3, 0.4, 0.3, scatter=0.01), (0.02, 0.01))
    found = identify_slider(recorded(aged, 168.0, 2e-4, 200.0))
    plain = identify_slider(recorded(Slider(0.3, 0.4, 0.3, scatter=0.01), 168.0, 2e-4, 200.0))
    assert found.static > plain.static + 0.03  # grown by 0.02 ln(1 + t / 0.01)


def identified(name):
    return identify_slider(read_pulled_record(Path(DATA) / "stickslip" / f"{name}.mat"))


@needs_records
def test_the_soft_springs_records_agree_on_what_it_pulls_whatever_the_speed():
    weights = [168.0 / identified(f"k168Nm_v{speed}").stiffness for speed in (42, 1100, 4300)]
    assert max(weights) / min(weights) < 1.12


@needs_records
def test_oscillation_tells_the_ratio_of_the_two_springs():
    soft, stiff = (identified(f"k{k}Nm_v4300").frequency for k in (168, 2254))
    assert (stiff / soft) ** 2 == pytest.approx(2254.0 / 168.0, rel=0.15)
