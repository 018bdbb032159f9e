"""The list beside the recording that is open, in a browser."""

from __future__ import annotations

import pytest

from tests.helpers.opened_app import opened_app
from tests.helpers.recording_page import TONE, OpenPage


@pytest.mark.parametrize("sort", ["least sure first"])
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
