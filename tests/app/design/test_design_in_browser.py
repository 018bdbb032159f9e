"""The design view in a browser: what is heard of a slider, how it looks."""

from __future__ import annotations

import numpy as np
import pytest

from models.rig_file import load_rig
from noise.app.design_player import RATE
from sim.acquisition import Acquisition
from sim.blocks import simulate_blocks
from tests.helpers.browser import accessibility_errors
from tests.helpers.design_page import DESIGN, DesignPage

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
    pieces = opened.heard(1500, 16)
    assert opened.sound("fullScale") == FULL_SCALE
    run = simulate_blocks(
        load_rig(tmp_path / "mine.toml"), 5.0, seconds=1.0, acquisition=Acquisition(rate=RATE)
    )
    expected = np.hstack(list(run.blocks))[2]
    # On a busy machine blocks come late and silence is between them: what fits best is whole.
    pieces = pieces[(pieces != 0.0).all(axis=1)]
    fits = [np.abs(piece - simulated(piece, expected)).max() for piece in pieces]
    best = int(np.argmin(fits))
    at, gain = place(pieces[best], expected)
    assert gain == pytest.approx(1.0 / FULL_SCALE, rel=1e-4)
    assert fits[best] < 1e-3 * np.abs(gain * expected[at : at + pieces.shape[1]]).max()
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
    opened.page.get_by_text("beyond 13").wait_for()
    opened.page.locator("#view-design .level").get_by_text("dB(A)").wait_for()
    opened.close()


def test_it_fits_and_everybody_can_use_it(browser, app):
    opened = DesignPage(browser, app)
    opened.play()
    opened.type("change-damping", 1.5)
    opened.choose_base("PDMS")
    opened.type("support", 20)
    opened.page.locator(".refusal").get_by_text("off the plate").wait_for()
    opened.page.get_by_text("Dropped with mine.toml: Damping 1.5 x.").wait_for()
    assert opened.value("support") == "20"  # the condition stays
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
