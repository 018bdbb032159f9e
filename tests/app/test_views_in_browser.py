"""Views of the app beside each other, in a browser."""

from __future__ import annotations

import pytest

from tests.helpers.browser import styled
from tests.helpers.jury_sounds import write_tones
from tests.helpers.opened_app import opened_app

STYLES = """(selector) => [document.querySelector(selector)].map((node) => {
  const style = getComputedStyle(node);
  return [node.className, style.position, style.display, style.borderWidth, style.padding];
})"""

ROWS = {"design": ".design-view .row", "jury": ".jury .sounds li"}


@pytest.mark.parametrize("view", ROWS)
def test_a_view_looks_the_same_whichever_was_open_before(browser, view, tmp_path):
    with opened_app(write_tones(tmp_path)) as app:
        page = browser.new_page()
        page.goto(f"{app.address}#{view}")
        page.locator(ROWS[view]).first.wait_for()
        styled(page)
        alone = page.evaluate(STYLES, ROWS[view])
        page.goto("about:blank")
        page.goto(app.address)
        page.locator(".recording-list .row").first.wait_for()
        page.locator(f"#tab-{view}").click()
        page.locator(ROWS[view]).first.wait_for()
        styled(page)
        assert page.evaluate(STYLES, ROWS[view]) == alone


def test_the_token_stays_in_the_tab_and_not_in_its_address(browser, tmp_path):
    with opened_app(write_tones(tmp_path)) as app:
        page = browser.new_page()
        page.goto(app.address)
        page.locator(".recording-list .row").first.wait_for()
        assert page.url == f"{app.base}/#labels"
        page.reload()
        page.locator(".recording-list .row").first.wait_for()
        page.go_back()
        assert "token" not in page.url
