"""What the rig's noises are, as the thesis describes them (5.2.3): in simulated recordings."""

from dataclasses import replace

import numpy as np
import pytest

from features.kernels.harmonics import analyse_harmonics
from features.kernels.levels import third_octave_levels
from features.kernels.lines import find_lines, noise_floor
from features.kernels.spectra import autospectrum
from models.rig_file import load_material_rig
from noise.classifier import load_classifier
from noise.demo import CASES
from noise.labels.segments import file_label, label_recording
from noise.noise_definition import label_by_physics
from sim.effects.slip_pulse import torque_drops
from sim.run import simulate

PRESSURE = 20e-6


@pytest.fixture(scope="module")
def runs():
    return {
        case.name: simulate(
            load_material_rig(case.material),
            case.speed,
            interference=case.interference,
            support_stiffness=case.support_stiffness,
            seconds=2.0,
        )
        for case in CASES
    }


def spectrum(run, channel):
    return autospectrum(run.recording[channel], run.recording.rate)


def lines(run, channel, highest=2000.0):
    return find_lines(spectrum(run, channel), low=20.0, high=highest)


def test_creak_fills_the_bands_from_the_slip_frequency_to_12_5_khz(runs):
    # Slips come at 50 Hz: no harmonic lies in the bands of 40 and 63 Hz.
    nominal = [50, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000]
    nominal += [1250, 1600, 2000, 2500, 3150, 4000, 5000, 6300, 8000, 10000]
    creak, silence = (
        third_octave_levels(
            autospectrum(runs[name].recording["pressure"], 30e3, resolution=2.0),
            reference=PRESSURE,
        )
        for name in ("creak", "none")
    )
    assert all(creak[str(band)] > silence[str(band)] + 10.0 for band in nominal)
    # The last band ends close to half the sampling rate, where third_octave_levels gives none.
    highest = [
        np.mean(spectrum(runs[name], "pressure").density[2800:3500]) for name in ("creak", "none")
    ]
    assert highest[0] > 10.0 * highest[1]


@pytest.mark.parametrize("channel", ["acceleration", "pressure"])
def test_creak_is_largest_right_after_a_slip(runs, channel):
    run = runs["creak"]
    slips = torque_drops(run.motion.torque, 5.2)[0] / run.motion.rate
    signal = run.recording[channel]
    time = np.arange(signal.size) / run.recording.rate
    since = time - slips[np.searchsorted(slips, time, side="right").clip(1) - 1]
    after = (since > 0.0) & (since < 0.004)
    assert signal[after].std() > 1.25 * signal[~after].std()


def test_bolting_the_clamp_down_ends_the_creak():
    rig = load_material_rig("fluorocarbon")
    bolted = simulate(rig, 1.0, interference=0.381e-3, support_stiffness=np.inf)
    assert label_by_physics(bolted) == "squawk"
    assert not bolted.pulse_pressure.any()


@pytest.mark.parametrize("channel", ["torque", "acceleration", "pressure"])
def test_squawk_has_the_same_several_harmonics_in_all_three_signals(runs, channel):
    slip_frequency = analyse_harmonics(runs["squawk"].recording["torque"], 30e3).fundamental
    found = spectrum(runs["squawk"], channel)
    floor = noise_floor(found)
    for k in (1, 2, 3, 4):  # slips that are not quite periodic smear those above
        near = np.abs(found.frequency - k * slip_frequency) < 6.0
        assert 10 * np.log10((found.density / floor)[near].max()) > 20.0


def test_squeal_has_one_predominant_peak_at_the_elastomers_mode_in_all_three_signals(runs):
    peaks = [lines(runs["squeal"], channel) for channel in ("torque", "acceleration", "pressure")]
    assert all(found.strongest_share > 0.9 for found in peaks)
    assert np.ptp([found.frequency[0] for found in peaks]) < 2.0
    assert 900.0 < peaks[0].frequency[0] < 1150.0


@pytest.mark.parametrize("interference", [0.254e-3, 0.381e-3])
@pytest.mark.parametrize("stiffness", [2214.0, np.inf])
@pytest.mark.parametrize("speed", [0.25, 5.0, 17.0])
def test_pdms_is_silent_everywhere(interference, stiffness, speed):
    run = simulate(
        load_material_rig("PDMS"),
        speed,
        interference=interference,
        support_stiffness=stiffness,
        seconds=0.5,
    )
    assert label_by_physics(run) == "none"


@pytest.mark.parametrize("name", ["creak", "squawk", "squeal"])
@pytest.mark.parametrize(
    "kept", [["pressure"], ["torque"], ["acceleration"], ["torque", "acceleration"]]
)
def test_a_noise_is_known_from_any_subset_of_the_channels(runs, name, kept):
    recording = runs[name].recording
    rows = [recording.channel_names.index(channel) for channel in kept]
    part = replace(
        recording,
        samples=recording.samples[rows],
        channels=tuple(recording.channels[row] for row in rows),
    )
    assert file_label(label_recording(part, load_classifier())).label == name
