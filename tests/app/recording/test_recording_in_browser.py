"""One recording in the app: what is seen, read and heard in a browser."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.helpers.browser import accessibility_errors
from tests.helpers.opened_app import served_app
from tests.helpers.recording_page import HALF, RATE, TONE, OpenPage, write_sounds


@pytest.fixture(scope="module")
def shown(browser, tmp_path_factory):
    with served_app(write_sounds(tmp_path_factory.mktemp("shown"))) as app:
        yield app


def test_the_cursor_reads_time_frequency_and_level_of_a_known_tone(browser, shown):
    opened = OpenPage(browser, shown).open(TONE)
    share = np.log(20e3 / 1000.0) / np.log(400.0)
    opened.page.mouse.move(*opened.at(1.0, share))
    readout = opened.page.locator(".readout[data-level]")
    readout.wait_for()
    read = {
        name: float(value)
        for name, value in readout.evaluate("(one) => ({...one.dataset})").items()
    }
    assert read["time"] == pytest.approx(1.0, abs=0.005)
    assert read["frequency"] == pytest.approx(1000.0, rel=0.02)
    assert read["level"] == pytest.approx(93.98, abs=0.5)
    assert "dB re 20 µPa" in readout.text_content()
    opened.page.mouse.move(*opened.at(1.0, 0.5, "canvas.course[role=img]"))
    level = opened.page.locator(".readout.level")
    level.filter(has_text=re.compile(r"^94\.0 dB\(A\) re 20 µPa, Fast$")).wait_for()
    levels = opened.page.evaluate(
        """([share]) => {
          const image = document.querySelector(".plot"), pen = image.getContext("2d");
          const column = pen.getImageData(image.width / 2, 0, 1, image.height).data;
          const pixel = (y) => column.slice(4 * Math.floor(y * image.height)).slice(0, 3);
          return [share, 0.1].map((y) => [...pixel(y)]);
        }""",
        [share],
    )
    assert max(levels[0]) < 60  # dark where the tone is
    assert min(levels[1]) > 240  # white where nothing is
    opened.close()


def tone_of(samples):
    """Amplitude and phase of 1 kHz in each hundredth of a second, by sample number."""
    turned = samples * np.exp(-2j * np.pi * 1000 * np.arange(samples.size) / RATE)
    return 2.0 * turned[: samples.size // 480 * 480].reshape(-1, 480).mean(axis=1)


def test_a_and_b_run_in_step_at_one_gain(browser, shown):
    opened = OpenPage(browser, shown, tapped=True).open(HALF)
    opened.press("b")
    opened.open(TONE)
    opened.page.evaluate("document.activeElement.blur()")
    opened.press("[", " ")  # half a second, again and again: whole cycles, so that it goes on
    opened.is_playing()
    opened.page.evaluate("hearAnew()")
    opened.more()
    opened.press("x")
    heard = opened.more()
    tone = tone_of(heard)
    louder = np.flatnonzero(np.abs(tone) > 0.99 * np.abs(tone).max())[-1]
    loud, quiet = (np.median(np.abs(part)) for part in (tone[:louder], tone[louder + 4 :]))
    assert quiet == pytest.approx(0.5 * loud, rel=1e-3)
    before, after = tone[louder - 8 : louder], tone[louder + 4 : louder + 12]
    ratio = after / before
    turn = np.angle(np.median(ratio.real) + 1j * np.median(ratio.imag))
    assert turn == pytest.approx(0.0, abs=2 * np.pi * 1000 / RATE / 20)
    words = opened.page.locator(".gains").text_content()
    assert "full scale = 2 Pa (100 dB peak re 20 µPa)" in words
    assert np.abs(heard).max() == pytest.approx(np.sqrt(2.0) / 2.0, rel=1e-2)
    opened.close()


def test_an_accessibility_checker_finds_nothing_and_nothing_is_wider(browser, shown):
    opened = OpenPage(browser, shown).open(TONE)
    opened.press("h")
    for width in (1280, 390):
        opened.page.set_viewport_size({"width": width, "height": 900})
        for key in ("?", "Escape"):
            opened.press(key)
            assert accessibility_errors(opened.page) == []
        assert opened.page.evaluate("document.documentElement.scrollWidth") <= width
    opened.page.get_by_role("button", name="Loop").click()  # off: it comes to its end
    opened.page.locator(".play").filter(has_text="Play").wait_for()
    opened.close()
