"""The design view of the app in a browser."""

from __future__ import annotations

import time

import numpy as np

from tests.helpers.browser import new_page, styled
from tests.helpers.opened_app import PATIENCE

DESIGN = "document.querySelector('#view-design').design"
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

    def heard(self, n, pieces):
        """Pieces of what the loudspeaker got, from shortly after the first that is not 0."""
        first = f"window.heard.findIndex((one) => one !== 0) + {SLACK}"
        self.until(f"window.heard.length > {first} + {n * pieces}")
        found = np.array(self.page.evaluate(f"window.heard.slice({first}, {first} + {n * pieces})"))
        return found.reshape(pieces, n)

    def close(self):
        assert self.complaints == []
        self.page.close()
