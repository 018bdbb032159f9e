"""Floor and microphone: where the plate is heard, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from models.bench import Floor, Microphone, Plate
from models.errors import ParameterError
from models.structure.plate import plate_modes, pressure_response

UPRIGHT = Plate(0.5, 0.4, 0.01, 2e11, 7850.0, 0.3, 0.05, (0.0, 0.0))
RATE = 48e3


def _heard(microphone, plate=UPRIGHT, drive=(0.07, 0.04)):
    modes = plate_modes(plate, 4e3)
    return pressure_response(modes, modes.shape(*drive)[:, None], microphone, RATE, 9600)[0]


def test_a_floor_that_reflects_nothing_changes_nothing():
    place = (0.1, 0.2, 1.0)
    assert np.array_equal(
        _heard(Microphone(place, Floor("y", -0.5, 0.0))), _heard(Microphone(place))
    )


def test_next_to_a_rigid_floor_the_pressure_doubles():
    place = (0.1, -0.6, 1.0)
    doubled = _heard(Microphone(place, Floor("y", -0.6 - 1e-9, 1.0)))
    assert doubled == pytest.approx(2 * _heard(Microphone(place)), abs=1e-9)


def test_a_floor_is_the_plates_mirror_image():
    # the image: the same plate beyond the floor, driven at the mirrored point
    floor = Floor("x", 0.8, 0.7)
    place = (0.2, 0.1, 0.9)
    heard = _heard(Microphone(place, floor))
    mirrored_from_image = (0.2 - 1.6, 0.1, 0.9)
    image = _heard(Microphone(mirrored_from_image), drive=(-0.07, 0.04))
    assert heard == pytest.approx(_heard(Microphone(place)) + 0.7 * image, abs=1e-9)


def test_a_ceiling_answers_after_the_way_there_and_back():
    place = (0.0, 0.0, 0.5)
    echo = _heard(Microphone(place, Floor("z", 2.0, 1.0))) - _heard(Microphone(place))
    first = 3.5 / 343.2 * RATE
    assert not np.any(echo[: int(first) - 2])
    assert np.any(echo[int(first) - 2 : int(first) + 200])


@pytest.mark.parametrize(
    ("floor", "message"),
    [
        (Floor("y", 0.1), "must have the plate, to +-0.2 m"),
        (Floor("x", 0.3), "the microphone, at 0.35 m, on the same side"),
        (Floor("z", -1.0), "must be above the microphone"),
        (Floor("z", 0.8), "must be above the microphone"),
    ],
)
def test_a_floor_where_none_can_be_is_refused(floor, message):
    with pytest.raises(ParameterError) as refused:
        Microphone((0.35, 0.0, 1.0), floor).images(UPRIGHT)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_floor_of_no_kind_is_refused():
    with pytest.raises(ParameterError, match="normal = 'up'"):
        Floor("up", 1.0)
    with pytest.raises(ParameterError, match=r"reflection = 1\.2"):
        Floor("y", 1.0, 1.2)
    with pytest.raises(ParameterError, match="position_m = inf"):
        Floor("y", float("inf"))
