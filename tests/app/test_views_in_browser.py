"""Views of the app beside each other, in a browser."""

from __future__ import annotations

from tests.helpers.jury_sounds import write_tones
from tests.helpers.opened_app import served_app


def test_the_token_stays_in_the_tab_and_the_tasks_leave_quit_in_reach(browser, tmp_path):
    with served_app(write_tones(tmp_path)) as app:
        page = browser.new_page()
        page.goto(app.address)
        page.locator(".recording-list .row").first.wait_for()
        assert page.url == f"{app.base}/#labels"
        page.get_by_text("What can I do?").click()
        tasks, end = page.locator(".tasks ul").bounding_box(), page.locator("#stop").bounding_box()
        assert tasks["y"] >= end["y"] + end["height"]
        page.reload()
        page.locator(".recording-list .row").first.wait_for()
        page.go_back()
        assert "token" not in page.url
