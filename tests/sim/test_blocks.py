"""Runs in blocks: the recording that one block gives, in little memory, also while it changes."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from features.kernels.level_meter import sound_levels
from models.condition import FIXED
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.commands.simulate import write_run
from noise.recordings import read_recording
from noise.recordings.wav import write_blocks
from sim.acquisition import Acquisition
from sim.blocks import BlockEngine, simulate_blocks
from sim.plan import Setting
from sim.run import simulate
from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

THESIS, MEMORY, PDMS = map(load_material_rig, ("fluorocarbon-thesis", "fluorocarbon", "PDMS"))
QUIET = Acquisition(noise={})
RATE = 48e3
INAUDIBLE = 0.8e-3 * 8
"""What the microphone's noise never reaches [Pa]."""


def joined(run):
    return np.concatenate(list(run.blocks), axis=1)


def setting(rig=PDMS, shaft=5.0, support=2214.0, effect=None, **given):
    if effect is not None:
        rig = replace(rig, effects=(LawSpec(effect, given),))
    return Setting(rig, shaft if not isinstance(shaft, float) else ConstantSpeed(shaft), 0.279e-3,
                   support)  # fmt: skip


def sound(run, n, *changes):
    blocks = [run.block(change) for change in changes] + [run.block() for _ in range(n)]
    return np.concatenate([block.samples["pressure"] for block in blocks])


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
JOINED = [
    (THESIS, 1.0, 3745.0, 0.11),
    (THESIS, 1.0, 3745.0, 0.3),
    (THESIS, Oscillation(0.26, 5.0), 2214.0, 0.11),
    (THESIS, SpeedRamp(0.0, 8.0, 0.6), 2214.0, 0.3),
    (MEMORY, 2.5, 2214.0, 0.3),
    (MEMORY, 1.0, FIXED, 0.11),
    (acting(THESIS, ("static_ageing", "exponential"), ("shaft_compliance", "linear")), -2.0,
     2214.0, 0.11),
    *((acting(MEMORY, *effects), 2.5, 2214.0, 0.11)
      for effects in ([PLATE], [ROOM], [("beam_modes", "single"), PLATE, ROOM])),
]  # fmt: skip


@pytest.mark.parametrize(("rig", "shaft", "support", "block_seconds"), JOINED)
def test_recordings_joined_are_one_recording(rig, shaft, support, block_seconds):
    how = {"support_stiffness": support, "seconds": 0.7, "acquisition": QUIET}
    one = simulate(rig, shaft, rng=np.random.default_rng(7), **how).recording
    run = simulate_blocks(
        rig, shaft, rng=np.random.default_rng(7), block_seconds=block_seconds, **how
    )
    samples = joined(run)
    assert (run.channels, run.condition, run.rate) == (one.channels, one.condition, one.rate)
    assert samples.shape == one.samples.shape == (4, run.n_samples)
    # Ten samples at the ends differ by the filter's edges; a slip there is counted later or not.
    inner = slice(12, -600)
    for row, expected in zip(samples, one.samples, strict=True):
        assert np.abs(row - expected)[inner].max() < 1e-9 * np.abs(expected).max()


def test_effects_of_drive_and_sensors_act_alike_whatever_the_blocks():
    specs = LawSpec("speed_fluctuation", {"frequency": 20.0}), LawSpec("mains_hum", {})
    rig, quiet = replace(PDMS, effects=specs), {"seconds": 0.5, "acquisition": QUIET}
    short, long = (
        joined(simulate_blocks(rig, 5.0, block_seconds=block, **quiet)) for block in (0.04, 0.5)
    )
    np.testing.assert_allclose(short, long, rtol=1e-6, atol=1e-7)
    plain = joined(simulate_blocks(replace(rig, effects=()), 5.0, **quiet))
    swing = short[3] - plain[3]  # of the angle: amplitude 0.02 * 5 rad/s over 2 pi 20 Hz
    assert np.ptp(swing) == pytest.approx(2 * 0.1 / (2 * np.pi * 20.0), rel=1e-2)
    assert np.std(short[1] - plain[1]) > 0.4  # the hum on the acceleration


def test_effects_that_need_the_whole_run_are_refused_by_name():
    clipped = replace(THESIS, effects=(LawSpec("clipping", {}),))
    with pytest.raises(ParameterError, match="clipping: acts on a run as a whole"):
        simulate_blocks(clipped, 2.0, seconds=0.4)


def test_a_long_run_is_written_as_any_recording(tmp_path):
    path = write_run(tmp_path / "deep" / "run07", simulate_blocks(MEMORY, 5.0, seconds=0.3))
    back = read_recording(path)
    assert path == tmp_path / "deep" / "run07.wav"
    direct = joined(simulate_blocks(MEMORY, 5.0, seconds=0.3))
    assert np.array_equal(back.samples, direct.astype(np.float32))
    assert back.condition.speed == 5.0


def test_a_run_that_fails_on_its_way_leaves_no_file(tmp_path):
    def failing():
        yield np.zeros((1, 100))
        raise ParameterError("the motion grows without bound")

    about = Recording(np.zeros((1, 0)), 30e3, (Channel("torque"),))
    for blocks, wrong in (
        (failing(), "without bound"),
        (iter([np.zeros((1, 100))]), "100 samples arrived, expected 200"),
        (iter([np.full((1, 200), np.nan)]), "'torque' holds samples that are not finite"),
    ):
        with pytest.raises(ParameterError, match=wrong):
            write_blocks(tmp_path / "run", blocks, 200, about)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads the process's peak from /proc")
def test_memory_stays_below_300_MB_and_does_not_grow(tmp_path):  # noqa: N802
    code = f"""
from pathlib import Path
from models.rig_file import load_material_rig
from noise.commands.simulate import write_run
from sim.blocks import simulate_blocks
for seconds in (20.0, 90.0):
    write_run({str(tmp_path / "run")!r}, simulate_blocks(load_material_rig("fluorocarbon"), 2.5,
              seconds=seconds))
    print(int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]) / 1024)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    short, long = map(float, done.stdout.split())
    assert long < 300.0
    assert long < short + 10.0


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
    run = BlockEngine(setting())
    before = sound(run, 10)
    assert highest(sound(run, 10, replace(setting(), **change))) <= max(
        1.3 * highest(before), INAUDIBLE
    )


def test_the_sound_follows_a_change_of_the_structure():
    run = BlockEngine(setting(MEMORY))
    before = run.responses
    stiffer = replace(setting(MEMORY), support_stiffness=3745.0)
    run.block(setting(MEMORY, 6.0))
    assert run.responses is before
    run.block(stiffer)
    assert run.responses.torque_to_pressure.size == before.torque_to_pressure.size
    assert not np.array_equal(run.responses.torque_to_pressure, before.torque_to_pressure)


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("mains_hum", {"pressure_level": 60.0}, {"pressure_level": 90.0}),
        ("mains_hum", {"form": "sine"}, {"form": "harmonics"}),
        ("speed_fluctuation", {"depth": 0.01}, {"depth": 0.2}),
        ("speed_fluctuation", {"form": "sine"}, {"form": "random"}),
    ],
)
def test_no_change_of_drive_or_sensors_clicks(name, before, after):
    run = BlockEngine(setting())
    changes = [setting(effect=name, **before), setting(effect=name, **after), setting()]
    sounds = [sound(run, 11), *(sound(run, 10, change) for change in changes)]
    between = np.hanning(sounds[1].size)  # or a sound that ends louder than it began would click
    loudest = highest(between * sound(BlockEngine(changes[1]), 11))
    assert max(highest(between * one) for one in sounds[1:]) <= max(1.3 * loudest, INAUDIBLE)


@pytest.mark.parametrize("form", ["white", "brown"])
def test_the_background_is_that_of_a_recording_and_has_no_seams(form):
    of = setting(effect="background_noise", form=form, pressure_level=70.0)
    live = sound(BlockEngine(of, kinds=("pressure",)), 300)
    recorded = simulate(of.rig, of.shaft, seconds=6.0, acquisition=Acquisition(RATE)).recording
    in_blocks, whole = (sound_levels(one, RATE) for one in (live, recorded["pressure"]))
    assert in_blocks.level_a == pytest.approx(whole.level_a, abs=0.5)
    bands = [band for band in in_blocks.third_octaves if 200.0 <= float(band) <= 16e3]
    for band in bands:
        assert in_blocks.third_octaves[band] == pytest.approx(whole.third_octaves[band], abs=1.0)
