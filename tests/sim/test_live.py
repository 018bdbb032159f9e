"""A run that is heard while it is changed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from features.kernels.levels import sound_levels
from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.acquisition import Acquisition
from sim.effects import EFFECTS
from sim.friction import LAWS
from sim.live import LiveRun
from sim.live_setting import Setting
from sim.long_run import simulate_blocks
from sim.run import simulate
from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

RATE = 48e3
QUIET = 0.8e-3 * 8
"""What the microphone's noise never reaches [Pa]."""


def setting(material="fluorocarbon", shaft=5.0, interference=0.279e-3, support=2214.0):
    shaft = ConstantSpeed(shaft) if isinstance(shaft, float) else shaft
    return Setting(load_material_rig(material), shaft, interference, support)


def sound(run, n, *changes):
    blocks = [run.block(change) for change in changes] + [run.block() for _ in range(n)]
    return np.concatenate([block.pressure for block in blocks])


def highest(pressure):
    """Largest part of a sound between 8 kHz and the end, where a click is heard before all else."""
    spectrum = np.fft.rfft(pressure)
    spectrum[: round(8e3 * pressure.size / RATE)] = 0.0
    return np.abs(np.fft.irfft(spectrum, pressure.size)).max()


@pytest.mark.parametrize(
    "of",
    [
        setting(shaft=1.0, interference=0.381e-3),
        setting(),
        setting(shaft=10.0, support=3745.0),
        setting("fluorocarbon-thesis", -1.0, support=math.inf),
        setting("PDMS"),
    ],
)
def test_what_does_not_change_is_the_run_that_simulate_gives(of):
    run = LiveRun(of)
    heard = [run.block() for _ in range(30)]
    whole = simulate_blocks(
        of.rig, of.shaft, interference=of.interference, support_stiffness=of.support_stiffness,
        seconds=0.6, acquisition=Acquisition(rate=RATE),
    )  # fmt: skip
    block = np.hstack(list(whole.blocks))
    n = block.shape[1] - 40  # the end of a run is where its filters go on straight
    pressure = np.concatenate([one.pressure for one in heard])[:n]
    torque = np.concatenate([one.torque for one in heard])[:n]
    np.testing.assert_allclose(pressure, block[2, :n], atol=1e-6 * np.abs(block[2]).max())
    np.testing.assert_allclose(torque, block[0, :n], atol=0.05)  # but for the noise of its sensor


def test_a_change_ends_where_a_run_begins_that_was_never_changed():
    """Steady sliding forgets how it came about."""
    of = setting("PDMS", 5.0)
    run = LiveRun(of)
    other = replace(of, rig=of.rig.changed(kinetic_torque="x0.8"), shaft=ConstantSpeed(3.0))
    sound(run, 40, other)
    torque = run.block().torque
    assert torque.mean() == pytest.approx(LiveRun(other).block().torque.mean(), rel=1e-3)


@pytest.mark.parametrize(
    "change",
    [
        {"shaft": ConstantSpeed(9.0)},
        {"shaft": Oscillation(0.2, 2.0)},
        {"interference": 0.2e-3},
        {"support_stiffness": 3745.0},
        {"support_stiffness": math.inf},
        {"temperature": 60.0},
        {"rig": load_material_rig("PDMS").changed(damping="x3", elastomer_stiffness="x0.6")},
        {"rig": load_material_rig("PDMS").changed(kinetic_torque="x0.5", critical_torque="x0.5")},
    ],
)
def test_no_change_clicks(change):
    of = setting("PDMS")
    run = LiveRun(of)
    before = sound(run, 10)
    at_the_change = sound(run, 10, replace(of, **change))
    assert highest(at_the_change) <= max(1.3 * highest(before), QUIET)


@pytest.mark.parametrize("law", LAWS)
def test_one_law_takes_over_from_another(law):
    of = setting(shaft=3.0)
    other = replace(of, rig=replace(of.rig, friction=LawSpec(law)))
    run = LiveRun(of)
    heard = np.concatenate([sound(run, 5), sound(run, 15, other), sound(run, 15, of)])
    assert np.isfinite(heard).all()
    assert np.std(heard[-4800:]) == pytest.approx(np.std(sound(LiveRun(of), 5)), rel=0.6)


def with_effect(of, name, **parameters):
    return replace(of, rig=replace(of.rig, effects=(LawSpec(name, parameters),)))


@pytest.mark.parametrize("form", EFFECTS["speed_fluctuation"].forms)
@pytest.mark.parametrize("frequency", [0.0, 7.0])
def test_a_shaft_fluctuates_piece_by_piece_as_it_does_over_the_whole(form, frequency):
    active = EFFECTS["speed_fluctuation"].active({"form": form, "frequency": frequency})
    even, memory = np.linspace(1.0, 6.0, 2000), {"rng": np.random.default_rng(3)}
    whole = active.driven(even, 1e3, {"rng": np.random.default_rng(3)})
    pieces = [active.driven(piece, 1e3, memory) for piece in np.split(even, [500, 501, 1200])]
    if form == "random":  # of other numbers, but without a jump
        assert np.abs(np.diff(np.concatenate(pieces) / even)).max() < 0.02
    else:
        np.testing.assert_allclose(np.concatenate(pieces), whole, rtol=1e-12)


def test_a_shaft_that_does_not_turn_evenly_is_heard_so():
    of = with_effect(setting("PDMS"), "speed_fluctuation", depth=0.1, frequency=10.0)
    run = LiveRun(of)
    speed = np.array([run.block().speed for _ in range(50)])  # a second
    lines = 2.0 * np.abs(np.fft.rfft(speed - 5.0)) / speed.size
    assert lines[10] == pytest.approx(0.5, rel=1e-3)
    assert np.delete(lines, 10).max() < 1e-3


@pytest.mark.parametrize("form", EFFECTS["background_noise"].forms)
def test_the_background_is_that_of_a_recording_and_has_no_seams(form):
    of = with_effect(setting("PDMS"), "background_noise", form=form, pressure_level=70.0)
    heard = sound(LiveRun(of), 500)
    acquisition = Acquisition(rate=RATE)
    recorded = simulate(of.rig, of.shaft, seconds=10.0, acquisition=acquisition).recording
    live, whole = (sound_levels(one, RATE) for one in (heard, recorded["pressure"]))
    assert live.level_a == pytest.approx(whole.level_a, abs=0.4)
    bands = [band for band in live.third_octaves if 100.0 <= float(band) <= 16e3]
    differences = [live.third_octaves[band] - whole.third_octaves[band] for band in bands]
    assert np.abs(differences).max() < 0.8
    if form == "white":
        spread = heard[4800:].reshape(-1, 4800).std(axis=1)
        assert spread.max() < 1.08 * spread.min()
        assert abs(np.corrcoef(heard[:-14400], heard[14400:])[0, 1]) < 0.01


def test_the_hum_is_one_line_whatever_the_blocks():
    of = with_effect(setting("PDMS"), "mains_hum", form="sine", frequency=55.0, pressure_level=80.0)
    heard = sound(LiveRun(of), 220)[-4 * int(RATE) :]
    lines = np.abs(np.fft.rfft(heard)) / heard.size * 2**0.5
    assert 20.0 * np.log10(lines[220] / 2e-5) == pytest.approx(80.0, abs=0.05)
    assert np.delete(lines, 220).max() < 1e-3 * lines[220]


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("mains_hum", {"pressure_level": 60.0}, {"pressure_level": 90.0}),
        ("mains_hum", {"frequency": 50.0}, {"frequency": 60.0}),
        ("mains_hum", {"form": "sine"}, {"form": "harmonics"}),
        ("speed_fluctuation", {"depth": 0.01}, {"depth": 0.2}),
        ("speed_fluctuation", {"form": "sine"}, {"form": "random"}),
    ],
)
def test_no_change_of_drive_or_sensors_clicks(name, before, after):
    of, silent = setting("PDMS"), setting("PDMS")
    run = LiveRun(of)
    changes = [with_effect(of, name, **before), with_effect(of, name, **after), silent]
    heard = [sound(run, 11), *(sound(run, 10, change) for change in changes)]
    between = np.hanning(heard[1].size)  # or a sound that ends louder than it began would click
    loudest = highest(between * sound(LiveRun(changes[1]), 11))
    assert max(highest(between * one) for one in heard[1:]) <= max(1.3 * loudest, QUIET)


def test_effects_come_and_go_and_those_of_whole_runs_are_left_out():
    of = setting(shaft=3.0)
    run, plain = LiveRun(of), of.rig.effects
    for name in EFFECTS:
        effects = (*(one for one in plain if one.name != name), LawSpec(name))
        heard = sound(run, 1, replace(of, rig=replace(of.rig, effects=effects)), of)
        assert np.isfinite(heard).all()


def test_a_run_up_begins_its_clock_anew_and_a_swing_goes_on():
    run = LiveRun(setting(shaft=1.0))
    run.block(setting(shaft=SpeedRamp(0.0, 10.0, 1.0)))
    for _ in range(48):
        last = run.block()
    assert last.speed == pytest.approx(9.8, abs=0.3)


def test_a_setting_that_cannot_be_leaves_the_run_as_it_was():
    of = setting()
    run, untouched = LiveRun(of), LiveRun(of)
    sound(run, 3), sound(untouched, 3)
    for wrong in ({"interference": 0.5}, {"support_stiffness": -1.0}):
        with pytest.raises(ParameterError):
            run.block(replace(of, **wrong))
    np.testing.assert_array_equal(sound(run, 3), sound(untouched, 3))
