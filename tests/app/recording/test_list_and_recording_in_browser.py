"""What of the list is opened next: by the arrow, by doubt."""

from __future__ import annotations

import pytest

from tests.helpers.opened_app import opened_app
from tests.helpers.recording_page import HALF, ODD, TONE, OpenPage


def test_what_is_checked_next_is_opened_at_the_segment_in_doubt(browser, app):
    opened = OpenPage(browser, app, height=400)
    for name in (ODD, HALF, TONE):
        opened.page.get_by_role("button", name="Next to check").first.click()
        opened.page.get_by_role("heading", name=name).wait_for()
    chosen = opened.page.locator(".strip [aria-pressed=true]").filter(has_text="squeal")
    chosen.wait_for()
    assert chosen.get_attribute("aria-label").startswith("squeal, 0.50 to 1.50 s")
    assert opened.page.locator(".clock").text_content() == "0.50 s"
    box = chosen.bounding_box()
    assert 0.0 <= box["y"] <= 400 - box["height"]
    opened.close()


@pytest.mark.parametrize("sort", ["as found", "least sure first"])
def test_the_arrow_goes_on_to_the_next_after_a_corrected_recording(browser, app, sort):
    opened = OpenPage(browser, app)
    opened.page.get_by_role("combobox", name="Order").select_option(label=sort)
    opened.page.get_by_role("button", name="squeal").first.click()
    rows = opened.page.get_by_role("option").filter(has_text=".wav")
    opened.page.wait_for_function(
        "() => document.querySelectorAll('[role=option]:not([hidden])').length === 2"
    )
    first, second = (one.split("\n")[0] for one in rows.all_inner_texts())
    rows.filter(has_text=first).click()
    opened.page.get_by_role("heading", name=first).wait_for()
    opened.page.locator(".strip .segment").first.wait_for()
    if first == TONE:
        opened.press("]")
    opened.press("4")
    opened.saved()
    opened.page.wait_for_function(
        "() => document.querySelectorAll('[role=option]:not([hidden])').length === 1"
    )
    opened.page.get_by_role("listbox").focus()
    opened.press("ArrowDown", "Enter")
    opened.page.get_by_role("heading", name=second).wait_for()
    opened.close()


def test_a_double_click_on_next_to_check_opens_one(browser, app):
    opened = OpenPage(browser, app)
    asked = []
    opened.page.on("request", lambda request: asked.append(request.url))
    opened.page.get_by_role("button", name="Next to check").first.dblclick()
    opened.page.get_by_role("heading", name=ODD).wait_for()
    assert sum("/next" in url for url in asked) == 1
    opened.close()


def test_what_is_chosen_while_the_next_to_check_is_sought_stays_open(browser, app):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("next*")
    opened.press("n")
    opened.page.get_by_role("option").filter(has_text=HALF).first.click()
    opened.page.get_by_role("heading", name=HALF).wait_for()
    with opened.page.expect_response("**/next*"):
        go_on()
    opened.page.locator(".strip .squeal").wait_for()
    assert HALF in opened.page.locator("[role=option][aria-selected=true]").inner_text()
    assert opened.page.get_by_role("heading", name=HALF).is_visible()
    opened.close()


def test_the_next_is_not_split_where_the_pointer_was_on_the_one_before(browser, app):
    opened = OpenPage(browser, app).open(TONE)
    opened.page.mouse.move(*opened.at(1.2))
    opened.press("n")
    opened.page.get_by_role("heading", name=ODD).wait_for()
    opened.page.locator(".strip .unknown").wait_for()
    opened.press("s")
    opened.page.locator("#status").filter(has_text="split inside it").wait_for()
    assert len(opened.segments()) == 1
    opened.close()


def test_of_a_recording_that_cannot_be_read_the_reason_is_shown_and_nothing_of_another(
    browser, folder
):
    (folder / "bad.wav").write_bytes(b"RIFF")
    with opened_app(folder) as app:
        opened = OpenPage(browser, app).open(TONE)
        opened.page.get_by_role("option").filter(has_text="bad.wav").first.click()
        opened.page.locator(".page > p").filter(has_text="bad.wav").wait_for()
        assert not opened.page.locator(".recording").is_visible()
        opened.open(TONE)
        assert not opened.page.locator(".page > p").is_visible()
        opened.page.close()
