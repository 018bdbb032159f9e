"""Live simulation: the sound of a recording, and no click while the setting changes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.acquisition import Acquisition
from sim.live import LiveSimulation, paths_key, paths_of
from sim.plan import Setting
from sim.run import simulate
from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

THESIS, MEMORY, PDMS = map(load_material_rig, ("fluorocarbon-thesis", "fluorocarbon", "PDMS"))
QUIET = Acquisition(48e3, noise={})
RATE = 48e3
INAUDIBLE = 0.8e-3 * 8
"""What the microphone's noise never reaches [Pa]."""


def setting(rig=PDMS, shaft=5.0, support=2214.0):
    if isinstance(shaft, float):
        shaft = ConstantSpeed(shaft)
    return Setting(rig, shaft, 0.279e-3, support)


def live(at, **given):
    known = [paths_key(at), paths_of(at, RATE)]

    def paths(one):
        if paths_key(one) != known[0]:
            known[:] = paths_key(one), paths_of(one, RATE)
        return known[1]

    return LiveSimulation(at, paths, **given)


def sound(run, n, *changes):
    blocks = [run.block(change) for change in changes] + [run.block() for _ in range(n)]
    return np.concatenate([block.pressure for block in blocks])


def highest(pressure):
    """Largest part of a sound between 8 kHz and the end, where a click is heard before all else."""
    spectrum = np.fft.rfft(pressure)
    spectrum[: round(8e3 * pressure.size / RATE)] = 0.0
    return np.abs(np.fft.irfft(spectrum, pressure.size)).max()


def acting(rig, *effects):
    return replace(
        rig, effects=(*rig.effects, *(LawSpec(name, {"form": f}) for name, f in effects))
    )


PLATE, ROOM = ("plate_modes", "scattered"), ("room_reflections", "diffuse")


@pytest.mark.parametrize(
    ("rig", "shaft", "support"),
    [
        (THESIS, 1.0, 3745.0),
        (THESIS, Oscillation(0.26, 5.0), 2214.0),
        (THESIS, SpeedRamp(0.0, 8.0, 0.6), 2214.0),
        (MEMORY, 2.5, 2214.0),
        (MEMORY, 1.0, FIXED),
        (acting(THESIS, ("static_ageing", "exponential"), ("shaft_compliance", "linear")), -2.0,
         2214.0),
        (acting(MEMORY, ("beam_modes", "single"), PLATE, ROOM), 2.5, 2214.0),
    ],
)  # fmt: skip
def test_blocks_joined_are_the_recording(rig, shaft, support):
    one = simulate(rig, shaft, support_stiffness=support, seconds=0.5, acquisition=QUIET).recording
    run = live(setting(rig, shaft, support), acquisition=QUIET, n=1000)
    blocks = [run.block() for _ in range(24)]
    # Ten samples at the ends differ by the filter's edges; a slip there is counted later or not.
    inner = slice(12, -1000)
    for kind in ("pressure", "torque"):
        joined = np.concatenate([getattr(block, kind) for block in blocks])
        assert np.abs(joined - one[kind])[inner].max() < 1e-9 * np.abs(one[kind]).max()


@pytest.mark.parametrize(
    "change",
    [
        {"shaft": ConstantSpeed(9.0)},
        {"shaft": Oscillation(0.2, 2.0)},
        {"interference": 0.2e-3},
        {"support_stiffness": 3745.0},
        {"support_stiffness": math.inf},
        {"temperature": 60.0},
        {"rig": PDMS.changed(damping="x3", elastomer_stiffness="x0.6")},
        {"rig": PDMS.changed(kinetic_torque="x0.5", critical_torque="x0.5")},
    ],
)
def test_no_change_clicks(change):
    run = live(setting())
    before = sound(run, 10)
    assert highest(sound(run, 10, replace(setting(), **change))) <= max(
        1.3 * highest(before), INAUDIBLE
    )


def test_the_sound_follows_a_change_of_the_structure():
    run = live(setting(MEMORY))
    before = run.responses
    run.block(setting(MEMORY, 6.0))
    assert run.responses is before
    run.block(setting(MEMORY, 6.0, 3745.0))
    assert run.responses.torque_to_pressure.size == before.torque_to_pressure.size
    assert not np.array_equal(run.responses.torque_to_pressure, before.torque_to_pressure)
