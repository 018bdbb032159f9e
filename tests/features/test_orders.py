"""What a turning shaft sets off stays at its order, and what resonates at its frequency."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from features.kernels.orders import order_map
from models.errors import ParameterError

RATE = 24_000.0


def strongest(found):
    orders = np.sqrt(found.order_edges[:-1] * found.order_edges[1:])
    return orders[np.nanargmax(found.level, axis=0)]


@given(first=st.floats(300.0, 900.0), slowest=st.floats(0.5, 5.0), ratio=st.floats(1.5, 5.0))
@settings(max_examples=15)
def test_an_order_stays_while_the_speed_changes(first, slowest, ratio):
    order = 2.0 * np.pi * first / slowest  # at the frequency `first` where it begins
    speed = np.linspace(slowest, ratio * slowest, round(3.0 * RATE))
    found = order_map(np.sin(order * np.cumsum(speed) / RATE), RATE, speed)
    assert found.level.shape[1] > 10
    assert strongest(found) == pytest.approx(np.full(found.level.shape[1], order), rel=0.12)


def test_a_tone_has_its_level_at_every_speed():
    speed = np.linspace(2.0, 8.0, round(3.0 * RATE))
    tone = np.sqrt(2.0) * np.sin(2.0 * np.pi * 1000.0 * np.arange(speed.size) / RATE)
    level = np.nanmax(order_map(tone, RATE, speed, reference=1.0).level, axis=0)
    assert level == pytest.approx(np.zeros_like(level), abs=1.5)


@pytest.mark.parametrize(
    ("signal", "speed", "said"),
    [
        (np.zeros(100), np.ones(100), "0.085 s"),
        (np.zeros(24_000), np.ones(23_000), "a speed for each sample"),
        (np.ones(24_000), np.zeros(24_000), "stands"),
    ],
)
def test_what_has_no_orders_is_refused(signal, speed, said):
    with pytest.raises(ParameterError, match=said):
        order_map(signal, RATE, speed)
