"""The page of a screen in a browser: what a click plays, what differs, what the keys do."""

from __future__ import annotations

import re

import numpy as np
import pytest

from models.rig_file import load_material_rig
from noise.pages.screening import write_screening
from noise.screening.design.design import Design, Use
from noise.screening.screen import screen
from tests.helpers.browser import OpenedPage

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
OLD, NEW, QUIET = "old <b>", "new & damped", "PDMS"


@pytest.fixture(scope="module")
def found():
    rig = load_material_rig("fluorocarbon")
    designs = [
        Design(OLD, rig),
        Design(NEW, rig.changed(damping="x2")),
        Design(QUIET, load_material_rig("PDMS")),
    ]
    use = Use(
        speed=tuple(np.linspace(1.0, 12.0, 12)),
        interference=(0.279e-3, 0.381e-3),
        support_stiffness=(2214.0,),
    )
    return screen(designs, use)


@pytest.fixture(scope="module")
def page_file(found, tmp_path_factory):
    path = tmp_path_factory.mktemp("screen") / "report.html"
    write_screening(path, found, sounds=9, workers=2)
    return path


@pytest.fixture
def opened(browser, page_file):
    fresh = OpenedPage(browser, page_file)
    yield fresh
    fresh.page.close()


def map_of(opened, name):
    number = [OLD, NEW, QUIET].index(name)
    return opened.page.locator(f"[data-map][data-design='{number}']")


def click_spot(opened, name, number=0):
    map_of(opened, name).locator(".spot").nth(number).click()
    opened.page.wait_for_function("() => engine.playing && engine.now() > 0.05")


def choose(opened, slot, name):
    opened.page.locator(f"#design-{slot}").select_option(label=name)


def of(title):
    return title.partition(": ")[0]


def said(opened):
    return opened.page.locator(".differs").text_content()


def test_a_click_on_the_other_map_changes_over_without_a_jump(opened):
    choose(opened, "b", NEW)
    click_spot(opened, OLD, 1)
    opened.page.wait_for_function("() => engine.now() > 0.3")
    before, after = opened.page.evaluate(
        """() => {
          const before = engine.now();
          document.querySelectorAll("[data-design='1'] .spot")[1].click();
          return [before, engine.now()];
        }"""
    )
    assert after == pytest.approx(before, abs=0.03)
    opened.page.wait_for_function("() => engine.gains().b === 1 && engine.gains().a === 0")
    assert of(opened.state()["title"]) == NEW
    opened.page.keyboard.press("a")
    opened.page.wait_for_function("() => engine.gains().a === 1 && engine.gains().b === 0")


def test_what_is_heard_is_the_sound_of_the_page_at_its_own_gain(browser, page_file):
    opened = OpenedPage(browser, page_file, tapped=True)
    click_spot(opened, OLD, 2)
    opened.page.evaluate("hearAnew()")
    opened.page.wait_for_function("() => heard.length >= 96000")
    heard = np.array(opened.page.evaluate("heard.slice(0, 96000)"))
    kept = np.array(
        opened.page.evaluate(
            """async () => {
              const text = atob(document.getElementById("sound-" + engine.key).textContent);
              const bytes = Uint8Array.from(text, (one) => one.charCodeAt(0));
              const context = new OfflineAudioContext(1, 1, 48000);
              const buffer = await context.decodeAudioData(bytes.buffer);
              return [...buffer.getChannelData(0)];
            }"""
        )
    )
    # Once around the loop, wherever it began.
    assert np.sqrt(np.mean(heard**2)) == pytest.approx(np.sqrt(np.mean(kept**2)), rel=0.03)
    assert np.abs(heard).max() == pytest.approx(np.abs(kept).max(), rel=0.03)
    opened.page.close()


@pytest.mark.parametrize(("first", "second"), [(OLD, NEW), (NEW, OLD), (OLD, QUIET), (QUIET, NEW)])
def test_the_difference_is_that_of_the_pair_that_was_chosen(opened, found, first, second):
    choose(opened, "a", first)
    choose(opened, "b", second)
    one, other = (
        next(mapped for mapped in found.maps if mapped.design == name) for name in (first, second)
    )
    before, after = (mapped.label != "none" for mapped in (one, other))
    change = np.round(other.level, 1) - np.round(one.level, 1)
    both = before & after
    expected = {
        "noise gone": before & ~after,
        "noise new": ~before & after,
        "softer by 3 dB or more": both & (change <= -3.0),
        "louder by 3 dB or more": both & (change >= 3.0),
        "another noise": both & (one.label != other.label),
    }
    told = dict(re.findall(r"(\w[\w ]*?) at <?(\d+) %", said(opened)))
    assert {words: pytest.approx(float(told.get(words, 0)), abs=0.51) for words in expected} == {
        words: 100.0 * where.mean() for words, where in expected.items()
    }


def test_a_click_beside_the_spots_tells_both_designs_and_plays_the_nearest(opened):
    choose(opened, "b", NEW)
    plot = map_of(opened, OLD).locator(".plot")
    box = plot.bounding_box()
    plot.click(position={"x": 0.62 * box["width"], "y": 0.05 * box["height"]})
    opened.page.wait_for_function("() => engine.playing")
    told = opened.page.locator(".told").text_content()
    assert "0.4" in told.split(" mm")[0]
    assert "mm: A " in told
    assert "; B " in told
    assert "Nearest sound" in told


def test_all_is_done_by_keys_alone(opened):
    page = opened.page
    map_of(opened, OLD).locator(".spot").first.focus()
    page.keyboard.press("ArrowRight")
    label = page.evaluate("document.activeElement.getAttribute('aria-label')")
    page.keyboard.press("Enter")
    page.wait_for_function("() => engine.playing")
    assert label.split(":")[0] in opened.state()["title"]
    page.keyboard.press("x")
    assert opened.state()["active"] == "b"
    page.locator("#design-b").focus()
    page.keyboard.press("ArrowUp")
    assert f"against A, {OLD}" in said(opened)
    assert page.locator("#design-b").input_value() != page.locator("#design-a").input_value()
    page.locator("[data-look='level']").focus()
    page.keyboard.press("Enter")
    assert page.locator("[data-look='level']").get_attribute("aria-pressed") == "true"


def test_maps_show_noise_levels_or_how_points_are_known(opened):
    words = {}
    for look in ("noise", "level", "how"):
        opened.page.locator(f"[data-look='{look}']").click()
        drawn = map_of(opened, OLD).locator("svg")
        words[look] = drawn.locator("text").all_text_contents()
        fills = drawn.locator("rect:visible").evaluate_all(
            "(all) => [...new Set(all.map((one) => one.getAttribute('fill')))]"
        )
        assert all(name in " ".join(fills) for name in {"noise": ["squ"]}.get(look, [f"{look}-"]))
        key = opened.page.locator(f"[data-key='{look}']")
        assert look == "noise" or key.is_visible()
    assert any("dB(A)" in text or text.startswith("Sk") for text in words["noise"])
    assert any(text[:2].isdigit() for text in words["level"])
    assert words["how"] == []


def test_the_page_is_quiet_and_asks_nothing_of_the_network(opened):
    click_spot(opened, OLD)
    choose(opened, "b", QUIET)
    for look in ("level", "how", "noise"):
        opened.page.locator(f"[data-look='{look}']").click()
    opened.page.set_viewport_size({"width": 700, "height": 800})
    opened.page.wait_for_timeout(200)
    assert opened.complaints == []
    assert {url.partition(":")[0] for url in opened.requests} <= {"file", "data"}


@pytest.mark.parametrize("width", [390, 1400])
def test_an_accessibility_checker_finds_nothing(browser, page_file, width):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not there")
    opened = OpenedPage(browser, page_file, width)
    click_spot(opened, OLD)
    for look in ("noise", "level", "how"):
        opened.page.locator(f"[data-look='{look}']").click()
        tags = {"runOnly": {"type": "tag", "values": RULES}}
        found = axe.Axe().run(opened.page, options=tags).response
        wrong = [(one["id"], one["nodes"][0]["html"][:150]) for one in found["violations"]]
        assert wrong == []
    opened.page.close()
