"""Measured transfer functions: resonances between the lines, no echo, poles that move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.condition import Condition
from models.recording import Channel, Recording
from models.rig_file import load_material_rig
from models.transfer_functions.measured import MeasuredResponse
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.simulated.repeats import nominal_repeats
from noise.diagnosis.simulated.transfer_functions import (
    TransferFunctionCache,
    predict,
    shift_clamp_mode,
    torque_transfer_functions,
)
from sim.bushing import lumped_bushing

RIG = load_material_rig("fluorocarbon-thesis")
LINES = np.arange(10.0, 5000.1, 2.5)


def _mode(f, at=259.0, damping=0.02):
    x = f / at
    return -(x**2) / (1.0 - x**2 + 2j * damping * x)


def _rig(response):
    """A rig whose both responses were measured."""
    frf = TransferFunction(LINES, response.astype(complex), None, "N m", "m/s^2")
    entry = MeasuredResponse(2214.0, frf, replace(frf, output_unit="Pa"))
    return replace(RIG, measured=(entry,))


def _measured(response):
    return torque_transfer_functions(_rig(response), 0.279e-3, 2214.0)["acceleration"]


def test_between_its_lines_a_resonance_is_what_it_is():
    f = np.arange(240.0, 280.0, 0.3)
    straight = np.abs(TransferFunction(LINES, _mode(LINES)).at(f) - _mode(f)).max()
    assert np.abs(_measured(_mode(LINES)).at(f) - _mode(f)).max() < 0.2 * straight


def test_a_measured_transfer_function_does_not_echo_after_one_over_its_spacing():
    torque = np.zeros(24_000)
    torque[2400] = 1.0
    rung = predict(torque, 24e3, _measured(_mode(LINES)))
    after = np.abs(rung[2400 + 8400 : 2400 + 12_000]).max()  # 0.35 to 0.5 s later
    assert after < 1e-3 * np.abs(rung).max()


def test_lines_that_are_not_equally_spaced_are_left_alone():
    uneven = np.geomspace(10.0, 5000.0, 400)
    frf = TransferFunction(uneven, _mode(uneven), None, "N m", "m/s^2")
    entry = MeasuredResponse(2214.0, frf, replace(frf, output_unit="Pa"))
    found = torque_transfer_functions(replace(RIG, measured=(entry,)), 0.279e-3, 2214.0)
    assert np.array_equal(found["acceleration"].frequencies, uneven)


def test_a_lighter_clamp_rings_higher():
    nominal = lumped_bushing(RIG, 0.279e-3, 2214.0)
    lighter = replace(nominal, clamp_inertia=0.9 * nominal.clamp_inertia)
    f = np.arange(150.0, 400.0, 0.1)
    s = 2j * np.pi * f
    clamp = 1.0 / (
        nominal.support_stiffness + nominal.support_damping * s + nominal.clamp_inertia * s**2
    )
    before, after = (
        f[np.argmax(np.abs(w.response))]
        for w in (
            TransferFunction(f, clamp),
            shift_clamp_mode(TransferFunction(f, clamp), nominal, lighter),
        )
    )
    assert after / before == pytest.approx(0.9**-0.5, rel=1e-3)


def test_a_quiet_steady_rig_is_quiet_from_start_to_end_of_a_recording():
    at = Condition(speed=8.0, interference=0.279e-3, support_stiffness=2214.0)
    rig = _rig(_mode(LINES))
    template = Recording(np.zeros((1, 15_000)), 30e3, (Channel("torque"),), at)
    (run,) = nominal_repeats(template, rig, TransferFunctionCache(rig), (1,))
    assert np.abs(run["acceleration"]).max() < 0.5
