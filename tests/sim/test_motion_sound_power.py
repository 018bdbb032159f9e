"""Sound power of runs: of torques whose power is known, and of slips."""

from dataclasses import replace

import numpy as np
import pytest

from models.bench import HIGHEST_PLATE_FREQUENCY
from models.condition import FIXED
from models.errors import ParameterError
from models.radiation.rig_response import anchor_drives, first_mode_damping
from models.rig_file import load_material_rig
from models.structure.beams import ANCHOR_FORCE, ANCHOR_MOMENT, TORQUE, beam_length, beam_structure
from models.structure.plate import plate_modes
from noise.audio.assessment import POWER_COLUMNS, sound_power_rows
from sim.analysis.sound_power import motion_sound_power, radiated_spectrum
from sim.run import simulate

BENCH = load_material_rig("PDMS")
RIG = replace(BENCH, plate=replace(BENCH.plate, thickness=0.02, loss_factor=0.1))
FREQUENCY, AMPLITUDE = 700.0, 0.3
MODES = plate_modes(RIG.plate, HIGHEST_PLATE_FREQUENCY)


def tone(time, amplitude=AMPLITUDE):
    return 8.0 + amplitude * np.sin(2 * np.pi * FREQUENCY * time)


def power_of(support, torque=tone, *, seconds=0.5):
    """Of a run whose torque is replaced by a tone about a mean, or another one."""
    motion = simulate(RIG, 5.0, support_stiffness=support, seconds=seconds).motion
    time = np.arange(motion.torque.size) / motion.rate
    return motion_sound_power(
        RIG,
        replace(motion, torque=torque(time)),
        interference=0.279e-3,
        support_stiffness=support,
    )


def rms_drives(support):
    """Drives of the plate and their root mean square spectra, for the tone."""
    rms = AMPLITUDE / np.sqrt(2)
    if support == FIXED:
        x, y = RIG.plate.clamp_position
        return MODES.slope([x], [y]).T, [rms]
    ratio = first_mode_damping(RIG, 0.279e-3, support)
    beams = beam_structure(RIG.beams, support, RIG.clamp_inertia, ratio, HIGHEST_PLATE_FREQUENCY)
    passed = beams.frequency_response([FREQUENCY])[[ANCHOR_FORCE, ANCHOR_MOMENT], TORQUE, 0]
    arm = RIG.beams.lever + beam_length(RIG.beams, support)
    return anchor_drives(MODES, arm), rms * passed


@pytest.mark.parametrize("support", [2214.0, 3745.0, FIXED])
def test_a_tone_of_torque_radiates_what_its_drives_radiate(support):
    power = power_of(support)
    drives, rms = rms_drives(support)
    (exact,) = radiated_spectrum(MODES, drives, np.reshape(rms, (1, -1, 1)), np.array([FREQUENCY]))
    band = np.argmin(np.abs(np.log(power.centre / FREQUENCY)))
    # A line is taken to lie in the middle of its cell, half a resonance wide.
    assert 10 * np.log10(power.radiated[band] / exact) == pytest.approx(0, abs=1.0)
    assert power.radiated[band] == pytest.approx(power.radiated.sum(), rel=1e-3)


def test_a_constant_torque_is_silent_and_its_table_is_empty():
    power = power_of(2214.0, lambda time: np.full(time.size, 8.0))
    rows = sound_power_rows(power)
    assert {row[name] for row in rows for name in POWER_COLUMNS[1:]} == {None}


def test_bands_beyond_the_modes_are_refused():
    small = {"length": 0.1, "width": 0.08, "thickness": 0.012, "clamp_position": (0.0, 0.0)}
    stiff = replace(RIG, plate=replace(RIG.plate, **small))
    motion = simulate(RIG, 5.0, support_stiffness=FIXED, seconds=0.3).motion
    with pytest.raises(ParameterError, match="reach beyond the plate's modes"):
        motion_sound_power(stiff, motion, interference=0.279e-3, support_stiffness=FIXED)


def test_a_run_too_short_for_the_lowest_band_is_refused():
    with pytest.raises(ParameterError, match=r"lasts 0\.1 s; it must last 0\.25 s or more"):
        power_of(2214.0, seconds=0.1)
