"""One recording in the app: what is seen, read and heard in a browser."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers.browser import accessibility_errors
from tests.helpers.opened_app import served_app
from tests.helpers.recording_page import TONE, OpenPage, write_sounds


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


def test_a_segment_is_played_at_the_stated_gain(browser, shown):
    opened = OpenPage(browser, shown, tapped=True).open(TONE)
    opened.page.evaluate("document.activeElement.blur()")
    opened.press("]", " ")  # half a second, again and again
    opened.is_playing()
    opened.page.evaluate("hearAnew()")
    assert np.abs(opened.more()).max() == pytest.approx(np.sqrt(2.0) / 2.0, rel=1e-2)
    words = opened.page.locator(".gains").text_content()
    assert "full scale = 2 Pa (100 dB peak re 20 µPa)" in words
    opened.close()


def test_an_accessibility_checker_finds_nothing_and_nothing_is_wider(browser, shown):
    opened = OpenPage(browser, shown).open(TONE)
    for width in (1280, 390):
        opened.page.set_viewport_size({"width": width, "height": 900})
        for key in ("?", "Escape"):
            opened.press(key)
            assert accessibility_errors(opened.page) == []
        assert opened.page.evaluate("document.documentElement.scrollWidth") <= width
    opened.page.get_by_role("button", name="Loop").click()  # off: it comes to its end
    opened.page.locator(".play").filter(has_text="Play").wait_for()
    opened.close()
