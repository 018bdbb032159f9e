"""Further forms of the effects, drawn for the diagnosis to learn from."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.radiation.impulse_responses import radiate
from models.rig_file import load_material_rig
from noise.diagnosis.cases.draws import drawn_curve
from noise.training.causes.cases.draw import draw_case
from noise.training.causes.cases.structures import draw_structure
from noise.training.causes.cases.variants import VARIANTS, draw_variant
from sim.bushing import lumped_bushing
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS
from sim.effects.effect import Stage
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

RIG = load_material_rig("fluorocarbon-thesis")
RATE = 75e3
PLAIN_CHAIN = draw_structure(
    lumped_bushing(RIG, 0.279e-3, 3745.0), np.random.default_rng(1)
).response(RATE)
RECIPES = [
    pytest.param(name, recipe, id=f"{name}-{i}")
    for name, recipes in VARIANTS.items()
    for i, recipe in enumerate(recipes)
]
CHANNELS = ("torque", "acceleration", "pressure")


def played(effect=None):
    effects = [] if effect is None else [effect.active({})]
    rng = np.random.default_rng(3)
    motion = simulate_motion(
        RIG, ConstantSpeed(1.0), interference=0.279e-3, support_stiffness=3745.0, seconds=0.2,
        rate=RATE, effects=effects, rng=rng,
    )  # fmt: skip
    force = np.zeros_like(motion.torque)
    if effect is not None and effect.force is not None:
        force = effect.force(motion, effect.forms[0], effects[0].values)
    chain = apply_chain_effects(PLAIN_CHAIN, effects, np.random.default_rng(5))
    parts = (radiate(chain, motion.torque), radiate(chain, force, "pulse"))
    acceleration, pressure = (sum(each) for each in zip(*parts, strict=True))
    signals = {"torque": motion.torque, "acceleration": acceleration, "pressure": pressure}
    if effect is not None and effect.sensors is not None:
        signals = effects[0].apply_sensors(signals, RATE, rng)
    return signals


PLAIN = played()


def change(signals, name):
    return float(np.std(signals[name] - PLAIN[name]) / np.std(PLAIN[name]))


def test_every_effect_has_many_further_forms_each_of_a_name_of_its_own():
    assert set(VARIANTS) == set(EFFECTS)
    for name, recipes in VARIANTS.items():
        forms = [recipe(1.0, np.random.default_rng(0)).forms[0] for recipe in recipes]
        assert len(set(forms)) == len(forms) >= 7
        assert not set(forms) & set(EFFECTS[name].forms)


@pytest.mark.parametrize(("name", "recipe"), RECIPES)
def test_a_variant_of_strength_zero_is_the_plain_run(name, recipe):
    effect = recipe(0.0, np.random.default_rng(0))
    assert effect.active({}).is_off
    signals = played(effect)
    # The general solver stands beside the plain one to its own tolerance.
    assert max(change(signals, channel) for channel in CHANNELS) < 1e-3


@pytest.mark.parametrize(("name", "recipe"), RECIPES)
def test_a_strong_variant_changes_what_its_stage_reaches_and_nothing_before(name, recipe):
    effect = recipe(1.0, np.random.default_rng(10))
    assert (effect.name, effect.stage) == (name, EFFECTS[name].stage)
    signals = played(effect)
    assert all(np.isfinite(x).all() for x in signals.values())
    if effect.stage in (Stage.DRIVE, Stage.FRICTION):
        assert change(signals, "torque") > 0.01
        return
    if effect.stage is Stage.STRUCTURE:
        assert change(signals, "torque") == 0.0
        assert max(change(signals, "acceleration"), change(signals, "pressure")) > 0.003
    elif effect.stage is Stage.RADIATION:
        assert change(signals, "torque") == change(signals, "acceleration") == 0.0
        assert change(signals, "pressure") > 0.003
    else:
        assert max(change(signals, channel) for channel in CHANNELS) > 0.005


def departure(effect):
    """How much a variant does: of contact and drive how soon the torque departs [1/s]."""
    signals = played(effect)
    assert all(np.isfinite(x).all() for x in signals.values())
    if effect.stage not in (Stage.DRIVE, Stage.FRICTION):
        # Where nothing is left in common, more cannot differ more.
        return min(max(change(signals, channel) for channel in CHANNELS), 0.9)
    away = np.abs(signals["torque"] - PLAIN["torque"]) > 0.01 * np.std(PLAIN["torque"])
    return RATE / max(int(np.argmax(away)), 1) if away.any() else 0.0


@pytest.mark.parametrize(("name", "recipe"), RECIPES[::3])
def test_the_stronger_a_variant_the_more_it_does(name, recipe):
    weak, middling, strong = (
        departure(recipe(strength, np.random.default_rng(2))) for strength in (0.03, 0.2, 1.0)
    )
    assert weak <= middling <= strong > 0.0


@pytest.mark.parametrize("name", ["gain_error", "clipping", "channel_delay", "mount_resonance"])
def test_a_channel_without_a_share_is_read_as_it_is(name):
    untouched = 0
    for seed in range(8):
        signals = played(draw_variant(name, 1.0, np.random.default_rng(seed)))
        untouched += sum(signals[channel] is not None and change(signals, channel) == 0.0
                         for channel in CHANNELS)  # fmt: skip
    assert 0 < untouched < 24


@given(st.integers(0, 2**31))
@settings(max_examples=50)
def test_a_drawn_curve_rises_from_nothing_to_one(seed):
    table = drawn_curve(np.random.default_rng(seed))
    assert table[0] == table.size - 1
    assert table[1] == 0.0
    assert table[-1] == pytest.approx(1.0)
    assert np.diff(table[1:]).min() >= -1e-12


def test_a_case_may_have_a_form_that_the_simulator_lacks():
    forms = [
        form not in EFFECTS[name].forms
        for seed in range(5)
        for truth in [draw_case(seed).truth]
        if truth.kind != "unknown"
        for name, form in zip(truth.effects, truth.forms, strict=True)
    ]
    assert any(forms)
    assert not all(forms)
