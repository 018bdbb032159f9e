"""Designs that cannot be, in a browser: what is said of what is heard and shown meanwhile."""

from __future__ import annotations

import pytest

from tests.helpers.design_page import DesignPage

IMPOSSIBLE = {
    "support": (20, "off the plate"),  # as it is read
    "change-clamp_inertia": (0.2, "more inertia than the clamp"),  # on the way to the microphone
}


@pytest.mark.parametrize("key", IMPOSSIBLE)
def test_a_sound_that_is_not_of_the_numbers_shown_is_marked_until_it_is(browser, app, key):
    value, why = IMPOSSIBLE[key]
    opened = DesignPage(browser, app)
    opened.play()
    assert opened.marked() == []
    before = opened.value(key)
    opened.type(key, value)
    told = opened.page.get_by_role("status").filter(has_text=why)
    told.filter(has_text="What is heard and shown is not of these numbers").wait_for()
    assert opened.marked() == ["What is heard", "Torque", "Spectrum", "Map"]
    opened.blocks(50)  # so long that all answers have come
    assert opened.sound("playing")
    assert opened.marked() == ["What is heard", "Torque", "Spectrum", "Map"]
    opened.type(key, before)
    opened.until("!document.querySelector('.refusal').textContent")
    assert opened.marked() == []
    assert opened.sound("playing")
    opened.forgive_refusals()
    opened.close()
