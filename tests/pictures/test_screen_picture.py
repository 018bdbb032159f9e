"""Pictures of screened designs."""

from dataclasses import replace

import numpy as np
import pytest

from models.rig_file import load_material_rig
from noise.base.labels import PERSISTS
from noise.pictures.maps import LINES, boundary_lines, plot_screen
from noise.screening.design import Use
from sim.analysis.regime import Regime, friction_regime
from sim.analysis.stability import sliding_growth
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from tests.helpers.quick_screens import quick_screen


@pytest.fixture(scope="module")
def found():
    use = Use(
        speed=tuple(np.linspace(1.0, 15.0, 6)),
        interference=(0.279e-3,),
        support_stiffness=(2214.0, 3000.0),
    )
    return quick_screen(["fluorocarbon", "PDMS"], use)


def test_the_whole_of_each_cell_that_persists_is_hatched(found):
    """Also of a lone cell, and amid others."""
    one = found.maps[0]
    label = np.full_like(one.label, "squawk", dtype=object)
    label[0, 0, 0, [0, 3, 4]] = PERSISTS
    panel = plot_screen(replace(one, label=label)).axes[0]
    hatched = [box for box in panel.patches if box.get_hatch()]
    centres = [box.get_x() + 0.5 * box.get_width() for box in hatched]
    step = one.grid.speed[1] - one.grid.speed[0]
    assert centres == pytest.approx([one.grid.speed[i] for i in (0, 3, 4)])
    assert [box.get_width() for box in hatched] == pytest.approx([step] * 3)
    assert [(box.get_y(), box.get_height()) for box in hatched] == [(-0.5, 1.0)] * 3


def sticks(rig, speed, interference):
    """Whether a long run from rest ends in stick-slip; it shares no code with the screening."""
    run = simulate_motion(
        rig, ConstantSpeed(speed), interference=interference, support_stiffness=2214.0,
        seconds=4.0, rate=15e3,
    )  # fmt: skip
    return friction_regime(run) is Regime.STICK_SLIP


RISING = "stick begins", "sliding turns unstable"


def test_each_line_of_a_map_is_what_it_is_called_on_both_of_its_sides():
    """Of 0.381 mm stick begins where the speed rises, and sliding turns stable within a creak."""
    speeds = (0.25, 0.5, 2.0, 4.0, 8.0, 11.0, 12.5)
    use = Use(speed=speeds, interference=(0.279e-3, 0.381e-3), support_stiffness=(2214.0,))
    one = quick_screen(["fluorocarbon"], use).maps[0]
    lines = boundary_lines(one)
    assert set(LINES) == {name for name, *_ in lines}
    rig = load_material_rig("fluorocarbon")
    for name, row, where in lines:
        fit = one.grid.interference[row]
        after = int(np.searchsorted(speeds, where))
        sides = speeds[after - 1], speeds[after]
        if name.startswith("sliding"):
            happens = [float(sliding_growth(rig, v, fit, 2214.0)) > 0.0 for v in sides]
        else:
            happens = [sticks(rig, v, fit) for v in sides]
        assert happens == [name not in RISING, name in RISING], (name, row, where)
    # No change of either is without its line.
    for row in range(2):
        for name, values in (
            ("stick", one.regime[0, 0, row] == Regime.STICK_SLIP.value),
            ("sliding", one.growth[0, 0, row] > 0.0),
        ):
            changes = np.count_nonzero(values[1:] != values[:-1])
            assert changes == sum(n.startswith(name) and r == row for n, r, _ in lines)


def test_what_is_quiet_is_named(found):
    told = [
        [text.get_text() for panel in plot_screen(one).axes for text in panel.texts]
        for one in found.maps
    ]
    assert told == [[], ["none"] * 4]
