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
from noise.diagnosis.case import usable, with_inferred_conditions
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


@settings(max_examples=10)
@given(
    speed=st.floats(0.3, 12.0),
    backwards=st.booleans(),
    fit=st.sampled_from([fit.interference for fit in RIG.fits]),
    support=st.sampled_from(SUPPORTS),
    known=st.booleans(),
    seed=st.integers(0, 99),
)
def test_what_is_told_is_right(speed, backwards, fit, support, known, seed):
    speed = -speed if backwards else speed
    recorded = _recorded(speed, fit, support, "torque", "angle", seed=seed)
    stated = Condition(support_stiffness=support, interference=fit if known else None)
    try:
        told = with_inferred_conditions(replace(recorded, condition=stated), RIG)
    except ParameterError:
        return
    assert told.condition.interference == fit
    assert told.condition.speed == pytest.approx(speed, rel=0.05)
    taken = [note.partition(" taken as ")[0] for note in told.notes]
    assert taken == ["speed", "interference"][: 1 if known else 2]


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


def test_fits_of_about_the_same_torque_are_not_told_apart():
    near = replace(
        RIG.fits[1], interference=0.3e-3, kinetic_torque=RIG.fits[1].kinetic_torque * 1.2
    )
    several = replace(RIG, fits=(*RIG.fits[:2], near))
    recorded = _recorded(0.8, 0.279e-3, 2214.0, "torque", "angle")
    with pytest.raises(ParameterError, match="fits several fits"):
        with_inferred_conditions(
            replace(recorded, condition=Condition(support_stiffness=2214.0)), several
        )


def test_a_length_in_another_unit_is_asked_about():
    recorded = _recorded(0.8, 0.279e-3, 2214.0, "torque")
    metres = replace(recorded.condition, interference=0.279e-6)
    with pytest.raises(ParameterError, match=r"is it in m\?"):
        usable(replace(recorded, condition=metres), RIG)
