"""The page of one recording of the app in a browser, with three tones to open."""

from __future__ import annotations

import re

import numpy as np

from models.recording import Channel, Recording
from noise.base.tables import write_table
from noise.labels.table import COLUMNS, read_label_table
from noise.recordings.wav import write_recording
from tests.helpers.browser import WatchedPage, until
from tests.helpers.labelled_folder import made_row

RATE = 48000
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


class OpenPage(WatchedPage):
    """The app in a browser, with one recording open."""

    def __init__(self, browser, app, *, tapped=False):
        super().__init__(browser, app.address, tapped=tapped)

    def open(self, name):
        row = self.page.get_by_role("option").filter(has_text=name).first
        number = row.get_attribute("data-at")  # as they are found
        row.click()
        self.page.get_by_role("heading", name=name).wait_for()
        self.page.locator(f".plot[data-drawn='{number}']").wait_for()
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


def in_table(folder, name=TONE):
    rows = read_label_table(folder / "labels.csv")
    return [
        (row["start_s"], row["end_s"], row["label"], row["label_source"])
        for row in rows
        if row["file"] == name
    ]
