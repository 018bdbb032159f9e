"""Maps of a review: areas that cover them, and points that are worth hearing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.pages import screen_sounds as sounds
from noise.pages.maps import MAP_SIZE, areas_of, axis_of, cells_of, recorded_maps
from noise.pages.review import read_screen, rig_of
from noise.pages.screen_sounds import MOST_SILENT, ScreenPoint, SharedPoint, chosen_points
from tests.helpers.made_reviews import row, screen_rows, write_screen
from tests.helpers.small_rigs import RIG_FILE

LABELS = ("creak", "squawk", "squeal", "none")

WIDTH, HEIGHT = MAP_SIZE


def points(rows):
    return [shared(one["speed_rad_s"], one["interference_mm"], one["label"]) for one in rows]


def shared(speed, fit, *labels):
    return SharedPoint(speed, fit, tuple(ScreenPoint(speed, fit, label) for label in labels))


def areas_among(speed, fit, labels):
    cells = cells_of(speed, fit)
    across, up = (axis_of(e, edges=True) for e in (cells.speed_edges, cells.interference_edges))
    return across, up, areas_of(cells, labels, across, up, MAP_SIZE)


@given(
    st.integers(1, 6),
    st.integers(1, 5),
    st.lists(st.sampled_from(LABELS), min_size=30, max_size=30),
)
def test_areas_cover_the_map_once_and_have_the_label_of_their_point(n_across, n_up, labels):
    speed = np.tile(np.arange(n_across) * 2.0 + 1.0, n_up)
    fit = np.repeat(np.arange(n_up) * 0.05 + 0.2, n_across)
    across, up, areas = areas_among(speed, fit, labels[: speed.size])
    assert sum(a.width * a.height for a in areas) == pytest.approx(
        MAP_SIZE[0] * MAP_SIZE[1], rel=1e-3
    )
    for v, i, label in zip(speed, fit, labels, strict=False):
        x, y = WIDTH * across.share(v), HEIGHT * (1.0 - up.share(i))
        (found,) = (a for a in areas if a.x < x < a.x + a.width and a.y < y < a.y + a.height)
        assert found.label == label


@given(st.integers(1, 20))
def test_no_more_points_are_heard_than_allowed_and_none_twice(most):
    chosen = chosen_points(points(screen_rows()), most)
    assert len(chosen) == len(set(chosen)) <= most
    assert sum(point.labels == ("none",) for point in chosen) <= MOST_SILENT


def test_a_recording_whose_condition_is_not_known_is_counted_and_not_drawn():
    unknown = row("c", "creak", speed_rad_s=None, speed_rad_s_source="missing")
    rows = [row("a", "creak"), row("b", "squawk"), unknown]
    maps, left_out = recorded_maps(rows, {"a": "A", "b": "B", "c": "C"}, ["a", "b"])
    (spot,) = maps[0].spots
    assert spot.sounds == ("a", "b")
    assert left_out == 1


def test_a_screen_is_read_map_by_map(tmp_path):
    folder = write_screen(tmp_path / "s", screen_rows() + screen_rows(environment="wet"))
    dry, wet = read_screen(folder / "map.csv")
    assert (dry.environment, wet.environment) == ("dry", "wet")
    assert dry.temperature == 23.0
    assert len(dry.points) == 20


def test_a_design_is_a_rig_file_beside_the_screen_or_a_shipped_material(tmp_path):
    folder = write_screen(tmp_path / "s", screen_rows("PDMS") + screen_rows("small"))
    material, own = read_screen(folder / "map.csv")
    assert rig_of(material, folder, ()).material == "PDMS"
    with pytest.raises(ParameterError, match=r"name small\.toml beside the screen"):
        rig_of(own, folder, ())
    file = tmp_path / "anything.toml"
    file.write_text(RIG_FILE, encoding="utf-8")
    assert rig_of(own, folder, [file]).name == "small"
    (folder / "designs").mkdir()
    (folder / "designs" / "small.toml").write_text(RIG_FILE, encoding="utf-8")
    assert rig_of(own, folder, ()).name == "small"


def test_a_point_of_a_swinging_shaft_is_heard_swinging(tmp_path, monkeypatch):
    rows = [one | {"motion": "swinging", "frequency_hz": 2.0} for one in screen_rows("PDMS")]
    (screened,) = read_screen(write_screen(tmp_path / "s", rows) / "map.csv")
    turned = []

    def simulate(rig, shaft, **others):
        turned.append(shaft)
        return run_of(rig, shaft, **(others | {"seconds": 0.1}))

    run_of = sounds.simulate
    monkeypatch.setattr(sounds, "simulate", simulate)
    entry = sounds.simulated_entry(
        screened, rig_of(screened, tmp_path, ()), screened.points[0], seed=0
    )
    (shaft,) = turned
    assert 2.0 * np.pi * shaft.frequency * shaft.amplitude == pytest.approx(2.0)
    assert "swinging" in entry.title
