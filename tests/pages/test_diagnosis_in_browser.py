"""The report of a diagnosis in a real browser."""

from __future__ import annotations

import pytest

from noise.diagnosis.text.verdict_sentences import headline, verdict_sentence
from noise.pages.diagnosis import write_diagnosis
from tests.helpers.browser import refuses_other_sources
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


def test_verdict_chain_and_first_cause_are_on_the_first_screen(opened):
    opened.resize(1280)
    assert text(opened.page.locator("h1")) == headline(opened.diagnosis)
    assert text(opened.page.locator("header .verdict")) == verdict_sentence(opened.diagnosis)
    for seen in (".chain.broad", ".causes tbody tr"):
        box = opened.page.locator(seen).first.bounding_box()
        assert box["y"] + box["height"] <= 800


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


def test_the_stage_where_the_gap_begins_is_marked_at_every_width(opened):
    place = opened.diagnosis.location
    expected = [] if place is None else [place.stage]
    for width in (390, 1280):
        opened.resize(width)
        marked = opened.page.locator(".stage.guilty .name >> visible=true").all_text_contents()
        assert marked == expected


def test_the_page_fits_the_width_of_every_screen(opened):
    for width in WIDTHS:
        opened.resize(width)
        assert opened.page.evaluate("document.documentElement.scrollWidth") <= width, width
        right = opened.page.evaluate(
            "Math.max(...[...document.querySelectorAll('text, td, th, p')]"
            ".filter((e) => e.checkVisibility()).map((e) => e.getBoundingClientRect().right))"
        )
        assert right <= width, width


@pytest.mark.parametrize(("width", "media"), [(390, "screen"), (1280, "screen"), (696, "print")])
def test_words_in_the_chain_stay_in_their_boxes(opened, width, media):
    opened.resize(width)
    opened.page.emulate_media(media=media)
    try:
        outside = opened.page.evaluate(
            """() => [...document.querySelectorAll('.stage')]
              .filter((e) => e.checkVisibility() && e.getBoundingClientRect().width)
              .flatMap((stage) => {
                const box = stage.querySelector('rect').getBoundingClientRect();
                return [...stage.querySelectorAll(':scope > text:not(.begins, .cause, .passed)')]
                  .map((t) => [t.getBoundingClientRect(), t.textContent])
                  .filter(([t]) => t.width && (t.left < box.left || t.right > box.right))
                  .map(([, words]) => words);
              })"""
        )
    finally:
        opened.page.emulate_media(media="screen")
    assert outside == []


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


def test_every_picture_is_drawn_and_described(opened):
    pictures = opened.page.evaluate(
        "[...document.querySelectorAll('main .view img, .panels img')]"
        ".map((image) => [image.naturalWidth, image.alt])"
    )
    assert bool(pictures) == bool(opened.diagnosis.illustrations)
    assert all(width > 0 and alt for width, alt in pictures)


def test_the_page_is_quiet_and_asks_nothing_of_the_network(opened):
    assert opened.complaints == []
    assert {url.partition(":")[0] for url in opened.requests} <= {"file", "data"}


def test_the_page_itself_forbids_other_sources(opened):
    heard = len(opened.complaints)
    refuses_other_sources(opened.page)
    del opened.complaints[heard:]
