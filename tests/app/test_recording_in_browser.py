"""One recording in the app: what is seen, read, heard and corrected in a browser."""

from __future__ import annotations

import re
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.base.tables import write_table
from noise.labels.labelling import COLUMNS
from noise.labels.table import read_label_table
from noise.recordings.writing import write_recording
from tests.helpers.browser import chromium, new_page, until
from tests.helpers.labelled_folder import made_row
from tests.helpers.opened_app import opened_app

RATE = 48000
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
TONE, HALF, ODD = "tone.wav", "half.wav", "<img src=x onerror=alert(1)>.wav"


def write_sounds(folder):
    t = np.arange(2 * RATE) / RATE
    tone = np.sqrt(2.0) * np.sin(2 * np.pi * 1000 * t)
    for name, samples in {TONE: tone, HALF: 0.5 * tone, ODD: 0.1 * tone}.items():
        sound = Recording(samples[None], RATE, (Channel("pressure"),), calibrated=True)
        write_recording(folder / name, sound)
    sure = {"p_creak": 0.02, "p_squawk": 0.03, "p_squeal": 0.9, "p_none": 0.04, "p_unknown": 0.01}
    unsure = {**sure, "p_squeal": 0.4, "p_none": 0.54}
    rows = [
        made_row(TONE, "none", 0.0, 0.5, p_none=0.97),
        made_row(TONE, "squeal", 0.5, 1.5, frequency_hz=1000.0, level_dba=93.98, **sure),
        made_row(TONE, "none", 1.5, 2.0, p_none=0.97),
        made_row(HALF, "squeal", 0.0, 2.0, **unsure),
        made_row(ODD, "unknown", 0.0, 2.0, **sure),
    ]
    write_table(folder / "labels.csv", COLUMNS, rows)
    return folder


class OpenPage:
    """The app in a browser, with one recording open."""

    def __init__(self, browser, app, width=1280, height=900, *, tapped=False):
        self.complaints = []
        viewport = {"width": width, "height": height}
        self.page = new_page(browser, tapped=tapped, viewport=viewport)
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.goto(app.address)

    def open(self, name):
        row = self.page.get_by_role("option").filter(has_text=name).first
        number = row.get_attribute("data-at")  # as they are found
        row.click()
        self.page.get_by_role("heading", name=name).wait_for()
        for lane in ("plot", "course"):
            self.page.locator(f".{lane}[data-drawn='{number}']").wait_for()
        self.page.locator(".strip .segment").first.wait_for()
        self.page.locator(".recording").get_by_text("strongest third octave").wait_for()
        return self

    def at(self, time, share=0.5, lane=".screen"):
        box = self.page.locator(lane).bounding_box()
        return box["x"] + box["width"] * time / 2.0, box["y"] + share * box["height"]

    def holding(self, requests):
        """Hold the first of these requests until what is returned is called."""
        held = []
        self.page.route(
            f"**/{requests}", lambda route: route.fallback() if held else held.append(route)
        )

        def go_on():
            until(self.page, lambda: held)
            held[0].continue_()

        return go_on

    def segments(self):
        return [one.get_attribute("aria-label") for one in self.page.locator(".strip button").all()]

    def press(self, *keys):
        for key in keys:
            self.page.keyboard.press(key)

    def saved(self):
        """Wait until all that was changed is written: while some is not, "saving" is said."""
        self.page.locator(".saved").filter(has_text=re.compile("^saved ")).wait_for()

    def undo(self):
        self.page.locator(".saved").evaluate("(one) => { one.textContent = ''; }")
        self.press("u")
        self.page.locator(".saved").filter(has_text="undone").wait_for()

    def is_playing(self):
        self.page.locator(".play").filter(has_text="Pause").wait_for()

    def more(self, n=24000):
        """What has gone to the loudspeaker, once it is so many samples more."""
        known = self.page.evaluate("heard.length")
        self.page.wait_for_function("(n) => heard.length >= n", arg=known + n)
        return np.array(self.page.evaluate("heard"))

    def heard(self):
        """What goes to the loudspeaker from now on."""
        self.page.evaluate("hearAnew()")
        return self.more()

    def close(self):
        assert self.complaints == []
        self.page.close()


@pytest.fixture(scope="module")
def browser():
    with chromium() as started:
        yield started


@pytest.fixture(scope="module")
def shown(browser, tmp_path_factory):
    with opened_app(write_sounds(tmp_path_factory.mktemp("shown"))) as app:
        yield app


@pytest.fixture
def folder(tmp_path):
    return write_sounds(tmp_path)


@pytest.fixture
def app(browser, folder):
    with opened_app(folder) as running:
        yield running


def in_table(folder, name=TONE):
    rows = read_label_table(folder / "labels.csv")
    return [
        (row["start_s"], row["end_s"], row["label"], row["label_source"])
        for row in rows
        if row["file"] == name
    ]


def test_the_cursor_reads_time_frequency_and_level_of_a_known_tone(browser, shown):
    opened = OpenPage(browser, shown).open(TONE)
    share = np.log(20e3 / 1010.0) / np.log(400.0)
    opened.page.mouse.move(*opened.at(1.0, share))
    readout = opened.page.locator(".readout[data-line-hz]")
    readout.wait_for()
    read = {
        name: float(value)
        for name, value in readout.evaluate("(one) => ({...one.dataset})").items()
    }
    assert read["time"] == pytest.approx(1.0, abs=0.005)
    assert read["frequency"] == pytest.approx(1010.0, rel=0.02)
    assert read["lineHz"] == pytest.approx(1000.0, abs=0.5)
    assert read["lineDb"] == pytest.approx(93.98, abs=0.1)
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
        [np.log(20e3 / 1000.0) / np.log(400.0)],
    )
    assert max(levels[0]) < 60  # dark where the tone is
    assert min(levels[1]) > 240  # white where nothing is
    opened.close()


def test_zoom_by_wheel_keeps_what_is_under_the_pointer(browser, shown):
    opened = OpenPage(browser, shown).open(TONE)
    x, y = opened.at(1.5)
    border = opened.page.locator(".handle").nth(1)
    opened.page.mouse.move(x, y)
    start = 1.5 - 1.5 * np.exp(-0.0015 * 3 * 400)

    def is_of_the_view(request):
        asked = parse_qs(urlsplit(request.url).query)
        return float(asked.get("start", ["nan"])[0]) == pytest.approx(start, abs=0.005)

    with opened.page.expect_request(is_of_the_view):
        for _ in range(3):
            opened.page.mouse.wheel(0, -400)
    assert border.is_visible()
    box = border.bounding_box()
    assert box["x"] + box["width"] / 2 == pytest.approx(x, abs=2)
    opened.press("0")
    opened.page.wait_for_function("() => !document.querySelector('.handle').hidden")
    opened.close()


def test_what_the_classifier_gives_less_than_a_half_is_said(browser, shown):
    opened = OpenPage(browser, shown).open(HALF)
    assert opened.page.get_by_text("less than a half").is_visible()
    assert opened.page.locator(".shares dd .number").all_text_contents()[2:4] == ["0.40", "0.54"]
    opened.open(TONE)
    opened.press("]")
    opened.page.get_by_text("By the classifier.", exact=True).wait_for()
    told = opened.page.locator("div.chosen:not(.segment)").filter(has_text="squeal")
    assert told.text_content() == "squeal 0.50\N{EN DASH}1.50 s, 1000 Hz, 94.0 dB(A)"
    opened.close()


def test_names_are_text(browser, shown):
    opened = OpenPage(browser, shown).open(ODD)
    assert opened.page.get_by_role("heading", name=ODD).is_visible()
    opened.press("b")
    assert f"B is {ODD}" in opened.page.locator(".gains").text_content()
    opened.close()


def test_corrections_by_keys_are_in_the_table_when_the_server_is_killed(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    opened.press("]", "1")
    opened.saved()
    app.kill()
    assert in_table(folder) == [
        (0.0, 0.5, "none", "classifier"),
        (0.5, 1.5, "creak", "human"),
        (1.5, 2.0, "none", "classifier"),
    ]
    opened.press("2")  # it goes back, and says so
    opened.page.locator(".saved").filter(has_text="not saved").wait_for()
    assert opened.segments()[1] == "creak, 0.50 to 1.50 s, by a person"
    opened.page.close()


def test_split_join_undo_and_borders_by_keys_and_pointer(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    before = in_table(folder)
    opened.page.mouse.move(*opened.at(1.0))
    opened.press("s")
    opened.page.locator(".strip button").nth(3).wait_for()
    opened.saved()
    assert len(in_table(folder)) == 4
    assert in_table(folder)[2][0] == pytest.approx(1.0, abs=0.005)
    opened.press("Delete")
    opened.page.wait_for_function("() => document.querySelectorAll('.strip button').length === 3")
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


def test_conditions_of_a_segment_say_what_they_are_from(browser, folder):
    logged = {
        "speed_rad_s": 5.0,
        "speed_rad_s_source": "logged",
        "note": "logged as 5, turned at 7",
    }
    inferred = {
        "interference_mm": 0.2, "interference_mm_low": 0.18, "interference_mm_high": 0.28,
        "interference_mm_source": "inferred",
    }  # fmt: skip
    rows = [made_row(TONE, "squeal", 0.0, 2.0, p_squeal=0.9, **logged, **inferred)]
    write_table(folder / "labels.csv", COLUMNS, rows)
    with opened_app(folder) as app:
        opened = OpenPage(browser, app).open(TONE)
        said = opened.page.locator(".recording .conditions").text_content()
        opened.close()
    assert (
        said == "speed 5 rad/s; interference 0.18 to 0.28 mm (inferred); logged as 5, turned at 7"
    )


def test_what_is_checked_next_is_opened_at_the_segment_in_doubt(browser, app):
    opened = OpenPage(browser, app, height=400)
    for name in (ODD, HALF, TONE):
        opened.page.get_by_role("button", name="Next to check").first.click()
        opened.page.get_by_role("heading", name=name).wait_for()
    chosen = opened.page.locator(".strip [aria-pressed=true]").filter(has_text="squeal")
    chosen.wait_for()
    assert chosen.get_attribute("aria-label").startswith("squeal, 0.50 to 1.50 s")
    assert opened.page.locator(".clock").text_content() == "0.50 s"
    box = chosen.bounding_box()
    assert 0.0 <= box["y"] <= 400 - box["height"]
    opened.close()


def test_a_label_that_is_given_before_the_segments_have_come_changes_nothing(browser, app, folder):
    opened = OpenPage(browser, app)
    before = in_table(folder)
    go_on = opened.holding("segments")
    opened.page.get_by_role("option").filter(has_text=TONE).first.click()
    opened.page.get_by_role("heading", name=TONE).wait_for()
    opened.press("1")
    opened.page.locator(".saved").filter(has_text="still being read").wait_for()
    go_on()
    opened.page.locator(".strip button").nth(2).wait_for()
    assert in_table(folder) == before
    opened.press("1")
    opened.saved()
    assert [row[2] for row in in_table(folder)] == ["creak", "squeal", "none"]
    opened.close()


def test_a_label_that_is_given_while_it_is_opened_again_changes_nothing(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    before = in_table(folder)
    go_on = opened.holding("segments")
    opened.page.get_by_role("option").filter(has_text=TONE).first.click()
    opened.page.locator(".strip button").first.wait_for(state="detached")
    opened.press("1")
    opened.page.locator(".saved").filter(has_text="still being read").wait_for()
    go_on()
    opened.page.locator(".strip button").nth(2).wait_for()
    assert in_table(folder) == before
    opened.close()


def test_changes_that_wait_are_written_although_another_recording_is_opened(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("segments")
    opened.press("1", "]", "2")  # the second waits for the first
    opened.page.get_by_role("option").filter(has_text=HALF).first.click()
    opened.page.get_by_role("heading", name=HALF).wait_for()
    go_on()
    opened.page.locator(".strip button").first.wait_for()
    until(opened.page, lambda: [row[2] for row in in_table(folder)] == ["creak", "squawk", "none"])
    assert opened.segments() == ["squeal, 0.00 to 2.00 s"]
    opened.close()


def test_third_octaves_of_one_recording_are_not_shown_beside_another(browser, shown):
    opened = OpenPage(browser, shown).open(HALF)
    go_on = opened.holding("bands*")
    opened.page.get_by_role("option").filter(has_text=TONE).first.click()
    opened.page.get_by_role("heading", name=TONE).wait_for()
    octaves = opened.page.locator(".recording").get_by_text("strongest third octave")
    assert octaves.count() == 0
    go_on()
    octaves.wait_for()
    opened.close()


def test_what_is_not_calibrated_is_not_said_to_be_as_in_the_file_at_equal_loudness(
    browser, tmp_path
):
    tone = 0.1 * np.sin(2 * np.pi * 1000 * np.arange(2 * RATE) / RATE)
    plain = Recording(tone[None], RATE, (Channel("pressure"),), calibrated=False)
    write_recording(tmp_path / TONE, plain)
    write_table(tmp_path / "labels.csv", COLUMNS, [made_row(TONE, "none", 0.0, 2.0, p_none=0.97)])
    with opened_app(tmp_path) as app:
        opened = OpenPage(browser, app).open(TONE)
        gains = opened.page.locator(".gains")
        assert gains.text_content() == "not calibrated: played as it is in the file"
        for name in ("Equal loudness", "Play"):
            opened.page.get_by_role("button", name=name, exact=True).click()
        gains.filter(has_text="Equal loudness, -23 LUFS").wait_for()
        assert "played as it is" not in gains.text_content()
        opened.close()


def tone_of(samples):
    """Amplitude and phase of 1 kHz in each hundredth of a second, by sample number."""
    turned = samples * np.exp(-2j * np.pi * 1000 * np.arange(samples.size) / RATE)
    return 2.0 * turned[: samples.size // 480 * 480].reshape(-1, 480).mean(axis=1)


def test_a_and_b_run_in_step_at_one_gain_and_at_equal_loudness(browser, shown):
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
    opened.press("e")
    opened.page.locator(".gains").filter(has_text="Equal loudness, -23 LUFS").wait_for()
    one = opened.heard()
    opened.press("x")
    other = opened.heard()
    amplitudes = [np.median(np.abs(tone_of(of))) for of in (one, other)]
    assert amplitudes[0] == pytest.approx(amplitudes[1], rel=0.01)
    opened.page.get_by_role("button", name="Loop").click()  # off: it comes to its end
    opened.page.locator(".play").filter(has_text="Play").wait_for()
    opened.close()


def test_a_band_is_heard_and_nothing_beside_it(browser, shown):
    opened = OpenPage(browser, shown, tapped=True).open(TONE)
    opened.page.get_by_label("Hear from [Hz]").fill("2000")
    opened.page.get_by_label("Hear up to [Hz]").fill("4000")
    opened.press("Tab")
    opened.page.evaluate("document.activeElement.blur()")
    opened.press("]", " ")
    opened.is_playing()
    filtered = np.abs(opened.heard()[12000:]).max()  # once the filters have settled
    opened.press(" ")
    assert filtered == pytest.approx(np.sqrt(2.0) / 2.0 / 2.0**4, rel=0.2)  # 24 dB an octave
    assert "heard from 2000 to 4000 Hz" in opened.page.locator(".gains").text_content()
    opened.close()


@pytest.mark.parametrize("width", [390, 1280])
def test_an_accessibility_checker_finds_nothing_and_nothing_is_wider(browser, shown, width):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not there")
    opened = OpenPage(browser, shown, width).open(TONE)
    for key in ("h", "?"):
        opened.press(key)
        tags = {"runOnly": {"type": "tag", "values": RULES}}
        found = axe.Axe().run(opened.page, options=tags).response
        wrong = [(one["id"], one["nodes"][0]["html"][:150]) for one in found["violations"]]
        assert wrong == []
    assert opened.page.evaluate("document.documentElement.scrollWidth") <= width
    opened.close()


def test_what_another_page_has_changed_is_shown_and_not_overwritten(browser, app, folder):
    one, other = (OpenPage(browser, app).open(TONE) for _ in range(2))
    one.press("]", "1")
    one.saved()
    other.press("[", "2")
    other.page.locator(".saved").filter(has_text="not saved").wait_for()
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


def test_labels_that_are_made_anew_are_shown_in_the_recording_that_is_open(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    rows = read_label_table(folder / "labels.csv")
    write_table(folder / "labels.csv", COLUMNS, [row | {"label": "unknown"} for row in rows])
    opened.page.locator(".saved").filter(has_text="changed elsewhere").wait_for()
    assert [label.split(",")[0] for label in opened.segments()] == ["unknown"] * 3
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


def test_a_segment_that_is_split_is_chosen_when_that_is_undone(browser, app):
    opened = OpenPage(browser, app).open(TONE)
    opened.page.mouse.move(*opened.at(1.0))
    opened.press("s")
    chosen = opened.page.locator(".strip [aria-pressed=true]")
    chosen.and_(opened.page.locator("[aria-label*='to 1.50']")).wait_for()
    opened.saved()
    opened.undo()
    assert chosen.get_attribute("aria-label") == "squeal, 0.50 to 1.50 s"
    opened.close()


def test_a_label_that_is_given_while_a_border_is_dragged_counts(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    opened.press("]")
    opened.page.mouse.move(*opened.at(1.5))
    opened.page.mouse.down()
    opened.page.mouse.move(*opened.at(1.6), steps=3)
    opened.press("1")
    opened.page.mouse.move(*opened.at(1.7), steps=3)
    opened.page.mouse.up()
    border = "() => document.querySelectorAll('.handle')[1].getAttribute('aria-valuenow') > 1.65"
    opened.page.wait_for_function(border)
    opened.saved()
    assert in_table(folder)[1][2:] == ("creak", "human")
    assert in_table(folder)[1][1] == pytest.approx(1.7, abs=0.01)
    opened.close()


def test_a_key_while_another_recording_is_opened_labels_neither(browser, app, folder):
    opened = OpenPage(browser, app).open(TONE)
    before = [in_table(folder, name) for name in (TONE, HALF)]
    go_on = opened.holding("sounds/*")
    opened.page.get_by_role("option").filter(has_text=HALF).first.click()
    opened.press("1")
    opened.page.locator(".saved").filter(has_text="still being opened").wait_for()
    go_on()
    opened.page.get_by_role("heading", name=HALF).wait_for()
    opened.page.locator(".strip button").first.wait_for()
    assert [in_table(folder, name) for name in (TONE, HALF)] == before
    opened.close()


def test_a_save_says_of_which_recording_it_is_and_leaves_the_mark_on_the_open_one(browser, app):
    opened = OpenPage(browser, app).open(TONE)
    go_on = opened.holding("segments")
    opened.press("1")
    opened.page.get_by_role("option").filter(has_text=HALF).first.click()
    opened.page.get_by_role("heading", name=HALF).wait_for()
    go_on()
    opened.page.locator(".saved").filter(has_text=re.compile(f"^{TONE}: saved ")).wait_for()
    corrected = opened.page.get_by_role("option").filter(has_text="corrected")
    corrected.wait_for()
    assert TONE in corrected.inner_text()
    assert HALF in opened.page.locator("[role=option][aria-selected=true]").inner_text()
    opened.close()


@pytest.mark.parametrize("sort", ["as found", "least sure first"])
def test_the_arrow_goes_on_to_the_next_after_a_corrected_recording(browser, app, sort):
    opened = OpenPage(browser, app)
    opened.page.get_by_role("combobox", name="Order").select_option(label=sort)
    opened.page.get_by_role("button", name="squeal").first.click()
    rows = opened.page.get_by_role("option").filter(has_text=".wav")
    opened.page.wait_for_function(
        "() => document.querySelectorAll('[role=option]:not([hidden])').length === 2"
    )
    first, second = (one.split("\n")[0] for one in rows.all_inner_texts())
    rows.filter(has_text=first).click()
    opened.page.get_by_role("heading", name=first).wait_for()
    opened.page.locator(".strip .segment").first.wait_for()
    if first == TONE:
        opened.press("]")
    opened.press("4")
    opened.saved()
    opened.page.wait_for_function(
        "() => document.querySelectorAll('[role=option]:not([hidden])').length === 1"
    )
    opened.page.get_by_role("listbox").focus()
    opened.press("ArrowDown", "Enter")
    opened.page.get_by_role("heading", name=second).wait_for()
    opened.close()


def test_a_double_click_on_next_to_check_opens_one(browser, app):
    opened = OpenPage(browser, app)
    asked = []
    opened.page.on("request", lambda request: asked.append(request.url))
    opened.page.get_by_role("button", name="Next to check").first.dblclick()
    opened.page.get_by_role("heading", name=ODD).wait_for()
    assert sum("/next" in url for url in asked) == 1
    opened.close()
