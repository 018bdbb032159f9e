"""What structure, plate and room have besides the model's modes and the direct sound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.radiation.impulse_responses import radiate
from models.radiation.rig_response import impulse_responses
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.acquisition import Acquisition
from sim.blocks import simulate_blocks
from sim.chain import changed_chain
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter
from sim.run import simulate
from tests.helpers.chain_paths import RATE, changed

RIG = load_material_rig("fluorocarbon")
CHAIN = ("beam_modes", "plate_modes", "room_reflections")
EVERY_FORM = [(name, form) for name in CHAIN for form in EFFECTS[name].forms]
PATHS = ("torque_to_acceleration", "torque_to_pressure", "pulse_to_acceleration",
         "pulse_to_pressure")  # fmt: skip
QUIET = Acquisition(noise={})


@pytest.fixture(scope="module")
def plain():
    return impulse_responses(RIG, 0.381e-3, 2214.0, RATE, seconds=0.1)


def padded(signal, size):
    return np.pad(signal, (0, max(0, size - signal.size)))


def difference(one, other, path):
    """Largest difference of a path, relative to the path in `other`."""
    first, second = getattr(one, path), getattr(other, path)
    size = max(first.size, second.size)
    return np.abs(padded(first, size) - padded(second, size)).max() / np.abs(second).max()


@pytest.mark.parametrize(("name", "form"), EVERY_FORM)
def test_what_is_added_is_proportional_to_the_strength(plain, name, form):
    single, double = (
        changed(plain, name, form=form, **{EFFECTS[name].strength: strength})
        for strength in (0.5, 1.0)
    )
    for path in PATHS:
        base = padded(getattr(plain, path), getattr(single, path).size)
        first, second = getattr(single, path) - base, getattr(double, path) - base
        assert np.abs(second - 2.0 * first).max() <= 1e-12 * np.abs(base).max()


@pytest.mark.parametrize(("name", "form"), EVERY_FORM)
def test_pressure_is_linear_in_the_torque(plain, name, form):
    paths = changed(plain, name, form=form)
    rng = np.random.default_rng(0)
    one, two = rng.standard_normal((2, 2000))
    parts = [radiate(paths, signal) for signal in (one, two)]
    for i, both in enumerate(radiate(paths, 2.0 * one - 3.0 * two)):
        expected = 2.0 * parts[0][i] - 3.0 * parts[1][i]
        assert np.abs(both - expected).max() <= 1e-9 * np.abs(expected).max()


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


# In blocks, and together


@pytest.mark.parametrize("names", [(name,) for name in CHAIN] + [CHAIN])
def test_runs_in_blocks_have_the_effects_as_well(names):
    forms = {"plate_modes": "scattered", "room_reflections": "diffuse"}
    specs = [LawSpec(name, {"form": forms[name]} if name in forms else {}) for name in names]
    rig = replace(RIG, effects=(*RIG.effects, *specs))
    how = {"interference": 0.381e-3, "seconds": 0.4, "settling": 0.1, "acquisition": QUIET}
    one = simulate(rig, 2.5, rng=np.random.default_rng(7), **how).recording.samples
    run = simulate_blocks(rig, 2.5, rng=np.random.default_rng(7), block_seconds=0.11, **how)
    joined = np.concatenate(list(run.blocks), axis=1)
    inner = slice(12, -600)
    for row, expected in zip(joined, one, strict=True):
        assert np.abs(row - expected)[inner].max() < 1e-9 * np.abs(expected).max()


def test_the_order_in_which_they_are_named_does_not_matter(plain):
    steady = [EFFECTS[name].active({}) for name in CHAIN]
    rng = np.random.default_rng(0)
    one, other = changed_chain(plain, steady, rng), changed_chain(plain, steady[::-1], rng)
    for path in PATHS:
        assert difference(one, other, path) < 1e-12


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
