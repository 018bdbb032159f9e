"""Pictures of screened designs."""

import numpy as np
import pytest
from matplotlib.colors import to_hex

from noise.pictures.maps import plot_screen
from noise.screening.design import Use
from tests.helpers.quick_screens import quick_screen


@pytest.fixture(scope="module")
def found():
    use = Use(
        speed=tuple(np.linspace(1.0, 15.0, 6)),
        interference=(0.279e-3,),
        support_stiffness=(2214.0, 3000.0),
    )
    return quick_screen(["fluorocarbon", "PDMS"], use)


def test_lines_look_in_the_key_as_they_do_in_the_map(found):
    figure = plot_screen(found.maps[0])
    legend = figure.legends[0]
    key = {
        text.get_text(): line
        for text, line in zip(legend.get_texts(), legend.legend_handles, strict=True)
    }
    drawn = {to_hex(line.get_color()) for panel in figure.axes for line in panel.get_lines()}
    for name in ("stick ends", "sliding turns stable"):
        assert to_hex(key[name].get_color()) in drawn


def test_what_is_quiet_and_what_is_not_its_own_is_said(found):
    told = [
        [text.get_text() for panel in plot_screen(one).axes for text in panel.texts]
        for one in found.maps
    ]
    assert told == [[], ["quiet"] * 4]
    figure = plot_screen(found.maps[0])
    assert [panel.get_title("left") for panel in figure.axes[:2]] == ["2214 Nm/rad", "3000 Nm/rad*"]
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert named[-2:] == ["fastest fitted", "data interpolated or held"]
