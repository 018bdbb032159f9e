"""The view of a jury in a browser, and what it has put into the table of votes."""

from __future__ import annotations

import re

import numpy as np

from noise.base.tables import read_table
from tests.helpers.browser import new_page


class JuryPage:
    """The view of a jury, as a person with a keyboard uses it."""

    def __init__(self, browser, app, width=1280, *, tapped=False):
        self.complaints, self.asked = [], []
        self.page = new_page(browser, tapped=tapped, viewport={"width": width, "height": 900})
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(f"{app.address}#jury")
        self.begins = self.page.get_by_role("button", name="Begin")
        self.begins.wait_for()

    def begin(self):
        self.page.wait_for_function("() => !document.querySelector('.begin').disabled")
        self.begins.click()
        return self.turn(1)

    def turn(self, place):
        """Wait for a comparison, the first of which is 1, to be there."""
        self.page.wait_for_function(
            """(place) =>
               document.querySelector(".voting .count").textContent.startsWith(`${place} of`)
               && [...document.querySelectorAll(".side")].every((side) => !side.disabled)""",
            arg=place,
        )
        return self

    def hear(self, side):
        """Listen to a side, and return what goes to the loudspeaker after the change."""
        self.page.keyboard.press(side)
        self.page.locator(f".side[aria-pressed=true] >> text={side.upper()}").wait_for()
        return self.heard()

    def heard(self, n=9600):
        """What goes to the loudspeaker from now on."""
        self.page.evaluate("hearAnew()")
        self.page.wait_for_function("(n) => heard.length > n", arg=n)
        return np.array(self.page.evaluate("heard"))

    def listen(self):
        """Press A, then B, and wait until both have been heard."""
        for side in "ab":
            self.page.keyboard.press(side)
            self.page.locator(f".side.heard >> text={side.upper()}").wait_for()

    def vote(self, key):
        self.page.locator(".saved").evaluate("(one) => { one.textContent = ''; }")
        self.listen()
        self.page.keyboard.press(key)
        self.page.locator(".saved").filter(has_text=re.compile("^saved ")).wait_for(
            state="attached"
        )

    def close(self):
        assert self.complaints == []
        self.page.close()


def rows(folder):
    return read_table(folder / "votes.csv")[1]


def votes(folder):
    return [row["vote"] for row in rows(folder) if row["vote"]]


def pairs(folder):
    return [(row["first"], row["second"]) for row in rows(folder)]
