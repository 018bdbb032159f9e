"""Every kind of page in a browser: on screens and on paper, quiet, safe, and what a click plays."""

from __future__ import annotations

import re

import numpy as np
import pytest

from models.rig_file import load_material_rig
from noise.cli import main
from noise.identification import law_fit
from noise.identification.law_model import CANDIDATES
from noise.pages.diagnosis import write_diagnosis
from noise.pages.review import review
from noise.pages.screening import write_screening
from noise.screening.design import Design, Use
from noise.screening.screen import screen
from tests.blind.identify import make_rig, write_rig
from tests.helpers.browser import OpenedPage, accessibility_errors
from tests.helpers.made_diagnoses import KINDS
from tests.helpers.made_reviews import write_campaign

WIDTHS = (320, 390, 720, 961, 1280, 1920)
PAPER = (round(186 * 96.0 / 25.4), round(273 * 96.0 / 25.4))
"""A4 within the margins of the pages' own rule, in the browser's pixels."""

OLD, NEW, QUIET = "old <b>", "new & damped", "PDMS"
CREAK, SQUEAL = "day1/recordings/creak.wav", "day1/recordings/squeal.wav"


def report(folder):
    assert main(["demo", "--out", str(folder)]) == 0


def reviewed(folder):
    write_campaign(folder / "day1")
    (folder / "day1" / "recordings" / "broken.wav").write_bytes(b"RIFF no more")
    review(folder, folder / "report.html", title="A review & more")


def screened(folder):
    rig = load_material_rig("fluorocarbon")
    designs = [Design(OLD, rig), Design(NEW, rig.changed(damping="x2"))]
    designs.append(Design(QUIET, load_material_rig("PDMS")))
    use = Use(
        speed=tuple(np.linspace(1.0, 12.0, 12)),
        interference=(0.279e-3, 0.381e-3),
        support_stiffness=(2214.0,),
    )
    found = screen(designs, use)
    write_screening(folder / "report.html", found, sounds=9, workers=2)
    return found


def diagnosis(kind):
    return lambda folder: write_diagnosis(folder, KINDS[kind]())


def identification(folder):
    write_rig(make_rig(1, 0, recordings=3), folder / "data")
    known = str(folder / "data" / "known.toml")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(law_fit, "CANDIDATES", CANDIDATES[:2])
        assert main(["identify", str(folder / "data"), "--rig", known, "--out", str(folder)]) == 0


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Make each kind of page once; give its file, and what was returned."""
    known = {}

    def page(make):
        if make not in known:
            folder = tmp_path_factory.mktemp("page")
            known[make] = folder / "report.html", make(folder)
        return known[make]

    return page


ALL = [
    reviewed, screened,
    *(pytest.param(diagnosis(kind), id=kind) for kind in ("one effect", "none", "pressure alone")),
    *(pytest.param(make, marks=pytest.mark.slow) for make in (report, identification)),
]  # fmt: skip


@pytest.mark.parametrize("make", ALL)
def test_a_page_is_accessible_fits_every_screen_and_paper_and_asks_nothing(browser, made, make):
    opened = OpenedPage(browser, made(make)[0])
    page = opened.page
    page.wait_for_function("[...document.images].every((image) => image.complete)")
    if page.locator(".card .play").count():
        page.locator(".card .play").first.click()
        page.wait_for_function("() => engine.playing && engine.now() > 0.05")
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 800})
        right = page.evaluate(
            "Math.max(...[...document.querySelectorAll('text, td, th, p, .player *, .card > *')]"
            ".filter((e) => e.checkVisibility()).map((e) => e.getBoundingClientRect().right))"
        )
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert right <= width + 1
        if width in (390, 1280):
            assert accessibility_errors(page) == []
    assert opened.complaints == []
    assert [url.partition(":")[0] for url in opened.requests].count("file") == 1
    assert {url.partition(":")[0] for url in opened.requests} <= {"file", "data"}
    page.set_viewport_size(dict(zip(("width", "height"), PAPER, strict=True)))
    page.emulate_media(media="print")
    pdf = page.pdf(format="A4", prefer_css_page_size=True)
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", pdf)) <= 12
    page.close()


class Opened(OpenedPage):
    """A page with cards and maps."""

    def card(self, title):
        return self.page.locator(".card", has=self.page.get_by_role("heading", name=title))

    def play(self, title):
        self.card(title).get_by_role("button", name="Play", exact=False).click()
        self.page.wait_for_function("() => engine.playing && engine.now() > 0.05")

    def spot(self, name, number=0):
        design = [OLD, NEW, QUIET].index(name)
        self.page.locator(f"[data-map][data-design='{design}'] .spot").nth(number).click()
        self.page.wait_for_function("() => engine.playing && engine.now() > 0.05")


@pytest.fixture
def shown(browser, made):
    """Open a page, the first sound of which may be tapped."""
    pages = []

    def opened(make, **options):
        pages.append(Opened(browser, made(make)[0], **options))
        return pages[-1]

    yield opened
    for one in pages:
        one.page.close()


def test_a_click_plays_and_the_cursor_moves_and_keys_go_from_sound_to_sound(shown):
    opened = shown(reviewed)
    opened.play(CREAK)
    cursor = opened.card(CREAK).locator(".cursor")
    opened.page.wait_for_function(
        "(cursor) => parseFloat(cursor.style.left) > 20", arg=cursor.element_handle()
    )
    assert not opened.card(SQUEAL).locator(".cursor").is_visible()
    opened.page.keyboard.press("Space")
    titles = []
    for key in ("ArrowDown", "ArrowUp"):
        opened.page.keyboard.press(key)
        titles.append(opened.state()["title"])
        assert opened.page.locator(".card.chosen h3").text_content() == titles[-1]
    assert titles[0] != titles[1] == CREAK
    opened.page.evaluate("engine.seek(0)")
    opened.page.keyboard.press("Shift+ArrowRight")
    opened.page.keyboard.press("Shift+ArrowRight")
    assert opened.state()["at"] == pytest.approx(0.2)
    opened.page.get_by_role("button", name="squeal 1").click()
    assert opened.card(SQUEAL).is_visible()
    assert not opened.card(CREAK).is_visible()


def test_changing_over_leaves_no_gap_and_both_run_in_step(shown):
    opened = shown(reviewed, tapped=True)
    for slot in "AB":
        opened.card(SQUEAL).get_by_role("button", name=f"into {slot}").click()
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
    assert level.min() > 0.97 * level.max() > 0.05


def test_a_click_on_a_map_plays_the_nearest_sound_and_says_which(shown):
    opened = shown(screened)
    plot = opened.page.locator("[data-map][data-design='0'] .plot")
    box = plot.bounding_box()
    plot.click(position={"x": 0.45 * box["width"], "y": 0.97 * box["height"]})
    opened.page.wait_for_function("() => engine.playing")
    told = opened.page.locator("#status").filter(has_text="Nearest sound")
    told.wait_for()
    text = told.text_content()
    assert re.search(r"mm: (\w+)\. Nearest sound of that label: .*: A \1, .*; B ", text)
    assert text == opened.page.locator(".told").first.text_content()
    pressed = opened.page.locator("[data-design='0'] .spot[aria-pressed='true']")
    assert pressed.count() == 1
    assert opened.state()["title"].startswith(f"{OLD}: ")


def test_a_click_on_the_other_map_changes_over_without_a_jump(shown):
    opened = shown(screened)
    opened.page.locator("#design-b").select_option(label=NEW)
    opened.spot(OLD, 1)
    opened.page.wait_for_function("() => engine.now() > 0.3")
    before, after = opened.page.evaluate(
        """() => {
          const before = engine.now();
          document.querySelectorAll("[data-design='1'] .spot")[1].click();
          return [before, engine.now()];
        }"""
    )
    assert after == pytest.approx(before, abs=0.03)
    opened.page.wait_for_function("() => engine.gains.b === 1 && engine.gains.a === 0")
    assert opened.state()["title"].startswith(f"{NEW}: ")
