"""What mounts, amplifiers and clocks make of the signals."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from sim.effects import EFFECTS
from tests.helpers.sensor_signals import RATE, random_signals, read, rms, tone

# Mount.


def reading(at, form, **parameters):
    """Measured gain at a frequency, its transient gone."""
    true = tone(at)
    signals = {"acceleration": true}
    changed = read(signals, "mount_resonance", form=form, **parameters)["acceleration"]
    return rms(changed[-9600:]) / rms(true[-9600:])


def expected_reading(frequency, form, amount, mode, damping):
    s = 1j * frequency / mode

    def inertial(s):
        return s**2 / (s**2 + 2.0 * damping * s + 1.0)

    lost = {
        "single": inertial(s),
        "double": (2.0 * inertial(s) + inertial(s / 2.3)) / 3.0,
        "roll_off": 1.0 - 1.0 / ((s**2 + 2.0 * damping * s + 1.0) * (1.0 + 0.5 * s)),
    }[form]
    return abs(1.0 - amount * lost)


@pytest.mark.parametrize("form", EFFECTS["mount_resonance"].forms)
@pytest.mark.parametrize("frequency", [100.0, 1e3, 4e3, 5e3, 6e3])
@pytest.mark.parametrize("amount", [0.2, 1.0])
def test_the_reading_of_a_mounted_sensor_is_that_of_the_equation(form, frequency, amount):
    given = {"amount": amount, "frequency": 5e3, "damping_ratio": 0.1}
    expected = expected_reading(frequency, form, amount, 5e3, 0.1)
    assert reading(frequency, form, **given) == pytest.approx(expected, rel=0.04)


# Clipping.


@given(
    amount=st.floats(1e-4, 0.95), form=st.sampled_from(EFFECTS["clipping"].forms),
    mean=st.floats(-20.0, 20.0), seed=st.integers(0, 99),
)  # fmt: skip
@settings(max_examples=60)
def test_every_form_cuts_the_same_share_of_the_peak(amount, form, mean, seed):
    signal = mean + np.random.default_rng(seed).standard_normal(500)
    peak, offset = np.abs(signal).max(), abs(signal.mean())
    clipped = read({"torque": signal}, "clipping", form=form, amount=amount)["torque"]
    at_peak = np.abs(clipped[np.argmax(np.abs(signal))])
    assert at_peak == pytest.approx(peak - amount * (peak - offset), rel=1e-6)
    assert np.all(np.diff(clipped[np.argsort(signal)]) >= 0.0)  # order is kept
    reversed_ = read({"torque": -signal}, "clipping", form=form, amount=amount)["torque"]
    assert np.array_equal(reversed_, -clipped)


# Gain.


@pytest.mark.parametrize(("error", "share"), [(-0.9, 1.0), (0.3, -0.5), (2.0, 0.0)])
def test_a_constant_error_of_gain_is_a_factor_and_a_drift_grows_to_it(error, share):
    signals = random_signals()
    changed = read(signals, "gain_error", error=error, torque=share)
    assert changed["torque"] == pytest.approx((1.0 + error * share) * signals["torque"])
    assert changed["pressure"] == pytest.approx((1.0 + error) * signals["pressure"])
    assert np.array_equal(changed["angle"], signals["angle"])
    drifting = read({"torque": np.full(1001, 8.0)}, "gain_error", form="drift", error=error)
    assert drifting["torque"][[0, 500, 1000]] == pytest.approx(
        [8.0, 8.0 + 4.0 * error, 8.0 + 8.0 * error]
    )


@pytest.mark.parametrize("error", [-0.5, 0.8])
def test_a_shelf_is_right_for_slow_signals_and_wrong_for_fast_ones(error):
    def gain(frequency):
        true = {"pressure": tone(frequency)}
        changed = read(true, "gain_error", form="shelf", error=error, corner=1e3)["pressure"]
        return rms(changed[-9600:]) / rms(true["pressure"][-9600:])

    assert gain(20.0) == pytest.approx(1.0, abs=2e-3)
    assert gain(20e3) == pytest.approx(1.0 + error, rel=5e-3)
    at_the_corner = abs((1.0 + (1.0 + error) * 1j) / (1.0 + 1j))
    assert gain(1e3) == pytest.approx(at_the_corner, rel=5e-3)


# Delay.


def lateness(true, changed, frequency):
    """Delay of a tone by its phase [s]."""
    kernel = np.exp(-2j * np.pi * frequency * np.arange(true.size) / RATE)
    return np.angle(np.sum(true * kernel) / np.sum(changed * kernel)) / (2.0 * np.pi * frequency)


@pytest.mark.parametrize("delay", [1.3e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("frequency", [200.0, 2e3, 4e3])
def test_a_constant_delay_may_be_a_fraction_of_a_sample(delay, frequency):
    true = tone(frequency)
    changed = read({"pressure": true}, "channel_delay", delay=delay)["pressure"]
    assert lateness(true[480:-480], changed[480:-480], frequency) == pytest.approx(delay, rel=1e-3)


def test_a_wrong_sampling_rate_scales_the_frequency():
    true = tone(1000.0, seconds=1.0)
    changed = read({"pressure": true}, "channel_delay", form="drift", delay=0.01)["pressure"]
    time = np.arange(true.size) / RATE
    assert changed == pytest.approx(np.sin(2.0 * np.pi * 990.0 * time), abs=1e-2)


def test_jitter_has_the_rms_of_the_delay_and_no_mean():
    ramp = {"pressure": np.arange(960_000) / RATE}
    changed = read(ramp, "channel_delay", form="jitter", delay=1e-3, bandwidth=50.0)["pressure"]
    late = (ramp["pressure"] - changed)[1000:-1000]
    assert late.std() == pytest.approx(1e-3, rel=0.1)
    assert abs(late.mean()) < 2e-4
