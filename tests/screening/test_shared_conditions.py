"""Designs of one screen: the same points for each, and what stands in where data are missing."""

import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from models.rig import Fit
from models.rig_file import load_material_rig
from noise.screening.design import Design, Swinging, Use
from noise.screening.screen import screen
from noise.screening.summary import summary_lines
from noise.screening.tables import screening_tables
from noise.screening.vibration import Condition
from tests.helpers.quick_screens import evaluate_point, judged_by_speed, quick_screen

THESIS = load_material_rig("fluorocarbon-thesis")
FLUOROCARBON = load_material_rig("fluorocarbon")


def rounded(low, high):
    return st.floats(low, high).map(lambda value: float(f"{value:.4g}"))


def axis(values, most=2):
    return st.lists(values, max_size=most, unique=True).map(lambda some: tuple(sorted(some)))


SUPPORT = st.one_of(rounded(200.0, 2e4), st.just(math.inf))
SWING = st.builds(
    Swinging,
    st.sampled_from([0.1, 0.2]),
    axis(rounded(0.5, 4.0)).filter(bool),
)
USE = st.builds(
    Use,
    speed=axis(rounded(0.2, 25.0)),
    interference=axis(rounded(0.1e-3, 0.6e-3)),
    support_stiffness=axis(SUPPORT),
    temperature=axis(rounded(-30.0, 90.0), most=2),
    swinging=st.none() | SWING,
)


@st.composite
def bushings(draw):
    """Designs with fits and dampings of their own."""
    fits = []
    for interference in draw(axis(rounded(0.1e-3, 0.5e-3), most=3)) or [0.3e-3]:
        supports = draw(axis(SUPPORT, most=3)) or [math.inf]
        fits.append(Fit(interference, 600.0, 10.0, 8.0, dict.fromkeys(supports, 0.1)))
    return Design("bushing", replace(THESIS, fits=tuple(fits)), draw(USE))


@pytest.fixture
def quick(monkeypatch):
    """A screen that simulates nothing."""

    quickly = lambda **_: lambda _, points: judged_by_speed(points)  # noqa: E731
    monkeypatch.setattr("noise.screening.screen.batch_evaluator", quickly)
    monkeypatch.setattr("noise.screening.screen.advise", lambda *_, **__: ())
    monkeypatch.setattr("noise.screening.screen.refuse_never_slipping", lambda *_: None)


@settings(max_examples=8, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    designs=st.lists(bushings(), min_size=2, max_size=3),
    asked=st.none() | USE,
    environments=st.sampled_from([("dry",), ("dry", "hot")]),
)
def test_all_ranked_designs_have_the_same_points(quick, designs, asked, environments):
    found = screen(designs, asked, environments=environments)
    _, rows = screening_tables(found)["map.csv"]
    points = {}
    for row in rows:
        where = tuple(
            row[name]
            for name in (
                "environment", "motion", "temperature_C", "speed_rad_s", "frequency_hz",
                "interference_mm", "support_stiffness_Nm_rad",
            )
        )  # fmt: skip
        points.setdefault(row["design"], []).append(where)
    first = points[found.designs[0].name]
    assert len(points) == len(designs)
    assert all(own == first for own in points.values())
    assert len(set(first)) == len(first)
    assert {one.design for one in found.standings} == set(points)


SINGLE = Design(
    "one damping",
    replace(THESIS, fits=(Fit(0.279e-3, 665.0, 10.7, 8.0, {2214.0: 0.105}),)),
    Use(support_stiffness=(2214.0,)),
)


def test_a_design_of_one_damping_meets_the_supports_of_the_others(quick):
    found = quick_screen([SINGLE, "fluorocarbon-thesis"], Use(speed=(1.0, 5.0, 9.0)))
    own = next(one for one in found.maps if one.design == SINGLE.name)
    assert own.grid.support_stiffness == (2214.0, 3745.0, math.inf)
    of_fits = "fits are given for 0.279 mm; for 0.178 and 0.381 mm the nearest is held"
    assert f"   note: {of_fits}" in summary_lines(found)


def test_a_fit_that_is_held_makes_the_same_noise():
    fits = (0.1e-3, 0.178e-3, 0.5e-3, 0.6e-3)
    use = Use(speed=(2.0, 8.0), interference=fits, support_stiffness=(2214.0,))
    (found,) = quick_screen(["fluorocarbon"], use).maps
    for row, interference in enumerate(fits):
        one = evaluate_point(FLUOROCARBON, Condition(2.0, interference, 2214.0))
        assert one.label == found.label[0, 0, row, 0]
        assert one.level == found.level[0, 0, row, 0]
