"""Designs that cannot be, in a browser: what is said of what is heard and shown meanwhile."""

from __future__ import annotations

import pytest

from models.rig_file import load_rig
from tests.helpers.design_page import DESIGN, DesignPage

IMPOSSIBLE = {
    "support": (20, "off the plate"),  # as it is read
    "change-kinetic_torque": (0.01, "no motion can be computed"),  # as it is simulated
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


def test_numbers_that_cannot_be_have_no_facts_beside_them_and_no_sound(browser, app):
    opened = DesignPage(browser, app)
    fact = "document.querySelector('.row:has(#design-change-damping) .fact').textContent"
    opened.until(f"{fact}.endsWith('Nm s/rad')")
    opened.type("support", 20)
    opened.page.locator(".refusal").get_by_text("off the plate").wait_for()
    opened.until(f"{fact} === ''")
    opened.page.locator("#view-design .play").click()
    opened.until(f"{DESIGN}.sound.refusedSerial === {DESIGN}.sound.serial")
    opened.page.locator(".level").get_by_text("Not playing.").wait_for()
    opened.type("support", 3745)
    opened.until(f"{fact}.endsWith('Nm s/rad')")
    assert opened.page.locator(".refusal").text_content() == ""
    opened.forgive_refusals()
    opened.close()


def test_the_length_of_the_rubber_is_heard_and_saved_with_reflections_of_the_room(
    browser, app, tmp_path
):
    opened = DesignPage(browser, app)
    opened.page.get_by_text("Effects of the radiation", exact=True).click()
    opened.page.locator("#design-effect-room_reflections").check()
    opened.play()
    opened.type("change-length", 1.2)
    opened.until(f"{DESIGN}.sound.heardSerial === {DESIGN}.sound.serial")
    assert opened.marked() == []
    opened.page.get_by_role("button", name="Save rig file").click()
    opened.page.locator(".saved").get_by_text("design.toml").first.wait_for()
    saved = load_rig(tmp_path / "design.toml")
    assert saved.sleeve.length == pytest.approx(
        1.2 * load_rig(tmp_path / "mine.toml").sleeve.length
    )
    opened.close()
