"""Maps of the shipped materials: against the thesis, against whole maps, against single runs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.noise_definition import LEAST_LEVEL
from noise.screening.design import Design, Use
from noise.screening.grid import shared_grid
from noise.screening.mapping import map_design
from noise.screening.point import batch_evaluator
from noise.screening.vibration import Condition
from tests.helpers.quick_screens import evaluate_point, quick_screen
from tests.screening.long_runs import label_after

SUPPORTS = (2214.0, 3745.0, math.inf)
ENDS = (2214.0, math.inf)
FLUOROCARBON = load_material_rig("fluorocarbon")


def mapped(material, use, **more):
    design = Design(material, load_material_rig(material))
    grid = shared_grid([design], use)
    return map_design(design.rig, grid, batch_evaluator(), design=material, **more)


def test_pdms_is_silent_everywhere():
    speed = tuple(np.arange(0.25, 17.01, 0.125))
    use = Use(speed=speed, interference=(0.254e-3, 0.381e-3), support_stiffness=ENDS)
    found = mapped("PDMS", use)
    assert (found.label == "none").all()
    assert (found.regime == "steady sliding").all()
    assert found.count("simulated") < 0.2 * found.label.size


def test_natural_rubber_chatters_without_its_film_and_not_on_it():
    use = Use(speed=(5.0, 10.0), support_stiffness=(2214.0,))
    for material in ("natural-rubber", "natural-rubber-film-removed"):
        bare = mapped(material, use)
        assert (bare.label == "squawk").all()
        assert (bare.regime != "steady sliding").all()
    on_film = mapped("natural-rubber-film", use)
    assert (on_film.label == "creak").all()  # random friction, "resembled the creaking" (6.2)
    assert (on_film.regime == "quasi-harmonic").all()


@pytest.mark.parametrize(
    ("interference", "support", "speed", "noise"),
    [
        *((0.381e-3, k, v, "creak") for k in (2214.0, 3745.0) for v in (1.0, 5.0, 10.0)),
        (0.279e-3, 2214.0, 5.0, "squawk"),
        (0.279e-3, 3745.0, 5.0, "squawk"),
        (0.178e-3, 2214.0, 1.0, "squawk"),
        (0.178e-3, 2214.0, 2.5, "squawk"),
        (0.279e-3, 3745.0, 10.0, "squeal"),
        (0.279e-3, 2214.0, 10.0, "none"),
        (0.178e-3, 2214.0, 5.0, "none"),
        (0.178e-3, 2214.0, 10.0, "none"),
        (0.279e-3, 2214.0, 7.5, "squawk"),
    ],
)
def test_a_point_is_labelled_as_the_thesis_heard_it(interference, support, speed, noise):
    found = evaluate_point(FLUOROCARBON, Condition(speed, interference, support))
    assert ("none" if found.persists else found.label) == noise


AUDIBLE = LEAST_LEVEL + 6.0
"""Fainter sounds are named or not by the length of the recording [dB(A)]."""


@pytest.mark.parametrize("material", ["fluorocarbon", "natural-rubber", "fluorocarbon-thesis"])
def test_points_are_labelled_as_recordings_of_them_are(material):
    rng, rig = np.random.default_rng(7), load_material_rig(material)
    for _ in range(4):
        at = Condition(
            rng.uniform(0.5, 6.0),
            float(rng.choice(rig.interference_range)),
            float(rng.choice(SUPPORTS)),
        )
        found = evaluate_point(rig, at)
        if found.level < AUDIBLE:
            continue
        heard = label_after(rig, at, [at.speed], seconds=3.0)
        assert heard == ("none" if found.persists else found.label)


def test_a_constant_torque_sticks_and_slips_where_stability_sees_nothing():
    use = Use(speed=tuple(np.arange(0.5, 9.01, 0.25)), support_stiffness=(3745.0,))
    found = quick_screen(["fluorocarbon-thesis"], replace(use, interference=(0.279e-3,)))
    standing = found.standings[0]
    label = found.maps[0].label[0, 0, 0]
    from_rest = np.array(use.speed)[(label != "none") & (label != "persists")]
    assert from_rest[-1] == pytest.approx(7.0, abs=0.3)
    assert standing.worst("v_crit1") >= from_rest[-1]  # vibration that only persists counts
    assert standing.worst("v_crit2_stability") == 0.0
    assert standing.worst("margin_stability") == math.inf


@pytest.mark.parametrize(
    "material", ["fluorocarbon-thesis", pytest.param("fluorocarbon", marks=pytest.mark.slow)]
)
def test_a_refined_map_is_the_whole_map_but_for_few_points(material):
    use = Use(
        speed=tuple(np.arange(4.0, 9.01, 0.25)),
        interference=tuple(np.linspace(0.200e-3, 0.300e-3, 5)),
        support_stiffness=(2214.0,),
    )
    refined = mapped(material, use)
    points = [Condition(v, fit, 2214.0) for fit in use.interference for v in use.speed]
    whole = batch_evaluator()(load_material_rig(material), points)
    noise = np.array(["persists" if one.persists else one.label for one in whole])
    assert refined.count("simulated") < 0.6 * noise.size
    assert np.mean(noise == refined.label.ravel()) > 0.95
    assert np.mean((noise == "none") == (refined.label.ravel() == "none")) > 0.95
    apart = np.array([one.level for one in whole]) - refined.level.ravel()
    assert np.sqrt(np.nanmean(apart**2)) < 4.0


def test_temperature_makes_a_difference_only_to_a_material_that_says_how():
    use = Use(speed=(1.0, 5.0, 9.0), support_stiffness=(2214.0,), temperature=(5.0, 80.0))
    blind = mapped("fluorocarbon-thesis", use)
    assert np.array_equal(blind.label[0], blind.label[1])


def test_a_bar_that_swings_on_the_road_makes_noise_where_its_rubber_does():
    swing = Condition(2.0 * math.pi * 2.0 * math.radians(15), 0.381e-3, 2214.0, frequency=2.0)
    loud = evaluate_point(FLUOROCARBON, swing)
    still = evaluate_point(load_material_rig("PDMS"), swing)
    assert loud.label == "creak"
    assert (still.label, still.regime.value) == ("none", "steady sliding")
    assert math.isnan(still.level)


def test_the_design_that_is_quieter_by_construction_is_ranked_first():
    # Damping that sliding's fall of torque cannot feed: three times that of the elastomer.
    fits = tuple(
        replace(fit, damping={k: 4.0 * c for k, c in fit.damping.items()})
        for fit in FLUOROCARBON.fits
    )
    quiet = Design("damped", replace(FLUOROCARBON, fits=fits))
    use = Use(speed=(5.0,), interference=(0.279e-3,), support_stiffness=(2214.0,))
    found = quick_screen([Design("as it is", FLUOROCARBON), quiet], use)
    assert [(one.rank, one.design) for one in found.standings] == [(1, "damped"), (2, "as it is")]
    assert found.standings[0].mean_loudness < found.standings[1].mean_loudness
    assert found.standings[0].worst("margin_stability") > found.standings[1].worst(
        "margin_stability"
    )


def test_a_design_that_cannot_be_simulated_does_not_stop_the_others():
    fast = replace(FLUOROCARBON, elastomer_inertia=1e-14)
    use = Use(speed=(1.0, 2.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    found = quick_screen([Design("fast", fast), "PDMS"], use)
    assert [name for name, _ in found.refused] == ["fast"]
    assert [one.design for one in found.maps] == ["PDMS"]
    with pytest.raises(ParameterError, match="grows without bound"):
        quick_screen([Design("fast", fast)], use)
