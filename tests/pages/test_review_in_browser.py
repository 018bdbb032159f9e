"""The review page in a browser: what is heard, where the cursor is, what the keys do."""

from __future__ import annotations

import numpy as np
import pytest

from noise.pages.diagnosis import write_diagnosis
from noise.pages.review import review
from tests.helpers.browser import OpenedPage
from tests.helpers.made_diagnoses import one_effect
from tests.helpers.made_reviews import screen_rows, write_campaign, write_screen

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
CREAK, SQUEAL = "day1/recordings/creak.wav", "day1/recordings/squeal.wav"


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("review")
    write_campaign(folder / "day1")
    write_screen(folder / "screen", screen_rows() + screen_rows(environment="mud"))
    write_diagnosis(folder / "diagnosis", one_effect())
    (folder / "day1" / "recordings" / "broken.wav").write_bytes(b"RIFF no more")
    review(folder, folder / "out" / "review.html", title="A review & more", simulated=4)
    return folder / "out" / "review.html"


class Opened(OpenedPage):
    """The page of a review, whose sounds are on cards."""

    def card(self, title):
        return self.page.locator(".card", has=self.page.get_by_role("heading", name=title))

    def play(self, title):
        self.card(title).get_by_role("button", name="Play", exact=False).click()
        self.page.wait_for_function("() => engine.playing && engine.now() > 0.05")

    def put(self, slot, title):
        self.card(title).get_by_role("button", name=f"into {slot}").click()


@pytest.fixture
def opened(browser, page_file):
    fresh = Opened(browser, page_file)
    yield fresh
    fresh.page.close()


def test_a_click_plays_and_the_position_and_its_cursor_move(opened):
    opened.play(CREAK)
    cursor = opened.card(CREAK).locator(".cursor")
    assert opened.state()["title"] == CREAK
    for share in (0.2, 0.6):
        opened.page.wait_for_function(
            """([cursor, share]) => {
              const told = parseFloat(document.getElementById("time").textContent) / 1.5;
              return [told, parseFloat(cursor.style.left) / 100].every(
                (at) => Math.abs(at - share) < 0.2);
            }""",
            arg=[cursor.element_handle(), share],
        )
    assert cursor.is_visible()
    assert not opened.card(SQUEAL).locator(".cursor").is_visible()


def test_changing_over_leaves_no_gap_and_both_run_in_step(browser, page_file):
    opened = Opened(browser, page_file, tapped=True)
    opened.put("A", SQUEAL)
    opened.put("B", SQUEAL)
    opened.page.keyboard.press("Space")
    opened.page.wait_for_function("() => engine.playing && engine.now() > 0.3")
    opened.page.evaluate("hearAnew()")
    for key in "baxx":
        known = opened.page.evaluate("heard.length")
        opened.page.keyboard.press(key)
        opened.page.wait_for_function("(n) => heard.length > n", arg=known + 6000)
    heard = np.array(opened.page.evaluate("heard"))
    cycles = heard[: heard.size // 100 * 100].reshape(-1, 100)  # two of the tone, and a little
    level = cycles.max(axis=1)
    assert level.min() > 0.97 * level.max() > 0.1
    opened.page.close()


def test_equal_loudness_changes_the_gain_while_it_is_on(opened):
    opened.play(CREAK)
    factor = opened.page.evaluate("about[engine.key].equal")
    assert abs(factor - 1.0) > 0.05
    opened.page.keyboard.press("e")
    opened.page.wait_for_function(
        "(factor) => Math.abs(engine.gains().a - factor) < 1e-4", arg=factor
    )
    assert "for equal loudness" in opened.page.locator("#status").text_content()
    opened.page.keyboard.press("e")
    opened.page.wait_for_function("() => engine.gains().a === 1")


def test_recordings_of_one_label_can_be_shown_alone(opened):
    opened.page.get_by_role("button", name="squeal 1").click()
    assert opened.card(SQUEAL).is_visible()
    assert not opened.card(CREAK).is_visible()
    opened.page.get_by_role("button", name="all 3").click()
    assert opened.card(CREAK).is_visible()


def test_arrows_move_in_time_and_from_sound_to_sound(opened):
    keyboard = opened.page.keyboard
    keyboard.press("ArrowDown")
    first = opened.state()["title"]
    keyboard.press("ArrowDown")
    second = opened.state()["title"]
    assert first != second
    assert opened.page.locator(".card.chosen h3").text_content() == second
    assert opened.page.evaluate("document.activeElement.classList.contains('chosen')")
    keyboard.press("ArrowUp")
    assert opened.state()["title"] == first
    opened.page.evaluate("engine.seek(0)")
    keyboard.press("Shift+ArrowRight")
    keyboard.press("Shift+ArrowRight")
    assert opened.state()["at"] == pytest.approx(0.2)
    keyboard.press("ArrowLeft")
    assert opened.state()["at"] == 0.0


def test_a_spot_on_a_map_plays_its_sound(opened):
    spot = opened.page.get_by_role("button", name="10 rad/s, 0.279 mm: squeal")
    spot.click()
    opened.page.wait_for_function("() => engine.playing")
    assert opened.state()["title"] == SQUEAL
    assert spot.get_attribute("aria-pressed") == "true"


def test_a_click_beside_the_spots_plays_the_nearest_of_its_label_and_says_so(opened):
    plot = opened.page.locator("[data-map] .plot").first
    box = plot.bounding_box()
    plot.click(position={"x": 0.05 * box["width"], "y": 0.9 * box["height"]})
    opened.page.wait_for_function("() => engine.playing")
    said = opened.page.locator("#status").text_content()
    assert "mm: creak, 80 dB(A), simulated. Nearest sound of that label: 2 rad/s" in said
    assert "creak, stick-slip, 80 dB(A)" in said
    assert opened.page.locator("#status").text_content() == (
        opened.page.locator(".told").first.text_content()
    )


def test_measured_and_simulated_of_a_diagnosis_can_be_compared(opened):
    section = opened.page.locator(".diagnosis")
    assert "Missing: partial slip" in section.text_content()
    assert section.locator("[data-play]").count() >= 2
    section.locator("[data-play]").nth(1).click()
    opened.page.wait_for_function("() => engine.playing && engine.now() > 0.05")


def test_the_page_is_quiet_and_asks_nothing_of_the_network(opened):
    opened.play(CREAK)
    opened.put("B", SQUEAL)
    opened.page.keyboard.press("b")
    opened.page.wait_for_timeout(200)
    assert opened.complaints == []
    assert {url.partition(":")[0] for url in opened.requests} <= {"file", "data"}
    assert sum(url.startswith("file") for url in opened.requests) == 1


@pytest.mark.parametrize("width", [320, 390, 720, 960, 1280, 1920])
def test_the_page_fits_the_width_of_every_screen(browser, page_file, width):
    opened = Opened(browser, page_file, width)
    assert opened.page.evaluate("document.documentElement.scrollWidth") <= width
    beyond = opened.page.evaluate(
        "[...document.querySelectorAll('.player *, .card > *, .map > *')]"
        ".filter((one) => one.getClientRects().length)"
        ".filter((one) => one.getBoundingClientRect().right > innerWidth + 1)"
        ".map((one) => one.outerHTML.slice(0, 90))"
    )
    assert beyond == []
    opened.page.close()


@pytest.mark.parametrize("width", [390, 1280])
def test_an_accessibility_checker_finds_nothing(browser, page_file, width):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not there")
    opened = Opened(browser, page_file, width)
    opened.play(CREAK)
    for key in ("", "?"):
        if key:
            opened.page.keyboard.press(key)
        tags = {"runOnly": {"type": "tag", "values": RULES}}
        found = axe.Axe().run(opened.page, options=tags).response
        wrong = [(one["id"], one["nodes"][0]["html"][:150]) for one in found["violations"]]
        assert wrong == []
        assert len(found["passes"]) > 15
    opened.page.close()
