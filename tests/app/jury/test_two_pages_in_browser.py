"""Two pages of one jury, and answers that come late: each vote is one that was given, once."""

from __future__ import annotations

import pytest

from tests.helpers.browser import until
from tests.helpers.jury_page import JuryPage, rows, votes
from tests.helpers.jury_sounds import NAMES, write_tones
from tests.helpers.opened_app import opened_app


@pytest.fixture
def folder(tmp_path):
    return write_tones(tmp_path)


@pytest.fixture
def app(folder):
    with opened_app(folder) as running:
        yield running


class Held:
    """Requests for addresses that match, of which none is answered before it suits."""

    def __init__(self, page, pattern):
        self.page, self.held, self.answers = page, [], False
        page.route(pattern, self._hold)

    def _hold(self, route):
        if self.answers:
            route.fallback()
        else:
            self.held.append(route)

    def until(self, number):
        until(self.page, lambda: len(self.held) == number)

    def answer(self):
        answered = []
        self.page.on("requestfinished", lambda request: answered.append(request.url))
        self.answers = True
        for route in self.held:
            route.continue_()
        until(self.page, lambda: {route.request.url for route in self.held} <= set(answered))


def says(jury, text):
    jury.page.locator(".voting .saved").filter(has_text=text).wait_for(state="attached")


def test_an_undo_takes_back_the_vote_that_its_page_shows_and_no_other(browser, app, folder):
    first = JuryPage(browser, app).begin()
    first.vote("1")
    first.turn(2)
    second = JuryPage(browser, app)
    second.go_on(1)
    second.turn(2).vote("0")
    second.turn(3)
    first.page.keyboard.press("u")
    says(first, "the vote on comparison 1 that was to be undone is not the last one any more")
    first.turn(3).is_refused()
    assert votes(folder) == ["first", "equal"]
    first.page.keyboard.press("u")  # which it shows now
    first.turn(2)
    assert votes(folder) == ["first"]
    first.close()
    second.close()


def test_after_a_vote_that_is_refused_the_page_shows_the_jury_as_it_is(browser, app, folder):
    first = JuryPage(browser, app).begin()
    second = JuryPage(browser, app)
    second.go_on(1)
    second.turn(1).vote("0")
    second.turn(2)
    first.listen()
    first.page.keyboard.press("1")
    says(first, "comparison 1 is not the one whose turn it is; shown is what is saved")
    first.turn(2).is_refused()
    first.vote("2")
    first.turn(3)
    assert votes(folder) == ["equal", "second"]
    assert first.page.locator("#status").text_content() == ""
    first.close()
    second.close()


def test_a_vote_whose_answer_is_lost_counts_once(browser, app, folder):
    jury = JuryPage(browser, app).begin()

    def lose(route):
        route.fetch()
        route.abort()

    jury.page.route("**/vote", lose, times=1)
    jury.listen()
    jury.page.keyboard.press("1")
    says(jury, "no answer; shown is what is saved")
    jury.turn(2).is_refused()
    assert votes(folder) == ["first"]
    assert jury.page.locator("#status").text_content() == ""
    jury.close()


def test_a_key_that_is_held_undoes_one_vote(browser, app, folder):
    jury = JuryPage(browser, app).begin()
    for place in (1, 2):
        jury.turn(place).vote("0")
    jury.turn(3)
    jury.page.keyboard.down("u")
    jury.turn(2)
    jury.page.keyboard.down("u")  # as the system repeats it
    jury.page.keyboard.up("u")
    jury.vote("1")
    jury.turn(3)
    assert votes(folder) == ["equal", "first"]
    jury.close()


@pytest.mark.parametrize("late", ["**/api/juries/1", "**/api/juries/1/heard/**"])
def test_what_is_answered_late_of_a_jury_that_was_left_is_neither_shown_nor_heard(
    browser, app, folder, late
):
    app.json("api/juries", {"sounds": [0, 1], "question": "One?"})
    app.json("api/juries", {"sounds": [1, 3], "question": "Two?"})
    jury = JuryPage(browser, app, tapped=True)
    held = Held(jury.page, late)
    jury.go_on(1)
    held.until(2 if "heard" in late else 1)
    jury.page.get_by_role("button", name="Stop here").click()
    jury.go_on(2)
    jury.turn(1)
    held.answer()
    assert jury.page.locator(".voting h2").text_content() == "Two?"
    levels = sorted(abs(jury.hear(side)).max() for side in "ab")
    assert levels[1] / levels[0] == pytest.approx(8.0, rel=0.02)  # the loudest and the softest
    jury.vote("1")
    jury.page.get_by_text("all 1 voted").wait_for()
    assert [(row["jury"], row["vote"]) for row in rows(folder)] == [("1", ""), ("2", "first")]
    jury.close()


def test_names_that_are_answered_late_are_not_in_the_page_of_who_votes(browser, app):
    jury = JuryPage(browser, app).begin()
    held = Held(jury.page, "**/result")
    jury.page.get_by_role("button", name="Result, with names").click()
    jury.page.get_by_role("button", name="Go on voting").click()
    held.until(1)
    jury.turn(1)
    held.answer()
    jury.vote("1")
    jury.turn(2)
    assert "onerror" not in jury.page.content()
    jury.close()


def test_a_jury_that_is_being_prepared_is_neither_changed_nor_begun_twice(browser, app):
    jury = JuryPage(browser, app)
    held = Held(jury.page, "**/juries/prepare")
    jury.page.wait_for_function("() => !document.querySelector('.begin').disabled")
    box = jury.page.get_by_label("softer.wav")
    places = [one.bounding_box() for one in (jury.begins, box, jury.begins)]
    for at in places:
        jury.page.mouse.click(at["x"] + at["width"] / 2, at["y"] + at["height"] / 2)
    held.until(1)
    assert box.is_checked()
    held.answer()
    jury.turn(1)
    assert [one["sounds"] for one in app.json("api/juries")["juries"]] == [len(NAMES)]
    jury.close()


def test_sounds_are_those_that_were_searched_for_last(browser, app):
    jury = JuryPage(browser, app)
    jury.page.get_by_label("softer.wav").wait_for()
    held = Held(jury.page, "**/recordings?*text=softe*")
    find = jury.page.get_by_label("Find")
    find.fill("softe")
    held.until(1)
    find.fill("loud")
    jury.page.get_by_label("softer.wav").wait_for(state="detached")
    held.answer()
    jury.page.get_by_role("button", name="None", exact=True).click()
    assert jury.page.locator(".sounds span").all_text_contents() == ["loudest.wav"]
    jury.close()
