"""Recordings are made ready: what is settled stays, a start goes, and sensors are as they show."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.condition import KnownCondition
from models.recording import Channel, Recording
from models.sensors import Sensor, Sensors
from noise.diagnosis.prepare import HIGHEST_RATE, LONGEST, at_measured_speeds, bounded
from noise.diagnosis.sensors import converter_step, estimated_noise, with_estimated_sensors
from noise.diagnosis.starts import settled_parts, shortest, start_of
from sim.acquisition import Acquisition
from tests.helpers.small_rigs import RIG

RATE = 30e3
TIME = np.arange(24_000) / RATE
USUAL = Acquisition().noise


def turning(factor, speed=2.0, *, noise=1e-4, step=0.0, seed=0, **more):
    """A shaft whose speed is a factor of what was set, over time."""
    angle = np.cumsum(speed * factor) / RATE
    angle = angle - angle[0] + noise * np.random.default_rng(seed).standard_normal(angle.size)
    angle = step * np.round(angle / step) if step else angle
    at = KnownCondition(speed, 0.279e-3, 2214.0)
    return Recording(angle[None], RATE, (Channel("angle"),), at, **more)


def stick_slip(scale=5.0, seed=0, seconds=0.8):
    """A torque that rises steadily and falls at once, as of a shaft that sticks and slips."""
    t = np.arange(round(seconds * RATE)) / RATE
    return 10.0 - 2.0 + 4.0 * np.mod(t * scale * (1.0 + 1e-3 * seed), 1.0)


def through(x, kind="torque", noise=0.0, step=0.0, seed=0):
    """A signal through a sensor, kept in 32 bits."""
    x = x + noise * np.random.default_rng(seed).standard_normal(x.size)
    x = step * np.round(x / step) if step else x
    at = KnownCondition(2.0, 0.279e-3, 2214.0)
    samples = x.astype(np.float32).astype(np.float64)[None]
    return Recording(samples, RATE, (Channel(kind),), at)


STARTS = {
    "rest": lambda size: np.minimum(TIME / (0.02 + 0.04 * size), 1.0),
    "run_up": lambda size: 0.4 + 0.6 * np.minimum(TIME / (0.15 + 0.25 * size), 1.0),
    "swing": lambda size: (
        1.0 + (0.2 + 0.2 * size) * np.exp(-TIME / 0.05) * np.sin(2 * np.pi * 8.0 * TIME)
    ),
}


@pytest.mark.parametrize("name", STARTS)
@pytest.mark.parametrize("sensor", [(1e-4, 0.0), (4e-4, 0.0), (1e-4, 6e-3)])
@given(size=st.floats(0.0, 1.0), speed=st.floats(0.6, 10.0), back=st.booleans())
def test_what_is_left_turns_evenly(name, sensor, size, speed, back):
    factor = STARTS[name](size)
    noise, step = sensor
    run = turning(factor, -speed if back else speed, noise=noise, step=step)
    start = start_of(run)
    if name != "rest" or step == 0.0:  # a ramp of less than a step does not show in the angle
        assert start > 0.0
    if start:
        assert np.abs(factor[round(start * RATE) :] - 1.0).max() < 0.05
        assert start < 0.6


@given(
    depth=st.floats(0.0, 0.3),
    frequency=st.floats(3.0, 60.0),
    phase=st.floats(0.0, 6.3),
    speed=st.floats(0.6, 10.0),
)
def test_a_speed_that_swings_all_the_time_stays_to_the_bit(depth, frequency, phase, speed):
    factor = 1.0 + depth * np.sin(2.0 * np.pi * frequency * TIME + phase)
    run = turning(factor, speed)
    parts, notes, refused = settled_parts([run])
    assert parts[0] is run
    assert not notes
    assert not refused


def test_a_torque_that_rises_from_zero_tells_a_start_without_an_angle():
    torque = stick_slip(60.0) * np.minimum(TIME / 0.02, 1.0)
    assert 0.01 < start_of(through(torque, noise=0.005)) < 0.05
    assert start_of(through(stick_slip(60.0), noise=0.005)) == 0.0


def test_repeats_of_a_condition_keep_one_length_and_end_with_the_recording():
    runs = [turning(STARTS["run_up"](size), name=f"run{size}") for size in (0.2, 0.5)]
    parts, notes, _ = settled_parts(runs)
    assert parts[0].samples.shape == parts[1].samples.shape
    for run, part in zip(runs, parts, strict=True):
        left = run.samples[0, -part.samples.shape[1] :]
        assert part.samples[0] == pytest.approx(left - left[0], abs=1e-12)
    (note,) = notes
    assert note.startswith("run0.2 and run0.5: the first ")
    assert "comes to its speed" in note


def test_a_start_that_leaves_too_little_is_refused_unless_all_would_be():
    short = round((shortest(RATE) + 0.1) * RATE)
    late = turning(np.minimum(TIME / 0.13, 1.0))
    late = replace(late, samples=late.samples[:, :short])
    even = turning(np.ones(24_000))
    parts, _, refused = settled_parts([late, even])
    assert list(refused) == [0]
    assert "comes to its speed only" in refused[0]
    assert parts[0] is even
    parts, _, refused = settled_parts([late])
    assert not refused
    assert parts[0].duration == pytest.approx(shortest(RATE), abs=1e-3)


@given(off=st.floats(-0.03, 0.03), step=st.sampled_from([0.0, 6e-3]))
def test_repeats_get_the_mean_speed_of_their_angles_where_the_stated_one_is_off(off, step):
    runs = [turning((1.0 + off) * np.full(24_000, f), step=step) for f in (0.998, 1.002)]
    timed, notes = at_measured_speeds(runs)
    assert timed[0].condition == timed[1].condition
    speed = timed[0].condition.speed
    if notes:
        assert speed == pytest.approx(2.0 * (1.0 + off), rel=2e-3)
        assert abs(speed / 2.0 - 1.0) > 0.005
    else:
        assert speed == 2.0
        assert abs(off) < 0.007


@given(
    bits=st.integers(12, 16),
    span=st.floats(5.0, 200.0),
    noise=st.floats(0.1, 3.0),
    seed=st.integers(0, 99),
)
def test_a_converters_step_is_found_to_a_ten_thousandth(bits, span, noise, seed):
    step = 2.0 * span / 2.0**bits
    sound = 0.4 * span * np.sin(2.0 * np.pi * 137.0 * TIME)
    runs = [through(sound, noise=noise * step, step=step, seed=seed + i) for i in range(2)]
    assert converter_step(runs, "torque") == pytest.approx(step, rel=1e-4)


@given(
    times=st.floats(0.3, 4.0),
    step=st.sampled_from([0.0, 0.5, 2.0]),
    slips=st.floats(20.0, 100.0),
    kind=st.sampled_from(sorted(USUAL)),
)
def test_noise_is_found_between_slips(times, step, slips, kind):
    level = times * USUAL[kind]
    size = 1000.0 * USUAL[kind] / 4.0
    runs = [
        through(size * stick_slip(slips, i), kind, level, step * level, seed=i) for i in range(3)
    ]
    found = estimated_noise(runs, kind, step * level)
    assert found == pytest.approx(level, rel=0.25)


def test_a_sensor_is_as_noisy_as_all_recordings_are_unless_the_rig_file_states_less():
    quiet, loud = USUAL["pressure"], 16.0 * USUAL["pressure"]
    one_loud = [
        through(np.zeros(24_000), "pressure", x, seed=i) for i, x in enumerate((loud, quiet, quiet))
    ]
    seen, _ = with_estimated_sensors(RIG, one_loud)
    assert seen.sensors.of("pressure").noise == pytest.approx(quiet, rel=0.15)
    all_loud = [through(np.zeros(24_000), "pressure", loud, seed=i) for i in range(3)]
    seen, _ = with_estimated_sensors(RIG, all_loud)
    assert seen.sensors.of("pressure").noise == pytest.approx(loud, rel=0.15)
    stated = replace(RIG, sensors=Sensors({"pressure": Sensor(noise=quiet)}))
    assert with_estimated_sensors(stated, all_loud)[0].sensors.of("pressure").noise == quiet


def _tone(rate, seconds, frequency=1000.0):
    time = np.arange(round(seconds * rate)) / rate
    samples = np.sin(2 * np.pi * frequency * time)[np.newaxis]
    return Recording(samples, rate, (Channel("torque"),))


@settings(max_examples=20)
@given(rate=st.sampled_from([8e3, 30e3, 51.2e3, 65.536e3, 96e3, 192e3]), seconds=st.floats(0.3, 4))
def test_no_recording_is_longer_or_finer_than_is_looked_at(rate, seconds):
    before = _tone(rate, seconds)
    rig, (after,), notes = bounded(RIG, [before])
    assert after.rate <= HIGHEST_RATE
    assert after.duration <= LONGEST + 1 / after.rate
    assert after.duration == pytest.approx(min(before.duration, LONGEST), abs=2 / after.rate)
    assert len(notes) == (rate > HIGHEST_RATE) + (before.duration > LONGEST)
    if not notes:
        assert after is before
        assert rig is RIG


def test_the_noise_of_a_thinned_sensor_is_what_is_left_of_it():
    rng = np.random.default_rng(0)
    stated = Sensors({"torque": Sensor(noise=0.3, full_scale=2.0, bits=4)})
    rounded = 0.25 * np.round(1.2 * rng.standard_normal((1, 192_000)))
    rig, (kept,), _ = bounded(
        replace(RIG, sensors=stated), [Recording(rounded, 96e3, (Channel("torque"),))]
    )
    assert rig.sensors.of("torque").step == 0.0
    assert rig.sensors.of("torque").noise == pytest.approx(kept.samples.std(), rel=0.1)
