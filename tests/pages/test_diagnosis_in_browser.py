"""The report of a diagnosis in a real browser."""

from __future__ import annotations

import pytest

from noise.pages.diagnosis import write_diagnosis
from tests.helpers.made_diagnoses import KINDS

SHOWN = ("none", "one effect", "pair", "triple", "pressure alone")
"""Kinds that are laid out differently."""

WIDTHS = (320, 390, 720, 960, 961, 1280, 1920)


class Opened:
    """A diagnosis in the browser, with all that the page complains of and asks for."""

    def __init__(self, browser, folder, diagnosis):
        write_diagnosis(folder, diagnosis)
        self.diagnosis = diagnosis
        self.complaints = []
        self.requests = []
        self.page = browser.new_page(viewport={"width": 1280, "height": 800})
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto((folder / "report.html").as_uri())
        self.page.wait_for_function("[...document.images].every((image) => image.complete)")

    def resize(self, width):
        self.page.set_viewport_size({"width": width, "height": 800})


@pytest.fixture(scope="module", params=SHOWN)
def opened(request, browser, tmp_path_factory):
    made = Opened(browser, tmp_path_factory.mktemp("diagnosis"), KINDS[request.param]())
    yield made
    made.page.close()


def text(locator):
    return locator.inner_text().replace("\u00a0", " ")


def test_the_sections_stand_in_the_order_of_their_rank(opened):
    judged, shown = opened.diagnosis.verdict, opened.diagnosis.illustrations
    assert opened.page.locator("main h2").all_inner_texts() == [
        *(["Where it lies", "How far it closes", "Which cause"] if judged else []),
        *(["Each stage of the chain", "What else it could be"] if not judged else []),
        "What to measure next",
        "What to bear in mind",
        *(["Measured against simulated"] if shown else []),
        "Details",
    ]


def test_the_page_fits_the_width_of_every_screen(opened):
    for width in WIDTHS:
        opened.resize(width)
        assert opened.page.evaluate("document.documentElement.scrollWidth") <= width, width
        right = opened.page.evaluate(
            "Math.max(...[...document.querySelectorAll('text, td, th, p')]"
            ".filter((e) => e.checkVisibility()).map((e) => e.getBoundingClientRect().right))"
        )
        assert right <= width, width


def test_every_player_is_ready_and_one_stops_the_other(opened):
    players = opened.page.locator(".card .play")
    expected = sum(2 + (one.after is not None) for one in opened.diagnosis.illustrations)
    assert players.count() == expected
    for index in range(min(2, expected)):
        players.nth(index).click()
        opened.page.wait_for_function(
            "() => engine.playing && engine.now() > 0.05 && engine.length() > 0.5"
        )
        assert players.nth(index).text_content() == "Pause"
    if expected:
        assert players.nth(0).text_content() == "Play"
        players.nth(1).click()
        assert players.nth(1).text_content() == "Play"
        opened.page.evaluate("document.getElementById('player').classList.remove('used')")


def test_the_page_is_quiet_and_asks_nothing_of_the_network(opened):
    assert opened.complaints == []
    assert {url.partition(":")[0] for url in opened.requests} <= {"file", "data"}
