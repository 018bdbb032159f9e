"""What structure, plate and room have besides the model's modes and the direct sound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from models.radiation.rig_response import impulse_responses
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.acquisition import Acquisition
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter
from sim.run import simulate
from tests.helpers.spectra import path_spectra

RATE = 96e3
RIG = load_material_rig("fluorocarbon")
QUIET = Acquisition(noise={})


def changed(paths, name, seed=0, **parameters):
    active = EFFECTS[name].active(parameters)
    return apply_chain_effects(paths, [active], np.random.default_rng(seed))


def spectra(*signals, n=2**17):
    """Frequencies from 300 Hz to 18 kHz, and the spectrum of each signal there."""
    frequency = np.fft.rfftfreq(n, 1 / RATE)
    kept = (frequency > 300.0) & (frequency < 18e3)
    return frequency[kept], *(np.fft.rfft(signal, n)[kept] for signal in signals)


@pytest.fixture(scope="module")
def plain():
    return impulse_responses(RIG, 0.381e-3, 2214.0, RATE, seconds=0.1)


@pytest.mark.parametrize("name", ["plate_modes", "room_reflections"])
@pytest.mark.parametrize("strength", [0.5, 3.0])
def test_radiation_leaves_torque_and_acceleration_alone(name, strength):
    for form in EFFECTS[name].forms:
        spec = LawSpec(name, {"form": form, "amount": strength})
        one, other = (
            simulate(replace(RIG, effects=effects), 5.0, seconds=0.1, settling=0.0).recording
            for effects in (RIG.effects, (*RIG.effects, spec))
        )
        assert np.array_equal(one["torque"], other["torque"])
        assert np.array_equal(one["acceleration"], other["acceleration"])
        assert not np.allclose(one["pressure"], other["pressure"], rtol=0.01)


def test_an_effect_of_the_users_own_can_change_the_chain():
    def half(paths, form, values, rng):
        return replace(paths, torque_to_pressure=(1.0 - values["loss"]) * paths.torque_to_pressure)

    mine = Effect(
        "foam", Stage.RADIATION, ("plain",), {"loss": Parameter(0.5, "", 0.0, 1.0, "of sound")},
        "loss", chain=half,
    )  # fmt: skip
    specs = (LawSpec("foam", {}),)
    rig = replace(RIG, effects=specs)
    how = {"seconds": 0.1, "settling": 0.0, "acquisition": QUIET}
    damped = simulate(rig, 5.0, library={"foam": mine}, **how).recording["pressure"]
    loud = simulate(replace(RIG, effects=()), 5.0, **how).recording["pressure"]
    assert damped == pytest.approx(0.5 * loud, abs=1e-12)


# Further modes of clamp and beams


def test_a_further_mode_stands_out_in_acceleration_and_sound(plain):
    louder = changed(plain, "beam_modes", constant=20.0)
    frequency = np.array([4500.0])
    before, after = (path_spectra(each, frequency) for each in (plain, louder))
    added = after.torque_to_acceleration - before.torque_to_acceleration
    assert np.abs(added) == pytest.approx(20.0 / (2 * 0.01), rel=1e-4)
    heard = after.torque_to_pressure - before.torque_to_pressure
    expected = 0.04 * np.abs(added) * np.abs(before.pulse_to_pressure)
    assert np.abs(heard) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("form", "expected"),
    [("single", [900]), ("pair", [900, 1200]), ("ladder", [900, 2500, 4900, 8100, 12100, 16900])],
)
def test_forms_of_beam_modes_have_their_frequencies(plain, form, expected):
    louder = changed(plain, "beam_modes", form=form, frequency=900.0, damping_ratio=0.002)
    frequency, after, before = spectra(louder.torque_to_acceleration, plain.torque_to_acceleration)
    added = np.abs(after - before)
    peaks = np.flatnonzero((added[1:-1] > added[:-2]) & (added[1:-1] > added[2:])) + 1
    strong = peaks[added[peaks] > 10.0 * np.median(added)]
    assert frequency[strong] == pytest.approx(expected, abs=6.0)


def test_with_the_clamp_bolted_down_there_are_no_beams_to_have_modes():
    bolted = impulse_responses(RIG, 0.381e-3, FIXED, RATE, seconds=0.1)
    assert changed(bolted, "beam_modes", amount=50.0) is bolted


# Further resonances of what radiates


def test_a_lonely_resonance_adds_6_db_where_it_is_and_nothing_far_away(plain):
    louder = changed(plain, "plate_modes", frequency=2000.0)
    frequency = np.array([200.0, 2000.0, 15e3])
    before, after = (path_spectra(each, frequency) for each in (plain, louder))
    for path in ("torque_to_pressure", "pulse_to_pressure"):
        gain = 20 * np.log10(np.abs(getattr(after, path) / getattr(before, path)))
        assert gain == pytest.approx([0.0, 6.02, 0.0], abs=0.02)
