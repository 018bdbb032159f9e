from __future__ import annotations

import io

import numpy as np
import pytest
import soundfile

from models.condition import Condition
from models.recording import Channel, Recording
from noise.labels.segments import Segment
from noise.pages.report import ReportEntry, write_report
from tests.helpers.browser import refuses_other_sources

RATE = 30_000
TIME = np.arange(RATE) / RATE


def entry(label, frequency, signal, title):
    noise = np.random.default_rng(1).normal(size=(3, RATE))
    scales = np.array([[1.0], [50.0], [0.5]])
    samples = scales * signal + 1e-3 * noise + np.array([[8.0], [0.0], [0.0]])
    channels = (Channel("torque"), Channel("acceleration"), Channel("pressure"))
    condition = Condition(5.0, 0.279e-3, 2214.0, "natural-rubber-film-removed", 23.0)
    shares = {"creak": 0.1, "squawk": 0.1, "squeal": 0.1, "none": 0.1, "unknown": 0.1}
    sound = io.BytesIO()
    soundfile.write(sound, samples[2] / 2.0, RATE, format="WAV", subtype="FLOAT")
    return ReportEntry(
        title=title,
        recording=Recording(samples, RATE, channels, condition),
        segment=Segment("all", 0.0, 1.0, label, shares | {label: 0.6}, frequency, 80.0, -20.0),
        audio=sound.getvalue(),
        full_scale=2.0,
    )


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    entries = [
        entry("creak", 80.0, 2.0 * (80.0 * TIME % 1.0) - 1.0, "Sawtooth " + "a_very_long_name" * 6),
        entry("squeal", 1046.0, np.sin(2.0 * np.pi * 1046.0 * TIME), "</h2><script>alert(1)//"),
        entry("none", None, np.zeros(RATE), "Silence"),
    ]
    write_report(path, entries, title="Review of three recordings")
    return path


class Opened:
    """The page in the browser, with all that it complains of and asks for."""

    def __init__(self, browser, file):
        self.complaints = []
        self.requests = []
        self.page = browser.new_page(viewport={"width": 1280, "height": 800})
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", self.dismiss)
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(file.as_uri())
        self.page.wait_for_function("[...document.images].every((image) => image.complete)")

    def dismiss(self, dialog):
        self.complaints.append(dialog.message)
        dialog.dismiss()


@pytest.fixture(scope="module")
def opened(browser, page_file):
    return Opened(browser, page_file)


@pytest.fixture
def page(opened):
    return opened.page


def play(page, index):
    key = f"s{index + 1}"
    page.evaluate("(key) => engine.start(key, 0)", key)
    page.wait_for_function(
        "(key) => engine.playing && engine.key === key && engine.now() > 0.1", arg=key
    )


def test_every_sound_is_ready_and_has_its_length(page):
    lengths = []
    for index in range(3):
        play(page, index)
        lengths.append(page.evaluate("engine.length()"))
    assert lengths == pytest.approx([1.0, 1.0, 1.0], abs=1e-3)


def test_playing_advances_and_one_sound_stops_the_other(page):
    buttons = page.locator(".card .play")
    play(page, 0)
    assert buttons.nth(0).text_content() == "Pause"
    play(page, 1)
    assert buttons.nth(0).text_content() == "Play"
    assert buttons.nth(1).text_content() == "Pause"
    assert list(page.evaluate("engine.gains()")) == ["a"]


def test_the_page_is_quiet_and_asks_nothing_of_the_network(opened):
    play(opened.page, 0)
    assert opened.complaints == []
    assert opened.requests
    assert {url.partition(":")[0] for url in opened.requests} <= {"file", "data"}


def test_the_page_itself_forbids_other_sources(browser, page_file):
    refuses_other_sources(Opened(browser, page_file).page)


def test_every_picture_is_drawn(page):
    widths = page.evaluate(
        "[...document.querySelectorAll('main img')].map((image) => image.naturalWidth)"
    )
    assert len(widths) == 3 * (6 + 1)  # panels and a spectrogram
    assert min(widths) > 0


def test_the_page_fits_the_width_of_every_screen(page):
    for width in (320, 390, 720, 1024, 1025, 1280, 1920):
        page.set_viewport_size({"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator(".wide").evaluate("(box) => box.scrollWidth <= box.clientWidth"), width
        beyond = page.evaluate(
            "[...document.querySelectorAll('main *')].filter((one) => one.getClientRects().length)"
            ".filter((one) => one.getBoundingClientRect().right > innerWidth + 1).length"
        )
        assert beyond == 0, width


def test_panels_stand_side_by_side_where_there_is_room(page):
    for width, columns in ((390, 1), (1280, 2)):
        page.set_viewport_size({"width": width, "height": 800})
        lefts = page.evaluate(
            "[...document.querySelectorAll('#entry-1 .panels img')]"
            ".map((image) => Math.round(image.getBoundingClientRect().left))"
        )
        assert len(set(lefts)) == columns
