"""Every effect in every form on the rig: off it is nothing, little of it little, a seed decides."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.base.remarks import effect_remarks
from sim.acquisition import Acquisition
from sim.effects import EFFECTS
from sim.run import simulate

CASES = [(name, form) for name in EFFECTS for form in EFFECTS[name].forms]


@lru_cache
def run(name=None, form="", share=1.0, seed=0, speed=1.0, material="fluorocarbon-thesis"):
    """Samples of a run with an effect, its strength a share of the default."""
    effects = ()
    if name is not None:
        effect = EFFECTS[name]
        given = share * effect.parameters[effect.strength].default
        effects = (LawSpec(name, {"form": form, effect.strength: given}),)
    made = simulate(
        replace(load_material_rig(material), effects=effects), speed, support_stiffness=3745.0,
        interference=0.279e-3 if material == "fluorocarbon-thesis" else 0.381e-3,
        seconds=0.15, settling=0.05, acquisition=Acquisition(noise={}),
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    return made.recording.samples


def difference(samples, plain):
    """Largest of the channels' [-]."""
    return (np.abs(samples - plain).max(axis=1) / np.abs(plain).max(axis=1)).max()


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_of_strength_zero_is_the_plain_model_to_the_bit(name):
    np.testing.assert_array_equal(run(name, EFFECTS[name].forms[0], 0.0), run())


@pytest.mark.parametrize(("name", "form"), CASES)
def test_the_default_strength_is_seen_and_little_of_it_is_little(name, form):
    # Blows come of slips that are larger than those of the thesis's own model.
    rig = {"material": "fluorocarbon" if name == "slip_pulse" else "fluorocarbon-thesis"}
    plain = run(**rig)
    full = difference(run(name, form, **rig), plain)
    assert full > 1e-4
    assert difference(run(name, form, 1e-5, **rig), plain) < 0.05 * full + 1e-9


@pytest.mark.parametrize(("name", "form"), CASES)
def test_the_seed_decides_and_nothing_else(name, form):
    np.testing.assert_array_equal(run(name, form), run.__wrapped__(name, form))
    other = run(name, form, seed=1)
    assert np.isfinite(other).all()
    if EFFECTS[name].irregular:
        assert not np.array_equal(other, run(name, form))


@pytest.mark.parametrize("name", [name for name in EFFECTS if EFFECTS[name].contact is not None])
def test_reversing_the_shaft_reverses_what_the_contact_does(name):
    form = EFFECTS[name].forms[0]
    torque, angle = (run(name, form, speed=-1.0)[i] for i in (0, 3))
    assert torque == pytest.approx(-run(name, form)[0], abs=1e-6)
    assert angle == pytest.approx(-run(name, form)[3], abs=1e-9)


@pytest.mark.parametrize("name", EFFECTS)
def test_what_an_effect_does_not_have_is_refused_by_name(name):
    for given, message in (
        ({"form": "none"}, "form 'none' is unknown"),
        ({"no_such": 1.0}, "no parameter 'no_such'"),
        ({EFFECTS[name].strength: 1e99}, "is out of range"),
    ):
        with pytest.raises(ParameterError, match=f"effect '{name}': .*{message}"):
            EFFECTS[name].active(given)


@pytest.mark.parametrize("law", ["lugre", "coulomb"])
@pytest.mark.parametrize("name", [name for name in EFFECTS if EFFECTS[name].contact is not None])
def test_an_effect_acts_where_the_law_reads_what_it_changes(name, law):
    """Creep is of true stick alone."""
    idle = {"partial_slip"} if law == "lugre" else set()
    rig = replace(load_material_rig("PDMS"), friction=LawSpec(law), effects=(LawSpec(name),))
    assert bool(effect_remarks(rig, EFFECTS)) == (name in idle)
