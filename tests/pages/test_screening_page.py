"""The page of a screen: what it says of designs, and that it stays one safe file."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.rig_file import load_material_rig
from noise.pages.maps import MAP_SIZE, areas_of, axis_of
from noise.pages.screen_maps import MOST_SILENT, chosen_points, places_of
from noise.pages.screening import RANKING, ranking_rows, write_screening
from noise.screening.design import Design, Use
from tests.helpers.quick_screens import quick_screen

QUICK = Use(speed=(1.0, 5.0, 9.0), interference=(0.279e-3,), support_stiffness=(2214.0,))


@pytest.fixture(scope="module")
def two():
    return quick_screen(["fluorocarbon", "PDMS"], QUICK)


def page_of(found, folder, **options):
    """Write the page; return its text, and what it knows of its sounds."""
    write_screening(folder / "report.html", found, **options)
    text = (folder / "report.html").read_text(encoding="utf-8")
    return text, json.loads(re.search(r'id="about">(.*?)</script>', text, re.DOTALL)[1])


def by_name(rows):
    return {row[1].text: dict(zip(RANKING, row, strict=True)) for row in rows}


def test_a_design_that_never_slips_is_refused_and_says_why(tmp_path):
    held = load_material_rig("fluorocarbon").changed(
        critical_torque="x1000", kinetic_torque="x1000"
    )
    found = quick_screen(["fluorocarbon", Design("in Nmm", held)], replace(QUICK, speed=(5.0,)))
    assert list(by_name(ranking_rows(found))) == ["fluorocarbon"]
    text, about = page_of(found, tmp_path, sounds=2)
    assert "never slips: the contact holds" in text
    assert {one["title"].partition(":")[0] for one in about.values()} == {"fluorocarbon"}


def test_every_design_is_heard_at_the_same_conditions_at_one_gain(two, tmp_path):
    text, about = page_of(two, tmp_path, sounds=6)
    titles = [one["title"].partition(": ") for one in about.values()]
    heard = {
        name: {where for own, _, where in titles if own == name}
        for name in ("fluorocarbon", "PDMS")
    }
    assert heard["fluorocarbon"] == heard["PDMS"]
    assert len(heard["PDMS"]) == 3
    assert text.count("full scale =") == 1


@given(
    st.integers(1, 6),
    st.integers(1, 5),
    st.lists(st.sampled_from(("creak", "squawk", "none")), min_size=30, max_size=30),
)
def test_areas_cover_the_map_once_and_have_the_label_of_their_point(n_across, n_up, labels):
    speed, fit = np.arange(n_across) * 2.0 + 1.0, np.arange(n_up) * 0.05 + 0.2
    given = np.array(labels[: n_across * n_up]).reshape(n_up, n_across)
    across, up = axis_of(speed), axis_of(fit, named_over=300.0)
    areas = areas_of(given, across, up, 300.0)
    assert sum(a.width * a.height for a in areas) == pytest.approx(MAP_SIZE[0] * 300.0, rel=1e-3)
    for (row, column), label in np.ndenumerate(given):
        x, y = MAP_SIZE[0] * across.share(speed[column]), 300.0 * (1.0 - up.share(fit[row]))
        (found,) = (a for a in areas if a.x < x < a.x + a.width and a.y < y < a.y + a.height)
        assert found.label == label


def test_no_more_points_are_heard_than_allowed_and_none_twice(two):
    (place,) = places_of(two)
    label = place.of("label")
    assert chosen_points(place, 0) == []
    for most in range(1, 4):
        chosen = chosen_points(place, most)
        assert len(chosen) == len(set(chosen)) <= most
        assert sum((label[:, row, column] == "none").all() for row, column in chosen) <= MOST_SILENT


def test_the_loudest_of_each_noise_is_heard():
    use = replace(QUICK, speed=tuple(np.linspace(0.5, 12.5, 13)))
    damped = Design("damped", load_material_rig("fluorocarbon").changed(damping="x2"))
    wide = quick_screen(["fluorocarbon", damped], use)
    (place,) = places_of(wide)
    label, level = place.of("label"), place.of("level")
    speed = place.maps[0].grid.speed
    chosen = chosen_points(place, 10)
    for number in range(2):
        for name in set(label[number].ravel().tolist()) - {"none", "persists"}:
            loudest = speed[np.where(label[number] == name, level[number], -1.0).argmax()]
            near = [
                at for at in chosen
                if abs(speed[at[1]] - loudest) <= 1.0 and label[number][at] == name
            ]  # fmt: skip
            assert near
