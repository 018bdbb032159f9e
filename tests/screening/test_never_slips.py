"""Designs whose contact never slips."""

import math

import pytest

from noise.screening.design.design import Design, Swinging, Use, load_design
from noise.screening.screen import screen
from noise.screening.tables.summary import summary_lines
from noise.screening.tables.tables import screening_tables

HELD = Design("held", load_design("fluorocarbon-thesis").rig.changed(critical_torque="x1000"))


@pytest.fixture(scope="module")
def found():
    given = Use(speed=(1.0, 9.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    return screen([HELD, "PDMS"], given)


def test_under_steady_rotation_it_gets_no_rank_and_comes_last(found):
    assert [(one.design, one.rank) for one in found.standings] == [("PDMS", 1), ("held", None)]
    line = next(line for line in summary_lines(found) if "held" in line)
    assert "no rank" in line
    assert "margin" not in line
    _, rows = screening_tables(found)["designs.csv"]
    assert "never slips" in list(rows)[-1]["error"]


def test_in_a_swing_it_is_a_result():
    swing = Use(
        swinging=Swinging(math.radians(10.0), (1.0,)),
        interference=(0.279e-3,),
        support_stiffness=(2214.0,),
    )
    found = screen(["fluorocarbon-thesis", HELD], swing)
    best, other = found.standings
    assert (best.design, best.rank, best.risk) == ("held", 1, 1)
    assert other.rank == 2
    assert best.words.endswith("; quiet")
    assert "never slips" in summary_lines(found)[0]
