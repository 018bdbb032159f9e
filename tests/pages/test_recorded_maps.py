"""Maps of recorded conditions on a page: spots beside each other, and numbers of the axes."""

from __future__ import annotations

import itertools

from noise.pages.maps import axis_of, recorded_maps


def recorded_at(speeds):
    alike = {"material": "fluorocarbon", "interference_mm": 0.279, "support_stiffness_Nm_rad": 2e3}
    alike |= {"channel": "all", "start_s": 0.0, "end_s": 1.0, "speed_rad_s_source": "logged"}
    alike |= {f"{name}_source": "logged" for name in alike if name not in ("channel", "start_s")}
    rows = [
        alike | {"file": f"s{n}", "label": ("squawk", "squeal")[n % 2], "speed_rad_s": speed}
        for n, speed in enumerate(speeds)
    ]
    titles = {row["file"]: row["file"] for row in rows}
    (made,), _ = recorded_maps(rows, titles, titles)
    return made


def test_spots_of_close_speeds_do_not_overlap_and_the_map_says_so():
    made = recorded_at([1.0, 7.02, 7.6, 12.0])
    places = sorted(spot.x for spot in made.spots)
    assert all(after - one >= 0.11 for one, after in itertools.pairwise(places))
    assert "moved apart" in made.note
    assert recorded_at([1.0, 7.0, 12.0]).note == ""


def test_long_numbers_of_an_axis_have_room():
    assert len(axis_of([7.13, 7.14], edges=True).ticks) < len(axis_of([0, 14], edges=True).ticks)
