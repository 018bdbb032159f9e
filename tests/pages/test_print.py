"""Pages on paper: what the browser's print makes of each, as a PDF of A4."""

from __future__ import annotations

import re

import pytest

from noise.cli import main
from noise.identification import law_choice
from noise.identification.law_candidates import CANDIDATES
from noise.pages.diagnosis import write_diagnosis
from noise.recordings import write_recording
from tests.blind.identify.rigs import make_rig, write_rig
from tests.helpers.made_diagnoses import KINDS
from tests.helpers.made_reviews import recording, screen_rows, write_campaign, write_screen

MILLIMETRE = 96.0 / 25.4
MOST_OPEN = 4
"""Comparisons of designs that are not folded, at first."""

WIDTH, HEIGHT = round(186 * MILLIMETRE), round(273 * MILLIMETRE)
"""Of A4 within the margins of the pages' own rule, in the browser's pixels."""

CUT = """([selector, height]) => {
  const stays = (node) => {
    for (let one = node; one && one !== document.body; one = one.parentElement)
      if (getComputedStyle(one).breakInside === "avoid" && one.offsetHeight !== undefined
          && one.getBoundingClientRect().height <= height) return true;
    return false;
  };
  const shown = [...document.querySelectorAll(selector)].filter((node) =>
    node.checkVisibility() && node.getBoundingClientRect().height > 2);
  return [shown.length, shown.filter((node) => !stays(node)).map((node) =>
    `${node.tagName} ${node.getAttribute("class")} ${node.textContent.slice(0, 40)}`)];
}"""
"""How many are printed of what has to stay whole, and what of it a page break may cut."""


def demo(folder):
    assert main(["demo", "--out", str(folder)]) == 0


def review(folder):
    write_campaign(folder / "data")
    for number in range(5):
        kind = ("creak", "squeal", "hiss")[number % 3]
        write_recording(folder / "data" / "recordings" / f"more {number}.wav", recording(kind))
    rows = [
        {**row, "support_stiffness_Nm_rad": support}
        for support in (2214.0, 3000.0, 3745.0, 5000.0, "fixed")
        for name in ("fluorocarbon", "PDMS")
        for row in screen_rows(name)
    ]
    write_screen(folder / "screen", rows)
    call = ["review", str(folder / "data"), str(folder / "screen"), "--simulated", "0"]
    assert main([*call, "--out", str(folder / "report.html")]) == 0


def screen(folder):
    conditions = ["--speed", "1..12/4", "--interference", "0.279", "--support-stiffness", "2214"]
    call = ["screen", "fluorocarbon", "PDMS", *conditions, "--sounds", "3"]
    assert main([*call, "--out", str(folder)]) == 0


def diagnosis(folder):
    write_diagnosis(folder, KINDS["one effect"]())


def identification(folder):
    write_rig(make_rig(1, 0, recordings=3), folder / "data")
    known = str(folder / "data" / "known.toml")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(law_choice, "CANDIDATES", CANDIDATES[:2])
        assert main(["identify", str(folder / "data"), "--rig", known, "--out", str(folder)]) == 0


KINDS_OF_PAGE = (
    review, diagnosis,
    *(pytest.param(made, marks=pytest.mark.slow) for made in (demo, screen, identification)),
)  # fmt: skip


@pytest.fixture(scope="module", params=KINDS_OF_PAGE)
def page(request, browser, tmp_path_factory):
    folder = tmp_path_factory.mktemp("print")
    request.param(folder)
    page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
    page.emulate_media(media="print")
    page.goto((folder / "report.html").as_uri())
    page.wait_for_function("[...document.images].every((image) => image.complete)")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    yield page
    page.close()


def test_no_picture_and_no_row_is_cut_in_two(page):
    printed = 0
    for selector in ("main img", "tbody tr", ".map svg", "figure", ".card"):
        count, cut = page.evaluate(CUT, [selector, HEIGHT])
        assert cut == []
        printed += count
    assert printed > 5


def test_all_that_is_folded_away_on_the_screen_is_printed(page):
    folded = "[...document.querySelectorAll('details:not([open])')].length"
    assert page.evaluate(folded) == 0
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    places = page.locator("details").count()
    assert page.evaluate(folded) == max(0, places - MOST_OPEN)
    page.evaluate("dispatchEvent(new Event('beforeprint'))")


def test_it_becomes_a_pdf_of_few_pages(page):
    pdf = page.pdf(format="A4", prefer_css_page_size=True)
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    assert pdf.startswith(b"%PDF")
    assert 1 <= pages <= 12
