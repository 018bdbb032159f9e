"""One recording in the app: what is seen, played and corrected in a browser."""

from __future__ import annotations

import re

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.base.tables import write_table
from noise.labels.table import COLUMNS, read_label_table
from noise.recordings import write_recording
from tests.helpers.browser import accessibility_errors
from tests.helpers.labelled_folder import made_row
from tests.helpers.opened_app import served_app
from tests.helpers.recording_page import TONE, OpenPage, in_table, write_sounds


@pytest.fixture
def folder(tmp_path):
    return write_sounds(tmp_path)


@pytest.fixture
def app(browser, folder):
    with served_app(folder) as running:
        yield running


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


def test_borders_are_moved_by_keys_and_pointer_and_undone(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    before = in_table(folder)
    opened.page.locator(".handle").first.focus()
    for _ in range(3):
        opened.press("ArrowRight")
    opened.page.wait_for_function(
        "() => document.querySelector('.handle').getAttribute('aria-valuenow') === '0.530'"
    )
    opened.saved()
    x, y = opened.at(1.5)
    opened.page.mouse.move(x, y)
    opened.page.mouse.down()
    opened.page.mouse.move(*opened.at(1.7), steps=4)
    opened.page.mouse.up()
    opened.page.wait_for_function(
        "() => document.querySelectorAll('.handle')[1].getAttribute('aria-valuenow') > 1.65"
    )
    opened.saved()
    assert [row[0] for row in in_table(folder)] == pytest.approx([0.0, 0.53, 1.7], abs=0.004)
    opened.page.mouse.move(*opened.at(1.7, lane="div.strip"))
    opened.page.mouse.down()
    opened.page.mouse.move(*opened.at(1.6, lane="div.strip"), steps=4)
    opened.page.mouse.up()
    opened.page.wait_for_function(
        "() => document.querySelectorAll('.handle')[1].getAttribute('aria-valuenow') < 1.65"
    )
    opened.saved()
    assert in_table(folder)[2][0] == pytest.approx(1.6, abs=0.004)
    for _ in range(10):
        if in_table(folder) == before:
            break
        opened.undo()
    assert in_table(folder) == before
    opened.close()


def test_a_stretch_of_both_tracks_is_labelled_by_a_drag_and_a_key(browser, tmp_path):
    noise = np.random.default_rng(0).normal(0.0, 0.01, (2, 96_000))
    write_recording(
        tmp_path / "both.wav",
        Recording(noise, 48_000.0, (Channel("pressure"), Channel("pressure_2"))),
    )
    rows = [made_row("both.wav", "none", channel=track) for track in ("1", "2")]
    write_table(tmp_path / "labels.csv", COLUMNS, rows)
    with served_app(tmp_path) as app:
        opened = OpenPage(browser, app).open("both.wav")  # which it is at once
        opened.page.mouse.move(*opened.at(0.5))
        opened.page.mouse.down()
        opened.page.mouse.move(*opened.at(1.0), steps=4)
        opened.page.mouse.up()
        opened.press("3")
        opened.saved()
        found = read_label_table(tmp_path / "labels.csv")
        assert [row["label"] for row in found] == ["none", "squeal", "none"] * 2
        assert {row["label_source"] for row in found if row["label"] == "none"} == {"classifier"}
        assert [row["start_s"] for row in found] == pytest.approx([0.0, 0.5, 1.0] * 2, abs=0.004)
        assert opened.page.locator(".strip .lane").count() == 1  # they are alike
        opened.page.get_by_role("option").filter(has_text="partly corrected").wait_for()
        opened.press("Control+z")
        opened.page.locator(".saved").filter(has_text="undone").wait_for()
        assert len(read_label_table(tmp_path / "labels.csv")) == 2
        opened.press("Control+Shift+z", "c")
        opened.page.get_by_role("option").filter(has_text=re.compile(", corrected")).wait_for()
        assert {r["label_source"] for r in read_label_table(tmp_path / "labels.csv")} == {"human"}
        opened.close()


def test_what_another_page_has_changed_is_shown_and_not_overwritten(browser, app, folder):
    one, other = (OpenPage(browser, app).open(TONE) for _ in range(2))
    go_on = other.holding("recordings?*")  # or it would show the change before its own key
    one.press("]", "1")
    one.saved()
    other.press("[", "2")
    other.page.locator(".saved").filter(has_text="not saved").wait_for()
    go_on()
    other.page.locator(".strip .creak").wait_for()
    assert [row[2:] for row in in_table(folder)] == [
        ("none", "classifier"),
        ("creak", "human"),
        ("none", "classifier"),
    ]
    other.press("2")
    other.saved()
    assert [row[2] for row in in_table(folder)] == ["squawk", "creak", "none"]
    for opened in (one, other):
        opened.complaints.clear()  # of the refusal, which the browser tells as an error
        opened.close()


def test_keys_during_a_save_count_in_their_order(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("segments")
    opened.press("1", "]", "2", "u", "]", "3")  # the first is taken back by none of these
    go_on()
    opened.page.locator(".strip button").nth(2).and_(opened.page.locator(".squeal")).wait_for()
    opened.saved()
    assert [row[2:] for row in in_table(folder)] == [
        ("creak", "human"),
        ("squeal", "classifier"),
        ("squeal", "human"),
    ]
    opened.close()
