"""The review page in a browser: what is heard, where the cursor is, what the keys do."""

from __future__ import annotations

import numpy as np
import pytest

from noise.pages.diagnosis import write_diagnosis
from noise.pages.review import review
from tests.helpers.browser import OpenedPage, refuses_other_sources
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


def test_a_second_click_pauses_where_it_is(opened):
    opened.play(CREAK)
    opened.card(CREAK).get_by_role("button", name="Pause").click()
    paused = opened.state()
    opened.page.wait_for_timeout(100)
    assert not paused["playing"]
    assert opened.state()["at"] == paused["at"] > 0.0


def test_a_click_into_the_picture_goes_there(opened):
    at = (
        opened.card(SQUEAL)
        .locator(".seek")
        .evaluate(
            """(picture) => {
          const box = picture.getBoundingClientRect();
          const clientX = box.left + 0.5 * box.width;
          picture.dispatchEvent(new MouseEvent("click", { bubbles: true, clientX }));
          return engine.now();
        }"""
        )
    )
    assert at == pytest.approx(1.5, abs=0.02)
    opened.page.wait_for_function("() => engine.playing")
    assert opened.state()["title"] == SQUEAL


def test_changing_over_keeps_the_position_and_crosses_the_gains(opened):
    opened.put("A", CREAK)
    opened.put("B", SQUEAL)
    opened.page.keyboard.press("Space")
    opened.page.wait_for_function("() => engine.playing && engine.now() > 0.3")
    before, after = opened.page.evaluate(
        """() => {
          const before = engine.now();
          document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "b", bubbles: true }));
          return [before, engine.now()];
        }"""
    )
    assert after == pytest.approx(before, abs=0.02)
    opened.page.wait_for_function("() => engine.gains().b === 1 && engine.gains().a === 0")
    assert opened.state()["title"] == SQUEAL
    opened.page.keyboard.press("a")
    opened.page.wait_for_function("() => engine.gains().a === 1 && engine.gains().b === 0")
    assert opened.state()["playing"]


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


def test_a_recording_is_found_under_every_label_in_it_and_titled_by_the_longest_first(opened):
    assert opened.card(CREAK).locator(".head .badge").all_text_contents() == ["creak", "none"]
    opened.page.get_by_role("button", name="none 2").click()
    assert opened.card(CREAK).is_visible()
    assert not opened.card(SQUEAL).is_visible()


def test_a_loop_goes_on_and_without_it_the_sound_ends(opened):
    opened.play(CREAK)
    opened.page.keyboard.press("End")
    opened.page.evaluate("engine.seek(1.3)")
    opened.page.wait_for_function("() => engine.playing && engine.now() < 1.0")
    opened.page.keyboard.press("l")
    assert opened.page.locator("#loop").get_attribute("aria-pressed") == "false"
    opened.page.wait_for_function("() => !engine.playing")
    assert opened.state()["at"] == 0.0


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


def test_shift_puts_the_chosen_sound_into_a_slot(opened):
    opened.page.keyboard.press("ArrowDown")
    opened.page.keyboard.press("Shift+B")
    state = opened.state()
    assert state["b"] == state["a"] is not None


def test_space_plays_after_a_click_and_presses_the_button_that_has_the_focus(opened):
    opened.play(CREAK)
    opened.page.keyboard.press("Space")
    assert not opened.state()["playing"]
    opened.page.locator("#loop").focus()
    opened.page.keyboard.press("Space")
    assert not opened.state()["playing"]
    assert not opened.state()["looping"]


def test_a_question_mark_opens_the_help_and_escape_closes_it(opened):
    opened.page.keyboard.press("?")
    dialog = opened.page.get_by_role("dialog", name="Keys")
    dialog.wait_for()
    opened.page.keyboard.press("ArrowDown")
    assert opened.state()["title"] is None
    opened.page.keyboard.press("Escape")
    dialog.wait_for(state="hidden")


def test_the_focus_can_be_seen(opened):
    for _ in range(4):
        opened.page.keyboard.press("Tab")
        width = opened.page.evaluate("getComputedStyle(document.activeElement).outlineWidth")
        assert float(width.removesuffix("px")) >= 3.0


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


def test_arrows_go_from_spot_to_spot_on_a_map(opened):
    spots = opened.page.locator("[data-map]").first.locator(".spot")
    spots.first.focus()
    opened.page.keyboard.press("ArrowRight")
    label = opened.page.evaluate("document.activeElement.getAttribute('aria-label')")
    assert label != spots.first.get_attribute("aria-label")
    opened.page.keyboard.press("Enter")
    opened.page.wait_for_function("() => engine.playing")
    assert label.partition(":")[0] in opened.state()["title"]


def test_a_map_that_cannot_be_heard_says_why(opened):
    mud = opened.page.locator("[data-map]", has_text="mud")
    assert "No sounds: environment 'mud' is unknown" in mud.text_content()


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


def test_the_page_itself_forbids_other_sources(opened):
    refuses_other_sources(opened.page)


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


def test_every_picture_is_drawn(opened):
    opened.page.wait_for_function("() => [...document.images].every((image) => image.complete)")
    drawn = opened.page.evaluate(
        "[...document.querySelectorAll('main img')].map((image) => image.naturalWidth)"
    )
    assert len(drawn) >= 5
    assert min(drawn) > 0


def test_in_print_all_pictures_stay_and_the_player_goes(opened):
    opened.page.emulate_media(media="print")
    assert not opened.page.locator("#player").is_visible()
    assert not opened.card(CREAK).get_by_role("button", name="Play").is_visible()
    assert opened.card(CREAK).locator(".view img").is_visible()
    assert opened.card(CREAK).locator(".band").first.is_visible()


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
