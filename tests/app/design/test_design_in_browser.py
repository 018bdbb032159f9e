"""The design view in a browser: what is heard of a slider, how it looks."""

from __future__ import annotations

import time

import numpy as np
import pytest

from models.rig_file import load_rig
from noise.app.design_player import RATE
from sim.acquisition import Acquisition
from sim.run import simulate
from tests.helpers.browser import WatchedPage, accessibility_errors, styled
from tests.helpers.opened_app import PATIENCE

DESIGN = "document.querySelector('#view-design').design"
SLACK = 200
"""Samples that are compared later than they begin: a gain takes so long to be another."""


class DesignPage(WatchedPage):
    """The view, shown."""

    def __init__(self, browser, app, width=1280, *, tapped=False):
        super().__init__(browser, f"{app.address}#design", width, tapped=tapped)
        self.ready()

    def ready(self):
        self.until(f"Boolean({DESIGN}?.ready)")
        styled(self.page)

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
        self.until(f"{DESIGN}.sound.blocks >= {self.sound('blocks') + n}")

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
        self.until(f"{DESIGN}.sound.blocks > 10", 6 * PATIENCE)  # it may be compiled first
        self.until(f"{DESIGN}.sound.heardSerial !== undefined")

    def marked(self):
        """Headings of what is marked as of the previous design."""
        return self.page.evaluate(
            "[...document.querySelectorAll('#view-design h2')].filter((one) =>"
            " getComputedStyle(one, '::after').content.includes('of the previous design'))"
            ".map((one) => one.textContent)"
        )

    def forgive_refusals(self):
        """Forget what the browser complains of where the server refuses a design."""
        self.complaints = [one for one in self.complaints if "400" not in one]

    def played(self, n, pieces):
        """Pieces of what the loudspeaker got, from shortly after the first that is not 0."""
        first = f"window.heard.findIndex((one) => one !== 0) + {SLACK}"
        self.until(f"window.heard.length > {first} + {n * pieces}")
        found = np.array(self.page.evaluate(f"window.heard.slice({first}, {first} + {n * pieces})"))
        return found.reshape(pieces, n)


FULL_SCALE = 5.0
"""Louder than anything here [Pa]."""


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
    pieces = opened.played(1500, 16)
    assert opened.sound("fullScale") == FULL_SCALE
    rig, through = load_rig(tmp_path / "mine.toml"), Acquisition(rate=RATE, noise={})
    expected = simulate(rig, 5.0, seconds=4.0, acquisition=through).recording["pressure"]
    # On a busy machine blocks come late and silence is between them: what fits best is whole.
    pieces = pieces[(pieces != 0.0).all(axis=1)]
    fits = [np.abs(piece - simulated(piece, expected)).max() for piece in pieces]
    best = int(np.argmin(fits))
    at, gain = place(pieces[best], expected)
    assert gain == pytest.approx(1.0 / FULL_SCALE, rel=1e-4)
    largest = np.abs(expected[at : at + pieces.shape[1]]).max()
    assert fits[best] < abs(gain) * (1e-3 * largest + 6.0 * Acquisition().noise["pressure"])
    opened.close()


def test_a_slider_is_heard(browser, app):
    opened = DesignPage(browser, app)
    opened.play()
    for value in range(300, 900, 60):
        opened.slide("speed", value)
        opened.blocks(2)
    opened.until(f"{DESIGN}.sound.heardSerial === {DESIGN}.sound.serial")
    opened.until(f"Math.abs({DESIGN}.speed - 21) < 0.1")
    assert opened.page.locator("#design-speed").input_value() == "21"
    opened.page.get_by_text("above 13 rad/s").wait_for()
    opened.page.locator("#view-design .level").get_by_text("dB(A)").wait_for()
    opened.close()


def test_it_fits_and_everybody_can_use_it(browser, app):
    opened = DesignPage(browser, app)
    opened.play()
    opened.type("change-damping", 1.5)
    opened.choose_base("PDMS")
    opened.type("support", 20)
    opened.page.locator(".refusal").get_by_text("off the plate").wait_for()
    assert (opened.value("support"), opened.value("change-damping")) == ("20", "1.5")
    for width, n_columns in ((1280, 2), (390, 1)):
        opened.page.set_viewport_size({"width": width, "height": 900})
        widths = "document.documentElement, document.querySelector('#view-design')"
        found = opened.page.evaluate(f"[{widths}].map((one) => one.scrollWidth)")
        assert max(found) <= width
        columns = opened.page.evaluate(
            "getComputedStyle(document.querySelector('.design-view')).gridTemplateColumns"
        )
        assert len(columns.split()) == n_columns
        assert accessibility_errors(opened.page) == []
    assert opened.marked() == ["Spectrum", "Map", "Torque"]
    opened.forgive_refusals()
    opened.close()
