"""A screen that was killed, called again: what was simulated of its maps is not simulated again."""

from __future__ import annotations

import pytest

from models.rig_file import load_material_rig
from noise.screening.design import Design, Use
from noise.screening.grid import shared_grid
from noise.screening.mapping import map_design
from noise.screening.point import keeping
from tests.helpers.kept import staying_results
from tests.helpers.quick_screens import judged_by_speed

USE = Use(interference=(0.254e-3, 0.3e-3, 0.381e-3), support_stiffness=(2214.0,))


class Judge:
    """Tells the noise by the speed and the damping, in no time; dies after some batches."""

    def __init__(self, lasts=10**6):
        self.left = lasts
        self.n_points = 0

    def __call__(self, rig, points):
        if not self.left:
            raise KeyboardInterrupt
        self.left -= 1
        self.n_points += len(points)
        ends = 5.0 + sum(rig.fit(0.3e-3).damping.values())
        return judged_by_speed(points, ends)


def mapped(judge, folder, change=1.0):
    """The map of a design, which is read anew as each call does."""
    rig = load_material_rig("fluorocarbon").changed(damping=f"x{change:g}")
    with staying_results(folder / "screen") as lines:
        return map_design(
            rig, shared_grid([Design("a", rig)], USE), keeping(judge, lines), design="a"
        )


@pytest.mark.parametrize("batches", [0, 1, 2])
def test_after_a_kill_only_the_rest_is_simulated_and_the_map_is_the_same(tmp_path, batches):
    undisturbed, first, second = Judge(), Judge(batches), Judge()
    whole = mapped(undisturbed, tmp_path / "undisturbed")
    assert undisturbed.left < 10**6 - batches
    with pytest.raises(KeyboardInterrupt):
        mapped(first, tmp_path)
    found = mapped(second, tmp_path)
    assert first.n_points + second.n_points == undisturbed.n_points
    for name in ("regime", "label", "level", "level_max", "how"):
        assert getattr(found, name).tobytes() == getattr(whole, name).tobytes()
