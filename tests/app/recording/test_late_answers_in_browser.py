"""Corrections in a browser where a save fails, an answer is late, or a table half written."""

from __future__ import annotations

import numpy as np
import pytest
import soundfile

from noise.base.tables import write_table
from noise.labels.labelling import COLUMNS
from noise.labels.table import read_label_table
from tests.helpers.browser import until
from tests.helpers.opened_app import opened_app
from tests.helpers.recording_page import TONE, OpenPage, in_table


def is_read(request):
    return request.method == "GET" and request.url.endswith("segments")


def open_without_labels(page):
    """Open the tone, until it is known that it has none: then they are asked for again."""
    with page.expect_request_finished(is_read):
        page.get_by_role("option").filter(has_text=TONE).first.click()
    with page.expect_request(is_read):
        pass


def said(folder):
    """Label of each segment, and who gave it."""
    return [row[2:] for row in in_table(folder)]


def test_keys_after_what_could_not_be_saved_overwrite_nothing(browser, app, folder):
    one, other = (OpenPage(browser, app).open(TONE) for _ in range(2))
    one.press("]", "1")
    one.saved()
    before = in_table(folder)
    held = []
    other.page.route(
        "**/segments",
        lambda route: (
            held.append(route)
            if route.request.method == "GET" and len(held) < 1
            else route.fallback()
        ),
    )
    other.press("[", "2")
    until(other.page, lambda: held)  # it was refused: what is there is read again
    other.press("u", "]", "]", "3")
    held[0].continue_()
    other.page.locator(".strip .creak").wait_for()
    other.saved()
    assert said(folder) == [("none", "classifier"), ("creak", "human"), ("squeal", "human")]
    assert in_table(folder)[:2] == before[:2]
    other.page.close()
    one.close()


def test_what_was_saved_is_shown_where_the_next_is_not(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    held = []
    opened.page.route("**/segments", lambda route: route.abort() if held else held.append(route))
    opened.press("1", "]", "2")
    until(opened.page, lambda: held)
    held[0].continue_()
    opened.page.locator(".saved").filter(has_text="not saved").wait_for()
    opened.page.locator(".strip .squawk").wait_for(state="detached")
    assert opened.segments()[0] == "creak, 0.00 to 0.50 s, by a person"
    opened.page.unroute("**/segments")
    opened.press("]", "3")
    opened.saved()
    assert [label for label, _ in said(folder)] == ["creak", "squeal", "squeal"]
    opened.page.close()


def test_a_border_that_is_let_go_during_an_undo_leaves_it_undone(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    opened.press("1")
    opened.saved()
    go_on = opened.holding("undo")
    opened.page.mouse.move(*opened.at(1.5))
    opened.page.mouse.down()
    opened.page.mouse.move(*opened.at(1.6), steps=3)
    opened.press("u")
    opened.page.mouse.move(*opened.at(1.7), steps=3)
    opened.page.mouse.up()
    go_on()
    until(opened.page, lambda: said(folder)[2] == ("none", "human"))
    assert said(folder)[:2] == [("none", "classifier"), ("squeal", "human")]
    assert in_table(folder)[1][1] == pytest.approx(1.7, abs=0.01)
    opened.close()


def test_what_was_read_before_a_label_was_given_is_not_shown_after_it(browser, app, folder):
    rows = read_label_table(folder / "labels.csv")
    write_table(folder / "labels.csv", COLUMNS, [row for row in rows if row["file"] != TONE])
    opened = OpenPage(browser, app)
    open_without_labels(opened.page)
    old = []

    def hold(route):
        if is_read(route.request) and not old:
            old.append((route, route.fetch()))
        else:
            route.fallback()

    opened.page.route("**/segments", hold)
    until(opened.page, lambda: old)  # labels are still awaited
    opened.press("1")
    opened.saved()
    with opened.page.expect_request(is_read):  # anew
        old[0][0].fulfill(response=old[0][1])
    assert opened.segments() == ["creak, 0.00 to 2.00 s, by a person"]
    opened.close()


def test_a_table_that_is_none_for_a_while_is_read_again_when_it_is_one(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    table = folder / "labels.csv"
    good = table.read_bytes()
    table.write_text("half written")
    opened.page.locator("#status").filter(has_text="no label table").wait_for()
    opened.page.get_by_role("option").filter(has_text=TONE).first.click()
    opened.page.locator(".strip button").first.wait_for(state="detached")
    table.write_bytes(good.replace(b"squeal", b"creak"))
    opened.page.locator(".strip .creak").wait_for()
    opened.page.get_by_role("option").filter(has_text="creak + none").wait_for()
    opened.page.close()


def test_a_label_before_the_classifier_names_each_track_of_a_plain_file(browser, tmp_path):
    tone = 0.1 * np.sin(2 * np.pi * 1000 * np.arange(16000) / 8000)
    soundfile.write(tmp_path / TONE, np.stack([tone, tone], axis=1), 8000)
    with opened_app(tmp_path) as app:
        opened = OpenPage(browser, app)
        open_without_labels(opened.page)
        opened.press("1")
        opened.saved()
        rows = read_label_table(tmp_path / "labels.csv")
        opened.close()
    found = [(row["channel"], row["label"], row["label_source"]) for row in rows]
    assert found == [("1", "creak", "human"), ("2", "creak", "human")]


def test_the_browser_asks_before_it_leaves_what_is_not_in_the_table_yet(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("segments")
    opened.press("1", "]", "2")
    with opened.page.expect_event("dialog") as asked:
        opened.page.evaluate("setTimeout(() => location.reload())")
    assert asked.value.type == "beforeunload"
    asked.value.dismiss()
    opened.complaints.clear()  # of the question
    go_on()
    opened.page.locator(".strip .squawk").wait_for()
    opened.saved()
    assert [label for label, _ in said(folder)] == ["creak", "squawk", "none"]
    opened.close()


def test_a_page_of_a_program_that_has_ended_changes_nothing_in_the_next_at_its_port(
    browser, app, folder
):
    opened = OpenPage(browser, app).open(TONE)
    app.kill()
    before = (folder / "labels.csv").read_bytes()
    (folder / "a.wav").write_bytes((folder / TONE).read_bytes())  # which takes another's number
    with opened_app(folder, "--port", app.base.rpartition(":")[2]) as anew:
        with opened.page.expect_popup() as popup:  # which gets the cookie of both
            opened.page.evaluate("(address) => { open(address); }", anew.address)
        other = popup.value
        other.get_by_role("option").filter(has_text=TONE).first.wait_for()
        opened.press("1")
        told = opened.page.locator(".saved").filter(has_text="not saved")
        told.filter(has_text="open the address").wait_for()
    assert (folder / "labels.csv").read_bytes() == before
    assert opened.segments()[0] == "none, 0.00 to 0.50 s"
    opened.page.close()
