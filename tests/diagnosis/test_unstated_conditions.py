"""Conditions that a sidecar leaves out are told rightly or asked for, never told wrongly."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from hypothesis import given, settings, strategies as st

from models.condition import Condition, KnownCondition
from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.diagnosis.case import usable, with_told_conditions
from noise.recordings.sidecar import parse_sidecar
from tests.helpers.small_rigs import only, run

SUPPORTS = (2214.0, math.inf)
THESIS = load_material_rig("fluorocarbon-thesis")
RIG = replace(
    THESIS,
    measured=(),
    fits=tuple(
        replace(fit, damping={k: c for k, c in fit.damping.items() if k in SUPPORTS})
        for fit in THESIS.fits
    ),
)


def _recorded(speed, interference, support, *kinds, seed=0):
    made = run(KnownCondition(speed, interference, support), rig=RIG, seed=seed, seconds=0.3)
    return replace(only(made, *kinds), name="run03.wav")


@settings(max_examples=15)
@given(
    speed=st.floats(0.3, 12.0),
    backwards=st.booleans(),
    fit=st.sampled_from([fit.interference for fit in RIG.fits]),
    support=st.sampled_from(SUPPORTS),
    known=st.sampled_from([(), ("interference",), ("support_stiffness",)]),
    seed=st.integers(0, 99),
)
def test_what_is_told_is_right(speed, backwards, fit, support, known, seed):
    speed = -speed if backwards else speed
    recorded = _recorded(speed, fit, support, "torque", "angle", seed=seed)
    stated = Condition(**{name: getattr(recorded.condition, name) for name in known})
    try:
        told = with_told_conditions(replace(recorded, condition=stated), RIG)
    except ParameterError:
        return
    assert told.condition.interference == fit
    assert told.condition.support_stiffness == support
    assert told.condition.speed == pytest.approx(speed, rel=0.05)


@pytest.mark.parametrize("fit", [fit.interference for fit in RIG.fits])
@pytest.mark.parametrize("support", SUPPORTS)
def test_a_rig_that_sticks_and_slips_tells_all_and_says_so(fit, support):
    recorded = _recorded(0.8, fit, support, "torque", "angle")
    told = with_told_conditions(replace(recorded, condition=Condition()), RIG)
    assert (told.condition.interference, told.condition.support_stiffness) == (fit, support)
    assert [note.partition(" taken as ")[0] for note in told.notes] == [
        "speed", "interference", "support",
    ]  # fmt: skip
    assert f"{1e3 * fit:.4g} mm" in told.notes[1]


@pytest.mark.parametrize(
    ("kinds", "speed"), [(("pressure",), 0.8), (("torque",), 60.0), (("acceleration",), 0.8)]
)
def test_what_nothing_tells_is_asked_for_with_the_sidecar_to_write(kinds, speed):
    recorded = _recorded(speed, 0.279e-3, 2214.0, *kinds)
    with pytest.raises(ParameterError) as refused:
        usable(replace(recorded, condition=Condition()), RIG)
    said = str(refused.value)
    assert "\n" not in said
    assert "write run03.json" in said
    text = said[said.index("{") : said.rindex("}") + 1]
    sidecar = parse_sidecar(text)
    assert [channel.name for channel in sidecar.channels] == list(kinds)
    assert sidecar.calibrated
    keys = {"speed_rad_s", "interference_mm", "support_stiffness_Nm_rad"}
    assert keys <= set(json.loads(text)["conditions"])
    assert usable(replace(recorded, condition=sidecar.condition), RIG).condition.speed


def test_a_speed_that_only_the_torque_tells_is_proposed_and_not_taken():
    recorded = _recorded(0.8, 0.279e-3, 2214.0, "torque")
    with pytest.raises(ParameterError, match=r"the torque says 0\.\d+ rad/s") as refused:
        usable(replace(recorded, condition=Condition()), RIG)
    text = str(refused.value)
    sidecar = parse_sidecar(text[text.index("{") : text.rindex("}") + 1])
    assert sidecar.condition.speed == pytest.approx(0.8, rel=0.1)
    assert sidecar.condition.support_stiffness == 2214.0


def test_fits_of_about_the_same_torque_are_not_told_apart():
    near = replace(
        RIG.fits[1], interference=0.3e-3, kinetic_torque=RIG.fits[1].kinetic_torque * 1.2
    )
    several = replace(RIG, fits=(*RIG.fits[:2], near))
    recorded = _recorded(0.8, 0.279e-3, 2214.0, "torque", "angle")
    with pytest.raises(ParameterError, match="fits several fits"):
        with_told_conditions(replace(recorded, condition=Condition()), several)


def test_a_length_in_another_unit_is_asked_about():
    recorded = _recorded(0.8, 0.279e-3, 2214.0, "torque")
    metres = replace(recorded.condition, interference=0.279e-6)
    with pytest.raises(ParameterError, match=r"is it in m\?"):
        usable(replace(recorded, condition=metres), RIG)
