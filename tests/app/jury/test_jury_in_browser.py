"""A jury in a browser: begun, voted by keys, killed, gone on with, its result; blind throughout."""

from __future__ import annotations

import re

import pytest

from noise.base.tables import read_table
from tests.helpers.browser import WatchedPage, accessibility_errors
from tests.helpers.jury_sounds import NAMES, write_tones
from tests.helpers.opened_app import opened_app


class JuryPage(WatchedPage):
    """The view of a jury, as a person with a keyboard uses it."""

    def __init__(self, browser, app, width=1280, *, tapped=False):
        super().__init__(browser, f"{app.address}#jury", width, tapped=tapped)
        self.begins = self.page.get_by_role("button", name="Begin")
        self.begins.wait_for()

    def begin(self):
        self.page.wait_for_function("() => !document.querySelector('.begin').disabled")
        self.begins.click()
        return self.turn(1)

    def turn(self, place):
        """Wait for a comparison, the first of which is 1, to be there."""
        self.page.wait_for_function(
            """(place) =>
               document.querySelector(".voting .count").textContent.startsWith(`${place} of`)
               && [...document.querySelectorAll(".side")].every((side) => !side.disabled)""",
            arg=place,
        )
        return self

    def hear(self, side):
        """Listen to a side, and return what goes to the loudspeaker after the change."""
        self.page.keyboard.press(side)
        self.page.locator(f".side[aria-pressed=true] >> text={side.upper()}").wait_for()
        return self.heard(9600)

    def listen(self):
        """Press A, then B, and wait until both have been heard."""
        for side in "ab":
            self.page.keyboard.press(side)
            self.page.locator(f".side.heard >> text={side.upper()}").wait_for()

    def vote(self, key):
        self.page.locator(".saved").evaluate("(one) => { one.textContent = ''; }")
        self.listen()
        self.page.keyboard.press(key)
        self.page.locator(".saved").filter(has_text=re.compile("^saved ")).wait_for(
            state="attached"
        )


def rows(folder):
    return read_table(folder / f"{folder.name}-votes.csv")[1]


def votes(folder):
    return [row["vote"] for row in rows(folder) if row["vote"]]


def pairs(folder):
    return [(row["first"], row["second"]) for row in rows(folder)]


@pytest.fixture
def folder(tmp_path):
    return write_tones(tmp_path)


def louder(pair):
    return "1" if NAMES.index(pair[0]) < NAMES.index(pair[1]) else "2"


def test_votes_by_keys_outlive_a_kill_and_go_on_in_the_same_order(browser, folder):
    with opened_app(folder, "--save-to", folder) as app:
        jury = JuryPage(browser, app).begin()
        order = pairs(folder)
        for place in range(3):
            jury.turn(place + 1).vote(louder(order[place]))
        jury.turn(4)
        app.kill()
        assert votes(folder) == [{"1": "first", "2": "second"}[louder(p)] for p in order[:3]]
        jury.listen()
        jury.page.keyboard.press("0")  # it is not answered, and the page says so
        jury.page.locator(".voting .saved").filter(has_text="not saved").wait_for()
        jury.page.close()
    with opened_app(folder, "--save-to", folder) as app:
        jury = JuryPage(browser, app)
        assert pairs(folder) == order
        jury.page.get_by_role("button", name="Go on with jury 1").click()
        jury.turn(4)
        for place in range(3, len(order)):
            jury.turn(place + 1).vote(louder(order[place]))
        jury.page.get_by_text(f"all {len(order)} voted").wait_for()
        jury.page.get_by_role("button", name="Result, with names").click()
        jury.page.locator(".result .scale b").nth(len(NAMES) - 1).wait_for()
        shown = jury.page.locator(".result tbody th").all_text_contents()
        assert shown == list(NAMES)
        jury.close()
    assert len(votes(folder)) == len(order)


def test_what_was_looked_at_before_is_neither_in_the_page_nor_asked_for_nor_heard(browser, folder):
    with opened_app(folder, "--save-to", folder) as app:
        jury = JuryPage(browser, app, tapped=True)
        page = jury.page
        page.locator("#tab-labels").click()
        page.locator(".recording-list .row").first.click()
        page.locator(".recording .about h2").filter(has_text="onerror").wait_for()
        page.locator(".recording .play").click()
        page.locator(".recording .play").filter(has_text="Pause").wait_for()
        page.locator("#tab-jury").click()
        jury.begin()
        told = []
        page.on("response", lambda answer: told.append(answer))
        page.wait_for_timeout(6000)  # the list asks for labels that are to come every 5 s
        jury.vote("1")
        jury.turn(2)
        for name in (*(name.removesuffix(".wav") for name in NAMES), "onerror", ".wav"):
            assert name not in page.content()
            for answer in told:
                assert name.encode() not in answer.body()
        assert not jury.heard(9600).any()
        page.locator("#tab-labels").click()
        page.locator(".recording .about h2").filter(has_text="onerror").wait_for()
        page.keyboard.press("1")
        page.locator(".recording-list .row").first.filter(has_text="corrected").wait_for()
        jury.close()


def test_an_accessibility_checker_finds_nothing_and_nothing_is_wider(browser, folder):
    def check():
        for width in (1280, 390):
            jury.page.set_viewport_size({"width": width, "height": 900})
            assert accessibility_errors(jury.page) == []
            assert jury.page.evaluate("document.documentElement.scrollWidth") <= width

    with opened_app(folder, "--save-to", folder) as app:
        jury = JuryPage(browser, app)
        jury.page.wait_for_function("() => !document.querySelector('.begin').disabled")
        check()
        jury.begin()
        jury.listen()
        check()
        jury.vote("1")
        jury.turn(2)
        jury.page.get_by_role("button", name="Result, with names").click()
        jury.page.locator(".result .scale b").nth(1).wait_for()
        check()
        jury.page.get_by_role("button", name="To all juries").click()
        jury.page.get_by_role("button", name="Go on with jury 1").wait_for()
        check()
        jury.close()
