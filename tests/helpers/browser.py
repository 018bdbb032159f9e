"""A Chromium to open pages with, as it is installed here or wherever the tests run."""

from __future__ import annotations

import os
import shutil
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser

VARIABLE = "BUSHING_NOISE_CHROMIUM"
"""Environment variable that names the browser to use."""

_NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
_FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


def find_chromium() -> str | None:
    """Path of the browser that `VARIABLE` names, else of the first one installed."""
    if named := os.environ.get(VARIABLE):
        return shutil.which(named)
    return next(filter(None, map(shutil.which, _NAMES)), None)


TAP = """
window.heard = [];
const connect = AudioNode.prototype.connect;
AudioNode.prototype.connect = function (target, ...rest) {
  if (target instanceof AudioDestinationNode && !(this instanceof ScriptProcessorNode)) {
    const { context } = this;
    if (!context.tap) {
      context.tap = context.createScriptProcessor(1024, 1, 1);
      context.tap.onaudioprocess = (event) =>
        window.heard.push(...event.inputBuffer.getChannelData(0));
      connect.call(context.tap, target);
    }
    connect.call(this, context.tap);
  }
  return connect.call(this, target, ...rest);
};
"""
"""Script that collects in `heard` what goes to the loudspeaker."""


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start a browser; skip the test where there is none."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = find_chromium()
    if path is None:
        pytest.skip(f"no Chromium found; install one or name it in {VARIABLE}")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(_FLAGS))
        yield browser
        browser.close()


class OpenedPage:
    """The page in the browser, with all that it complains of and asks for."""

    def __init__(self, browser, file, width=1280, before=""):
        self.complaints = []
        self.requests = []
        self.page = browser.new_page(viewport={"width": width, "height": 800})
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        if before:
            self.page.add_init_script(before)
        self.page.goto(file.as_uri())

    def state(self):
        return self.page.evaluate(
            "({ playing: engine.playing, at: engine.now(), active: engine.active, "
            "a: engine.slots.a, b: engine.slots.b, looping: engine.looping, "
            "title: engine.key === null ? null : about[engine.key].title, gains: engine.gains() })"
        )
