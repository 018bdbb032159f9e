"""Corrections of one recording in a browser: by keys, by mouse, while answers are awaited."""

from __future__ import annotations

import pytest

from tests.helpers.browser import until
from tests.helpers.recording_page import HALF, TONE, OpenPage, in_table


def test_split_join_undo_and_borders_by_keys_and_pointer(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    before = in_table(folder)
    opened.page.mouse.move(*opened.at(1.0))
    opened.press("s")
    opened.page.locator(".strip button").nth(3).wait_for()
    opened.saved()
    assert len(in_table(folder)) == 4
    assert in_table(folder)[2][0] == pytest.approx(1.0, abs=0.005)
    opened.press("Delete")
    opened.page.wait_for_function("() => document.querySelectorAll('.strip button').length === 3")
    opened.page.locator(".handle").first.focus()
    for _ in range(3):
        opened.press("ArrowRight")
    opened.page.wait_for_function(
        "() => document.querySelector('.handle').getAttribute('aria-valuenow') === '0.530'"
    )
    opened.saved()
    x, y = opened.at(1.5)
    opened.page.mouse.move(x, y)
    opened.page.mouse.down()
    opened.page.mouse.move(*opened.at(1.7), steps=4)
    opened.page.mouse.up()
    opened.page.wait_for_function(
        "() => document.querySelectorAll('.handle')[1].getAttribute('aria-valuenow') > 1.65"
    )
    opened.saved()
    assert [row[0] for row in in_table(folder)] == pytest.approx([0.0, 0.53, 1.7], abs=0.004)
    opened.page.mouse.move(*opened.at(1.7, lane="div.strip"))
    opened.page.mouse.down()
    opened.page.mouse.move(*opened.at(1.6, lane="div.strip"), steps=4)
    opened.page.mouse.up()
    opened.page.wait_for_function(
        "() => document.querySelectorAll('.handle')[1].getAttribute('aria-valuenow') < 1.65"
    )
    opened.saved()
    assert in_table(folder)[2][0] == pytest.approx(1.6, abs=0.004)
    for _ in range(10):
        if in_table(folder) == before:
            break
        opened.undo()
    assert in_table(folder) == before
    opened.close()


def test_changes_that_wait_are_written_although_another_recording_is_opened(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("segments")
    opened.press("1", "]", "2")  # the second waits for the first
    opened.page.get_by_role("option").filter(has_text=HALF).first.click()
    opened.page.get_by_role("heading", name=HALF).wait_for()
    go_on()
    opened.page.locator(".strip button").first.wait_for()
    until(opened.page, lambda: [row[2] for row in in_table(folder)] == ["creak", "squawk", "none"])
    assert opened.segments() == ["squeal, 0.00 to 2.00 s"]
    opened.close()


def test_what_another_page_has_changed_is_shown_and_not_overwritten(browser, app, folder):
    one, other = (OpenPage(browser, app).open(TONE) for _ in range(2))
    one.press("]", "1")
    one.saved()
    other.press("[", "2")
    other.page.locator(".saved").filter(has_text="not saved").wait_for()
    other.page.locator(".strip .creak").wait_for()
    assert [row[2:] for row in in_table(folder)] == [
        ("none", "classifier"),
        ("creak", "human"),
        ("none", "classifier"),
    ]
    other.press("2")
    other.saved()
    assert [row[2] for row in in_table(folder)] == ["squawk", "creak", "none"]
    for opened in (one, other):
        opened.complaints.clear()  # of the refusal, which the browser tells as an error
        opened.close()


def test_keys_during_a_save_count_in_their_order(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("segments")
    opened.press("1", "]", "2", "u", "]", "3")  # the first is taken back by none of these
    go_on()
    opened.page.locator(".strip button").nth(2).and_(opened.page.locator(".squeal")).wait_for()
    opened.saved()
    assert [row[2:] for row in in_table(folder)] == [
        ("creak", "human"),
        ("squeal", "classifier"),
        ("squeal", "human"),
    ]
    opened.close()
