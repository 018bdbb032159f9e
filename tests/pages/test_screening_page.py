"""The page of a screen: what it says of designs, and that it stays one safe file."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from models.rig_file import load_material_rig
from noise.pages.comparison import compare_designs
from noise.pages.maps import cells_of, common_cells
from noise.pages.screen_sounds import chosen_points, screen_maps, shared_points
from noise.pages.screening import RANKING, ranking_rows, write_screening
from noise.screening.design import Design, Use
from tests.helpers.quick_screens import quick_screen

QUICK = Use(speed=(1.0, 5.0, 9.0), interference=(0.279e-3,), support_stiffness=(2214.0,))


@pytest.fixture(scope="module")
def two():
    return quick_screen(["fluorocarbon", "PDMS"], QUICK)


class Page(HTMLParser):
    """What a browser would make of the page, as far as it matters here."""

    def __init__(self, path):
        super().__init__()
        self.html = path.read_text(encoding="utf-8")
        self.tags, self.text, self._scripts, self._open = [], [], {}, None
        self.feed(self.html)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self._open = dict(attrs).get("id") if tag == "script" else None

    def handle_data(self, data):
        if self._open:
            self._scripts[self._open] = data
        self.text.append(data)

    def handle_endtag(self, _):
        self._open = None

    def data(self, script):
        return json.loads(self._scripts[script])

    @property
    def said(self):
        return " ".join(" ".join(self.text).split())


def page_of(found, folder, **options):
    write_screening(folder / "report.html", found, **options)
    return Page(folder / "report.html")


def renamed(found, names):
    """The same screen of designs called otherwise."""
    known = dict(zip([one.name for one in found.designs], names, strict=True))
    return replace(
        found,
        designs=tuple(replace(one, name=known[one.name]) for one in found.designs),
        **{
            part: tuple(replace(one, design=known[one.design]) for one in getattr(found, part))
            for part in ("maps", "critical", "standings")
        },
        files=(),
    )


HOSTILE = st.one_of(
    st.sampled_from(
        [
            "</script><script>alert(1)</script>", "<img src=x onerror=alert(1)>", '"><b>', "'",
            "{{ 7 * 7 }}", "{% raw %}", "<!--", "]]>", "&amp;", "\u2028", "a" * 300, "\udcff",
        ]
    ),
    st.text(min_size=1, max_size=30),
)  # fmt: skip


@pytest.fixture(scope="module")
def plain(two, tmp_path_factory):
    """The page of both without sounds."""
    return page_of(two, tmp_path_factory.mktemp("plain"), sounds=0)


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(HOSTILE, min_size=2, max_size=2, unique=True))
def test_a_hostile_name_is_text_and_nothing_else(two, plain, tmp_path, names):
    page = page_of(renamed(two, names), tmp_path, sounds=0)
    # The same elements, and the same attributes but for what they say.
    assert [(tag, set(attrs)) for tag, attrs in page.tags] == [
        (tag, set(attrs)) for tag, attrs in plain.tags
    ]
    assert page.data("compared")["names"] == names


def by_name(rows):
    return {row[1].text: dict(zip(RANKING, row, strict=True)) for row in rows}


def test_a_quiet_design_is_shown_as_quiet_and_a_noisy_one_by_its_shares(two):
    rows = by_name(ranking_rows(two))
    assert (rows["PDMS"]["Rank"], rows["PDMS"]["Loudest"]) == ("1", "quiet")
    assert rows["PDMS"][RANKING[2]].labels == (("none", "100%"),)
    noisy = rows["fluorocarbon"]
    assert sum(bar.width for bar in noisy[RANKING[2]].bars) == pytest.approx(100.0)
    assert re.fullmatch(r"\d+ dB\(A\)", noisy["Loudest"])


def test_a_design_that_never_slips_has_no_rank_no_sound_and_says_why(tmp_path):
    held = load_material_rig("fluorocarbon").changed(
        critical_torque="x1000", kinetic_torque="x1000"
    )
    found = quick_screen(["fluorocarbon", Design("in Nmm", held)], replace(QUICK, speed=(5.0,)))
    row = by_name(ranking_rows(found))["in Nmm"]
    assert (row["Rank"], row["Margin"], row["Loudest"]) == ("\N{EN DASH}", "", "")
    assert "never slips" in row["In its use"].text
    page = page_of(found, tmp_path, sounds=2)
    assert "No sounds: never slips" in page.said
    assert {one["title"].partition(":")[0] for one in page.data("about").values()} == {
        "fluorocarbon"
    }


def test_every_design_is_heard_at_the_same_conditions_at_one_gain(two, tmp_path):
    page = page_of(two, tmp_path, sounds=6)
    titles = [one["title"].partition(": ") for one in page.data("about").values()]
    heard = {
        name: {where for own, _, where in titles if own == name}
        for name in ("fluorocarbon", "PDMS")
    }
    assert heard["fluorocarbon"] == heard["PDMS"]
    assert len(heard["PDMS"]) == 3
    assert len(set(re.findall(r'data-full-scale="([^"]+)"', page.html))) == 1
    assert "full scale =" in page.said


def test_the_same_seed_gives_the_same_page(two, tmp_path):
    pages = [page_of(two, tmp_path, sounds=2, seed=seed).html for seed in (1, 1, 2)]
    assert pages[0] == pages[1] != pages[2]


def test_a_page_keeps_to_its_size(two, tmp_path):
    page_of(two, tmp_path, sounds=6, megabytes=0.6)
    assert (tmp_path / "report.html").stat().st_size < 0.6e6
    page = page_of(two, tmp_path, sounds=6, megabytes=0.01)
    assert page.data("about") == {}


def test_cells_have_the_labels_and_levels_of_the_map(two):
    compared, heard = compare_designs(
        screen_maps(two), ["not wanted"] * len(screen_maps(two)), number=5, seed=0
    )
    assert heard == {}
    (place,) = compared.data["places"]
    for number, mapped in enumerate(two.maps):
        cells = place["designs"][str(number)]
        labels = [compared.data["labels"][label] for label in cells["label"]]
        assert labels == mapped.label[0, 0].ravel().tolist()
        levels = [np.nan if level is None else level for level in cells["level"]]
        assert np.allclose(levels, mapped.level[0, 0].ravel(), atol=0.06, equal_nan=True)


points = st.lists(
    st.tuples(st.integers(1, 12), st.integers(1, 6)), min_size=1, max_size=20, unique=True
)


@given(points, points)
def test_maps_laid_over_each_other_keep_what_lies_where(first, second):
    maps = [
        cells_of(*(np.array(axis, dtype=float) for axis in zip(*of, strict=True)))
        for of in (first, second)
    ]
    for own, laid in zip(maps, common_cells(maps), strict=True):
        assert laid.point.shape == (laid.interference_edges.size - 1, laid.speed_edges.size - 1)

        def area(cells):
            sizes = np.outer(np.diff(cells.interference_edges), np.diff(cells.speed_edges))
            return {
                int(n): float(sizes[cells.point == n].sum())
                for n in np.unique(cells.point)
                if n >= 0
            }

        assert area(laid) == pytest.approx(area(own))


def test_the_loudest_of_each_noise_is_heard():
    use = replace(QUICK, speed=tuple(np.linspace(0.5, 12.5, 13)))
    damped = Design("damped", load_material_rig("fluorocarbon").changed(damping="x2"))
    wide = quick_screen(["fluorocarbon", damped], use)
    shared = shared_points(screen_maps(wide))
    chosen = chosen_points(shared, 10)
    for number in range(2):
        noisy = [p.points[number] for p in shared if p.points[number].label != "none"]
        for label in {point.label for point in noisy}:
            loudest = max((p for p in noisy if p.label == label), key=lambda p: p.level)
            near = [
                p for p in chosen
                if abs(p.speed - loudest.speed) <= 1.0 and p.points[number].label == label
            ]  # fmt: skip
            assert near
