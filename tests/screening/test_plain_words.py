"""What a ranking says of each design in words."""

import math

import numpy as np
import pytest

from noise.screening.design.design import Design, Use, load_design
from noise.screening.screen import screen
from noise.screening.tables.summary import summary_lines
from noise.screening.tables.tables import screening_tables

USE = Use(
    speed=tuple(np.arange(1.0, 14.0)), interference=(0.279e-3,), support_stiffness=(2214.0, 3745.0)
)


@pytest.fixture(scope="module")
def found():
    return screen(["fluorocarbon", "PDMS"], USE)


def test_a_quiet_design_is_said_to_be_quiet(found):
    quiet = found.standings[0]
    assert quiet.words == "quiet at all 26 points of use; nothing vibrates"
    assert quiet.hint == ""


def test_a_noisy_design_says_which_noise_from_which_speed_to_which(found):
    loud = found.standings[1]
    assert "(from 1 to 8 rad/s); squeals from 6 to 10 rad/s" in loud.words
    assert "quiet above" in loud.words
    heard = next(one for one in found.maps if one.design == "fluorocarbon")
    fastest = max(np.array(heard.grid.speed)[(heard.label == "squeal").any(axis=(0, 1, 2))])
    assert f"to {fastest:.3g} rad/s" in loud.words


def test_the_first_hint_helps_where_it_is_followed(found):
    """The change that stability names makes less of the use noisy in simulation."""
    name, amount = found.standings[1].hint.split(":")[0].split(" ")
    before = load_design("fluorocarbon").rig
    (after,) = screen([Design("changed", before.changed(**{name: amount}))], USE).standings
    assert after.shares["none"] > found.standings[1].shares["none"]


def test_terminal_and_table_say_the_same(found):
    printed = "\n".join(summary_lines(found))
    _, rows = screening_tables(found)["designs.csv"]
    for one, row in zip(found.standings, rows, strict=True):
        assert row["words"] == one.words
        assert one.words in printed
        assert (row["notes"] or "") == "; ".join(one.notes)


def test_notes_name_implausible_values():
    rig = load_design("fluorocarbon").rig.changed(clamp_inertia_kgm2=0.9)
    use = Use(speed=(15.0,), interference=(0.279e-3,), support_stiffness=(2214.0,))
    found = screen([Design("heavy", rig)], use, environments=["wet"])
    notes = "; ".join(found.standings[0].notes)
    for words in (
        "clamp_inertia_kgm2 = 0.9 is outside the usual",
        "speed 15 rad/s is beyond 13",
    ):
        assert words in notes
    assert found.maps[0].note.item() == "faster than 13 rad/s, the fastest that was fitted"
    _, rows = screening_tables(found)["map.csv"]
    assert rows[0]["note"] == found.maps[0].note.item()


def test_a_note_on_temperature_stands_with_the_environment_that_has_it():
    use = Use(speed=(5.0,), interference=(0.279e-3,), support_stiffness=(2214.0,))
    found = screen(["fluorocarbon"], use, environments=["dry", "hot"])
    noted = {one.environment: "temperature 80" in "; ".join(one.notes) for one in found.standings}
    assert noted == {"dry": False, "hot": True}


def test_levels_are_those_of_a_meter(found):
    """L_AFmax of a steady noise is a little above its L_Aeq; both are told of the same points."""
    heard = next(one for one in found.maps if one.design == "fluorocarbon")
    told = np.isfinite(heard.level)
    assert np.array_equal(told, np.isfinite(heard.level_max))
    over = heard.level_max[told] - heard.level[told]
    assert over.min() > -1.0
    assert over.max() < 8.0
    _, rows = screening_tables(found)["designs.csv"]
    assert math.isnan(rows[0]["loudest_level_dba"])
    assert rows[1]["loudest_level_dba"] == pytest.approx(np.nanmax(heard.level), abs=0.01)
