"""Runs in blocks: the same recording as in one piece, in little memory, on disk."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import resample_poly

from models.condition import FIXED
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.rig import LawSpec
from models.rig_file import load_material_rig
from models.transfer_functions.filtering import convolve
from noise.long_run import write_run
from noise.recordings import read_recording
from noise.recordings.wav import write_blocks
from sim.acquisition import Acquisition
from sim.long_run import simulate_blocks
from sim.motion import motion_blocks, simulate_motion
from sim.run import simulate
from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp
from sim.streams import Convolution, Decimation

THESIS = load_material_rig("fluorocarbon-thesis")
MEMORY = load_material_rig("fluorocarbon")
AGEING = replace(THESIS, effects=(LawSpec("static_ageing", {}), LawSpec("shaft_compliance", {})))
QUIET = Acquisition(noise={})


def joined(blocks):
    return np.concatenate(list(blocks), axis=1)


@pytest.mark.parametrize("block", [1000, 6007])
@pytest.mark.parametrize(
    ("rig", "shaft"),
    [
        (THESIS, Oscillation(0.26, 5.0)),
        (THESIS, SpeedRamp(0.0, 8.0, 0.2)),
        (MEMORY, ConstantSpeed(2.5)),
        (AGEING, ConstantSpeed(-2.0)),
    ],
    ids=["swing", "ramp", "law", "effects"],
)
def test_motions_joined_are_one_motion(rig, shaft, block):
    from sim.effects import EFFECTS
    from sim.effects.effect import activated

    where = {"interference": 0.279e-3, "support_stiffness": 2214.0, "rate": 60e3}
    effects = [a for a in activated(rig.effects, EFFECTS) if a.effect.contact is not None]
    one = simulate_motion(rig, shaft, seconds=0.2, effects=effects, **where)
    parts = list(motion_blocks(rig, shaft, n_samples=12000, block=block, effects=effects, **where))
    for name in ("torque", "shaft_angle", "shaft_speed", "interface_speed", "clamp_speed"):
        whole = getattr(one, name)
        cut = np.concatenate([getattr(part, name) for part in parts])
        assert np.abs(cut - whole)[:-1].max() <= 1e-9 * np.abs(whole).max()


@pytest.mark.parametrize("block_seconds", [0.11, 0.3])
@pytest.mark.parametrize(
    ("rig", "shaft", "support"),
    [(THESIS, 1.0, 3745.0), (MEMORY, 2.5, 2214.0), (MEMORY, 1.0, FIXED)],
)
def test_recordings_joined_are_one_recording(rig, shaft, support, block_seconds):
    how = {"support_stiffness": support, "seconds": 0.7, "acquisition": QUIET}
    one = simulate(rig, shaft, **how).recording
    run = simulate_blocks(rig, shaft, block_seconds=block_seconds, **how)
    samples = joined(run.blocks)
    assert (run.channels, run.condition, run.rate) == (one.channels, one.condition, one.rate)
    assert samples.shape == one.samples.shape == (4, run.n_samples)
    # Ten samples at the ends differ by the filter's edges; a slip there is told later or not.
    inner = slice(12, -600)
    for row, expected in zip(samples, one.samples, strict=True):
        assert np.abs(row - expected)[inner].max() < 1e-9 * np.abs(expected).max()


def test_noise_does_not_depend_on_the_blocks():
    noisy = [
        joined(simulate_blocks(THESIS, 2.0, seconds=0.4, block_seconds=b).blocks)
        for b in (0.1, 1.0)
    ]
    assert np.abs(noisy[0] - noisy[1]).max(axis=1) == pytest.approx(0.0, abs=1e-8)
    quiet = joined(simulate_blocks(THESIS, 2.0, seconds=0.4, acquisition=QUIET).blocks)
    spread = np.std(noisy[0] - quiet, axis=1)
    assert spread == pytest.approx([0.005, 0.02, 0.8e-3, 1e-4], rel=0.05)


def test_effects_of_drive_and_sensors_act_alike_whatever_the_blocks():
    specs = LawSpec("speed_fluctuation", {"frequency": 20.0}), LawSpec("mains_hum", {})
    rig = replace(load_material_rig("PDMS"), effects=specs)
    quiet = {"seconds": 0.5, "acquisition": Acquisition(noise={})}
    short, long = (
        joined(simulate_blocks(rig, 5.0, block_seconds=block, **quiet).blocks)
        for block in (0.04, 0.5)
    )
    np.testing.assert_allclose(short, long, rtol=1e-6, atol=1e-7)
    plain = joined(simulate_blocks(replace(rig, effects=()), 5.0, **quiet).blocks)
    swing = short[3] - plain[3]  # of the angle: amplitude 0.02 * 5 rad/s over 2 pi 20 Hz
    assert np.ptp(swing) == pytest.approx(2 * 0.1 / (2 * np.pi * 20.0), rel=1e-2)
    assert np.std(short[1] - plain[1]) > 0.4  # the hum on the acceleration


def test_effects_that_need_the_whole_run_are_refused_by_name():
    hum = replace(THESIS, effects=(LawSpec("clipping", {}),))
    with pytest.raises(ParameterError, match="clipping: acts on a run as a whole"):
        simulate_blocks(hum, 2.0, seconds=0.4)


@pytest.mark.parametrize("block", [7, 100, 1000])
def test_convolution_in_blocks_is_convolution(block):
    rng = np.random.default_rng(0)
    signal, responses = rng.standard_normal(1000), [rng.standard_normal(n) for n in (1, 300)]
    stream = Convolution(responses)
    parts = [stream(signal[i : i + block]) for i in range(0, 1000, block)]
    for i, response in enumerate(responses):
        got = np.concatenate([part[i] for part in parts])
        assert got == pytest.approx(convolve(signal, response), abs=1e-11)


@pytest.mark.parametrize("factor", [1, 2, 3, 8])
@pytest.mark.parametrize("block", [7, 100, 6000])
def test_decimation_in_blocks_is_that_of_the_whole_signal(factor, block):
    signal = np.random.default_rng(0).standard_normal(6000).cumsum()
    stream = Decimation(factor, skip=600)
    got = np.concatenate([stream(signal[i : i + block]) for i in range(0, 6000, block)])
    expected = resample_poly(signal, 1, factor, padtype="line") if factor > 1 else signal
    expected = expected[600 // factor :]
    assert got.size == expected.size - stream.lookahead // factor
    assert got == pytest.approx(expected[: got.size], abs=1e-10)


def test_a_long_run_is_written_as_any_recording(tmp_path):
    path = write_run(tmp_path / "deep" / "run07", simulate_blocks(MEMORY, 5.0, seconds=0.3))
    back = read_recording(path)
    direct = joined(simulate_blocks(MEMORY, 5.0, seconds=0.3).blocks)
    assert path == tmp_path / "deep" / "run07.wav"
    assert np.array_equal(back.samples, direct.astype(np.float32))
    assert back.condition.speed == 5.0
    assert json.loads(path.with_suffix(".json").read_text())["calibrated"] is True


def test_a_run_that_fails_on_its_way_leaves_no_file(tmp_path):
    def failing():
        yield np.zeros((1, 100))
        raise ParameterError("the motion grows without bound")

    about = Recording(np.zeros((1, 0)), 30e3, (Channel("torque"),))
    with pytest.raises(ParameterError, match="without bound"):
        write_blocks(tmp_path / "run", failing(), 200, about)
    with pytest.raises(ParameterError, match="100 samples arrived, expected 200"):
        write_blocks(tmp_path / "run", iter([np.zeros((1, 100))]), 200, about)
    with pytest.raises(ParameterError, match="'torque' holds samples that are not finite"):
        write_blocks(tmp_path / "run", iter([np.full((1, 100), np.nan)]), 100, about)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads the process's peak from /proc")
@pytest.mark.parametrize("material", ["fluorocarbon-thesis", "fluorocarbon"])
def test_memory_stays_below_300_MB_and_does_not_grow(tmp_path, material):  # noqa: N802
    code = f"""
from pathlib import Path
from models.rig_file import load_material_rig
from models.transfer_functions.filtering import convolve
from noise.long_run import write_run
from sim.long_run import simulate_blocks
peaks, rig = [], load_material_rig({material!r})
for seconds in (20.0, 90.0):
    write_run({str(tmp_path / "run")!r}, simulate_blocks(rig, 2.5, seconds=seconds))
    status = Path("/proc/self/status").read_text()
    peaks.append(int(status.split("VmHWM:")[1].split()[0]) / 1024)
print(*peaks)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    short, long = map(float, done.stdout.split())
    assert long < 300.0
    assert long < short + 10.0
