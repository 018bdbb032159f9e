"""The design view in a browser: what is heard of a slider, what is kept, how it looks."""

from __future__ import annotations

import time

import numpy as np
import pytest

from models.rig_files.rig_file import load_rig
from noise.app.design.player import RATE
from sim.acquisition import Acquisition
from sim.long_run import simulate_blocks
from tests.helpers.browser import chromium, new_page, styled
from tests.helpers.opened_app import PATIENCE, opened_app

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
DESIGN = "document.querySelector('#view-design').design"
FULL_SCALE = 5.0
"""Louder than anything here [Pa]."""
SLACK = 200
"""Samples that are compared later than they begin: a gain takes so long to be another."""


class DesignPage:
    """The view, shown."""

    def __init__(self, browser, app, width=1280, *, tapped=False):
        self.complaints = []
        self.page = new_page(browser, tapped=tapped, viewport={"width": width, "height": 900})
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(f"{app.address}#design")
        self.ready()

    def ready(self):
        self.until(f"Boolean({DESIGN}?.ready)")
        styled(self.page)

    def reload(self):
        self.page.reload()
        self.ready()

    def value(self, key):
        return self.page.locator(f"#design-{key}").input_value()

    def choose_base(self, name):
        """Choose a base, and wait until its controls are shown."""
        self.page.locator("#design-base").select_option(label=name)
        chosen = "document.querySelector('#design-base').value"
        self.until(f"{DESIGN}.stated().base === {chosen}")

    def until(self, said, patience=PATIENCE):
        """Wait for something to be true; the page's policy lets nothing be evaluated within it."""
        end = time.monotonic() + patience
        while not self.page.evaluate(said):
            assert time.monotonic() < end, said
            time.sleep(0.05)

    def sound(self, what):
        return self.page.evaluate(f"{DESIGN}.sound.{what}")

    def blocks(self, n):
        """Wait until so many more blocks have come."""
        self.until(f"{DESIGN}.sound.costs.length >= {self.sound('costs.length') + n}")

    def slide(self, key, value):
        self.page.evaluate(
            "([id, value]) => { const one = document.getElementById(id); one.value = value;"
            " one.dispatchEvent(new Event('input', { bubbles: true })); }",
            [f"design-{key}-slider", value],
        )

    def type(self, key, value):
        field = self.page.locator(f"#design-{key}")
        field.fill(str(value))
        field.press("Tab")

    def play(self):
        """Play, and wait until it is heard."""
        self.page.locator("#view-design .play").click()
        self.until(f"{DESIGN}.sound.costs.length > 10", 6 * PATIENCE)  # it may be compiled first
        self.until(f"{DESIGN}.sound.heardSerial !== undefined")

    def marked(self):
        """Headings of what is marked as not of the numbers shown."""
        return self.page.evaluate(
            "[...document.querySelectorAll('#view-design h2')].filter((one) =>"
            " getComputedStyle(one, '::after').content.includes('not of these numbers'))"
            ".map((one) => one.textContent)"
        )

    def forgive_refusals(self):
        """Forget what the browser complains of where the server refuses a design."""
        self.complaints = [one for one in self.complaints if "400" not in one]

    def heard(self, n, pieces):
        """Pieces of what the loudspeaker got, from shortly after the first that is not 0."""
        first = f"window.heard.findIndex((one) => one !== 0) + {SLACK}"
        self.until(f"window.heard.length > {first} + {n * pieces}")
        found = np.array(self.page.evaluate(f"window.heard.slice({first}, {first} + {n * pieces})"))
        return found.reshape(pieces, n)

    def close(self):
        assert self.complaints == []
        self.page.close()


@pytest.fixture(scope="module")
def browser():
    with chromium() as started:
        yield started


@pytest.fixture
def app(tmp_path):
    rig = tmp_path / "mine.toml"
    rig.write_text('base = "fluorocarbon"\n[change]\ndamping = "x1.1"\n', encoding="utf-8")
    with opened_app(rig) as running:
        yield running


def place(part, whole):
    """Where a piece of sound occurs in another, and by what it is louder there."""
    n = part.size
    size = 1 << (whole.size + n).bit_length()
    product = np.fft.irfft(np.fft.rfft(whole, size) * np.conj(np.fft.rfft(part, size)), size)
    energy = np.concatenate([[0.0], np.cumsum(whole**2)])
    count = whole.size - n + 1
    match = product[:count] / np.sqrt(np.maximum(energy[n:] - energy[:-n], 1e-20))
    at = int(np.argmax(np.abs(match)))
    return at, product[at] / (energy[at + n] - energy[at])


def simulated(piece, whole):
    at, gain = place(piece, whole)
    return gain * whole[at : at + piece.size]


def test_what_the_loudspeaker_gets_is_what_simulate_gives(browser, app, tmp_path):
    opened = DesignPage(browser, app, tapped=True)
    opened.page.evaluate(f"{DESIGN}.sound.fullScale = {FULL_SCALE}")  # or it grows meanwhile
    opened.play()
    pieces = opened.heard(1500, 8)
    assert opened.sound("fullScale") == FULL_SCALE
    run = simulate_blocks(
        load_rig(tmp_path / "mine.toml"), 5.0, seconds=1.0, acquisition=Acquisition(rate=RATE)
    )
    expected = np.hstack(list(run.blocks))[2]
    # On a busy machine blocks come late and silence is between them: what fits best is whole.
    fits = [np.abs(piece - simulated(piece, expected)).max() for piece in pieces]
    best = int(np.argmin(fits))
    at, gain = place(pieces[best], expected)
    assert gain == pytest.approx(1.0 / FULL_SCALE, rel=1e-4)
    assert fits[best] < 1e-3 * np.abs(gain * expected[at : at + pieces.shape[1]]).max()
    assert opened.sound("doubled") == 0
    opened.close()


def test_a_slider_is_heard_and_how_late_is_told(browser, app):
    opened = DesignPage(browser, app)
    opened.play()
    for value in range(300, 900, 60):
        opened.slide("speed", value)
        opened.blocks(2)
    opened.until(f"{DESIGN}.sound.waiting.length === 0")
    latencies = opened.sound("latencies")
    assert len(latencies) == 10
    assert min(latencies) > 0.0
    opened.until(f"Math.abs({DESIGN}.speed - 21) < 0.1")
    assert opened.page.locator("#design-speed").input_value() == "21"
    opened.page.get_by_text("beyond 13").wait_for()
    opened.page.locator("#view-design .level").get_by_text("dB(A)").wait_for()
    opened.close()


IMPOSSIBLE = {
    "support": (20, "off the plate"),  # as it is read
    "change-kinetic_torque": (0.01, "no motion can be computed"),  # as it is simulated
    "change-clamp_inertia": (0.2, "more inertia than the clamp"),  # on the way to the microphone
}


@pytest.mark.parametrize("key", IMPOSSIBLE)
def test_a_sound_that_is_not_of_the_numbers_shown_is_marked_until_it_is(browser, app, key):
    value, why = IMPOSSIBLE[key]
    opened = DesignPage(browser, app)
    opened.play()
    assert opened.marked() == []
    before = opened.value(key)
    opened.type(key, value)
    told = opened.page.get_by_role("status").filter(has_text=why)
    told.filter(has_text="What is heard and shown is not of these numbers").wait_for()
    assert opened.marked() == ["What is heard", "Torque", "Spectrum", "Map"]
    opened.blocks(50)  # so long that all answers have come
    assert opened.sound("playing")
    assert opened.marked() == ["What is heard", "Torque", "Spectrum", "Map"]
    opened.type(key, before)
    opened.until("!document.querySelector('.refusal').textContent")
    assert opened.marked() == []
    assert opened.sound("playing")
    opened.forgive_refusals()
    opened.close()


def test_numbers_that_cannot_be_have_no_facts_beside_them_and_no_sound(browser, app):
    opened = DesignPage(browser, app)
    fact = "document.querySelector('.row:has(#design-change-damping) .fact').textContent"
    opened.until(f"{fact}.endsWith('Nm s/rad')")
    opened.type("support", 20)
    opened.page.locator(".refusal").get_by_text("off the plate").wait_for()
    opened.until(f"{fact} === ''")
    opened.page.locator("#view-design .play").click()
    opened.until(f"{DESIGN}.sound.refusedSerial === {DESIGN}.sound.serial")
    opened.page.locator(".level").get_by_text("Not playing.").wait_for()
    opened.type("support", 3745)
    opened.until(f"{fact}.endsWith('Nm s/rad')")
    assert opened.page.locator(".refusal").text_content() == ""
    opened.forgive_refusals()
    opened.close()


def test_the_length_of_the_rubber_is_heard_and_saved_with_reflections_of_the_room(
    browser, app, tmp_path
):
    opened = DesignPage(browser, app)
    opened.page.get_by_text("Effects of the radiation", exact=True).click()
    opened.page.locator("#design-effect-room_reflections").check()
    opened.play()
    opened.type("change-length", 1.2)
    opened.until(f"{DESIGN}.sound.heardSerial === {DESIGN}.sound.serial")
    assert opened.marked() == []
    opened.page.get_by_role("button", name="Save rig file").click()
    opened.page.locator(".saved").get_by_text("design.toml").first.wait_for()
    saved = load_rig(tmp_path / "design.toml")
    assert saved.sleeve.length == pytest.approx(
        1.2 * load_rig(tmp_path / "mine.toml").sleeve.length
    )
    opened.close()


def test_a_full_scale_that_is_stated_stays_as_long_as_nothing_is_louder(browser, app):
    opened = DesignPage(browser, app)
    opened.type("full-scale", 20)
    opened.play()
    assert opened.sound("fullScale") == 20.0
    opened.page.locator(".gain").get_by_text("Full scale = 20 Pa (120 dB peak").wait_for()
    opened.type("full-scale", 0.1)  # too little for a squawk, which is never clipped
    opened.blocks(30)
    opened.until(f"0.1 < {DESIGN}.sound.fullScale && {DESIGN}.sound.fullScale < 20")
    shown = "document.querySelector('#design-full-scale').value"
    assert opened.page.evaluate(f"{shown} === String({DESIGN}.sound.fullScale)")
    opened.close()


def test_a_and_b_are_switched_while_it_goes_on(browser, app):
    opened = DesignPage(browser, app)
    opened.play()
    opened.page.get_by_role("button", name="B", exact=True).click()
    opened.type("speed", 9)
    opened.page.get_by_role("button", name="A", exact=True).click()
    assert opened.page.locator("#design-speed").input_value() == "5"
    opened.page.get_by_role("button", name="B", exact=True).click()
    assert opened.page.locator("#design-speed").input_value() == "9"
    opened.until(f"{DESIGN}.sound.waiting.length === 0")
    opened.until(f"{DESIGN}.speed === 9")
    assert opened.sound("playing")
    opened.close()


def test_a_rig_file_is_saved_by_keys(browser, app, tmp_path):
    opened = DesignPage(browser, app)
    opened.type("change-damping", 1.5)
    opened.page.locator("#design-name").fill("softer")
    opened.page.keyboard.press("Tab")
    opened.page.keyboard.press("Enter")
    opened.page.locator(".saved").get_by_text("softer.toml").first.wait_for()
    softer = load_rig(tmp_path / "softer.toml")
    assert softer == load_rig(tmp_path / "mine.toml").changed(damping="x1.5")
    opened.close()


def test_a_reload_keeps_both_designs(browser, app):
    opened = DesignPage(browser, app)
    opened.type("speed", 7.5)
    opened.page.get_by_text("Friction law", exact=True).click()
    opened.page.locator("#design-law").select_option("lugre")
    opened.page.get_by_role("button", name="B", exact=True).click()
    opened.choose_base("PDMS")
    opened.type("change-wall", 1.25)
    stated = opened.page.evaluate(f"{DESIGN}.both()")
    assert stated["A"]["values"] == {"speed": 7.5, "law": "lugre"}
    assert stated["B"]["base"] == "PDMS"
    opened.reload()
    assert opened.page.evaluate(f"{DESIGN}.both()") == stated
    assert opened.page.locator("#view-design .slot[aria-pressed=true]").inner_text() == "B"
    assert (opened.value("base"), opened.value("change-wall")) == ("PDMS", "1.25")
    opened.page.get_by_role("button", name="A", exact=True).click()
    opened.until("document.querySelector('#design-law').value === 'lugre'")
    assert (opened.value("base"), opened.value("speed")) == ("rig 0", "7.5")
    opened.close()


def test_a_page_of_another_call_of_the_program_begins_anew(browser, app, tmp_path):
    opened = DesignPage(browser, app)
    opened.type("speed", 7.5)
    kept = "JSON.parse(sessionStorage.getItem('bushing-noise design'))"
    opened.page.evaluate(
        "([name, value]) => sessionStorage.setItem(name, value)",
        [
            "bushing-noise design",
            opened.page.evaluate(f"JSON.stringify({{...{kept}, session: 0}})"),
        ],
    )
    opened.reload()
    assert opened.value("speed") == "5"
    opened.close()


def test_another_base_keeps_the_condition_and_tells_what_it_drops(browser, app):
    opened = DesignPage(browser, app)
    condition = {"speed": "7.5", "interference": "0.3", "support": "3745", "temperature": "40"}
    for key, value in condition.items():
        opened.type(key, value)
    opened.type("change-damping", 1.5)
    before = opened.page.evaluate(f"{DESIGN}.stated()")
    opened.choose_base("PDMS")
    opened.page.get_by_text("Dropped with mine.toml: Damping 1.5 x.").wait_for()
    assert {key: opened.value(key) for key in condition} == condition
    assert opened.value("change-damping") == "1"
    opened.type("change-wall", 1.25)
    after = opened.page.evaluate(f"{DESIGN}.stated()")
    opened.page.get_by_role("button", name="Undo").click()
    opened.page.get_by_text("Undone.").wait_for()
    assert opened.page.evaluate(f"{DESIGN}.stated()") == before
    assert (opened.value("base"), opened.value("change-damping")) == ("rig 0", "1.5")
    opened.page.get_by_role("button", name="Redo").click()
    opened.page.get_by_text("Done again.").wait_for()
    assert opened.page.evaluate(f"{DESIGN}.stated()") == after
    opened.close()


@pytest.mark.parametrize("name", ["As the base", "Copy to the other"])
def test_what_one_press_replaces_comes_back_by_another(browser, app, name):
    opened = DesignPage(browser, app)
    opened.page.get_by_role("button", name="B", exact=True).click()
    opened.type("change-damping", 2)
    opened.page.get_by_role("button", name="A", exact=True).click()
    opened.type("change-damping", 1.5)
    before = opened.page.evaluate(f"{DESIGN}.both()")
    opened.page.get_by_role("button", name=name).click()
    assert opened.page.evaluate(f"{DESIGN}.both()") != before
    opened.page.get_by_role("button", name="Undo").click()
    opened.page.get_by_text("Undone.").wait_for()
    assert opened.page.evaluate(f"{DESIGN}.both()") == before
    opened.close()


def test_a_rig_that_was_saved_is_opened_as_it_was_heard(browser, app, tmp_path):
    opened = DesignPage(browser, app)
    opened.page.locator("#design-motion").select_option("run_up")
    for key, value in {"run_up-end": 9, "support": 3745, "change-damping": 1.5}.items():
        opened.type(key, value)
    opened.page.get_by_role("button", name="Save rig file").click()
    opened.page.locator(".saved").get_by_text("design.toml").first.wait_for()
    opened.close()
    with opened_app(tmp_path / "design.toml", tmp_path / "mine.toml") as app_:
        opened = DesignPage(browser, app_)
        assert opened.value("motion") == "run_up"
        assert (opened.value("run_up-end"), opened.value("support")) == ("9", "3745")
        opened.type("support", 3000)
        opened.choose_base("mine.toml")
        opened.choose_base("design.toml")  # what one is in the midst of stays
        opened.page.get_by_text("design.toml was saved at others").wait_for()
        assert (opened.value("motion"), opened.value("support")) == ("run_up", "3000")
        opened.page.get_by_role("button", name="As the base").click()
        assert opened.value("support") == "3745"
        opened.close()


def test_fields_show_all_digits_of_what_is_small(browser, app):
    opened = DesignPage(browser, app)
    opened.page.get_by_text("Friction law", exact=True).click()
    key = "law-contact_with_memory-ageing_time"
    opened.type(key, 0.00007535)
    field = opened.page.locator(f"#design-{key}")
    assert field.input_value() == "7.535e-5"
    assert field.evaluate("(one) => one.scrollWidth <= one.clientWidth")
    every = "[...document.querySelectorAll('#view-design .row input[type=number]')]"
    values = opened.page.evaluate(f"{every}.map((one) => one.value)")
    assert values
    assert not [value for value in values if value.lstrip("-").startswith("0.000")]
    opened.close()


@pytest.mark.parametrize("width", [390, 1280])
def test_it_fits_and_everybody_can_use_it(browser, app, width):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    opened = DesignPage(browser, app, width)
    opened.play()
    opened.type("change-damping", 1.5)
    opened.choose_base("PDMS")
    opened.type("support", 20)
    opened.page.locator(".refusal").get_by_text("off the plate").wait_for()
    opened.page.get_by_role("button", name="Undo").wait_for()
    panel = "document.querySelector('#view-design').scrollWidth"
    assert max(opened.page.evaluate(f"[document.documentElement.scrollWidth, {panel}]")) <= width
    columns = opened.page.evaluate(
        "getComputedStyle(document.querySelector('.design-view')).gridTemplateColumns.split(' ')"
    )
    assert len(columns) == (2 if width == 1280 else 1)
    found = axe.Axe().run(opened.page, options={"runOnly": RULES, "resultTypes": ["violations"]})
    assert found.violations_count == 0, found.generate_report()
    opened.forgive_refusals()
    opened.close()
