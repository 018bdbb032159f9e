"""A Chromium to open pages with, as it is installed here or wherever the tests run."""

from __future__ import annotations

import os
import shutil
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
import pytest

from tests.helpers.opened_app import PATIENCE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from playwright.sync_api import Browser, Page

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


_TAP = """(() => {
  window.heard = [];
  const taps = [];
  window.hearAnew = () => {
    heard.length = 0;
    const crossed = 0.05; // until all gains have
    for (const tap of taps) tap.since = tap.context.currentTime + crossed;
  };
  const keeper = "data:text/javascript," + encodeURIComponent(`
    registerProcessor("keeper", class extends AudioWorkletProcessor {
      process([[samples = new Float32Array(128)]]) { // where nothing plays, silence
        this.port.postMessage({ time: currentTime, samples: samples.slice() });
        return true;
      }
    });`);
  const connect = AudioNode.prototype.connect;
  AudioNode.prototype.connect = function (target, ...rest) {
    if (!(target instanceof AudioDestinationNode)) return connect.call(this, target, ...rest);
    const { context } = this;
    if (!context.tap) {
      const tap = (context.tap = Object.assign(context.createGain(), { since: 0 }));
      taps.push(tap);
      connect.call(tap, target);
      context.audioWorklet.addModule(keeper).then(() => {
        const one = { numberOfOutputs: 0, channelCount: 1, channelCountMode: "explicit" };
        const node = new AudioWorkletNode(context, "keeper", one);
        node.port.onmessage = ({ data: { time, samples } }) => {
          if (time >= tap.since) heard.push(...samples);
        };
        connect.call(tap, node);
      });
    }
    return connect.call(this, context.tap, ...rest);
  };
})();"""
# In the audio thread, so that there is no gap however busy the page is.


def new_page(browser: Browser, *, tapped: bool = False, **options) -> Page:
    """Open an empty page.

    Where it is tapped, what goes to the loudspeaker is in its `heard`, and after `hearAnew()` only
    what is rendered from then on; its policy, which forbids that, does not hold.
    """
    page = browser.new_page(bypass_csp=tapped, **options)
    if tapped:
        page.add_init_script(_TAP)
    return page


def until(page: Page, is_true: Callable[[], object]) -> None:
    """Wait for what this process, not the page, gets to know."""
    end = time.monotonic() + PATIENCE
    while not is_true():
        assert time.monotonic() < end
        page.wait_for_timeout(20)


def styled(page: Page) -> None:
    """Wait for all style sheets of the page."""
    page.wait_for_function(
        "() => [...document.querySelectorAll('link[rel=stylesheet]')].every((one) => one.sheet)"
    )


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


RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]


def accessibility_errors(page: Page) -> list[tuple[str, str]]:
    """Rules of axe-core that the page breaks, each with the beginning of an element."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not there")
    found = axe.Axe().run(page, options={"runOnly": {"type": "tag", "values": RULES}}).response
    return [(one["id"], one["nodes"][0]["html"][:150]) for one in found["violations"]]


class WatchedPage:
    """A page in the browser, with all that it complains of and asks for."""

    def __init__(self, browser, address, width=1280, height=900, *, tapped=False):
        self.complaints, self.requests = [], []
        viewport = {"width": width, "height": height}
        self.page = new_page(browser, tapped=tapped, viewport=viewport)
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(address)

    def more(self, n=24000):
        """What has gone to the loudspeaker, once it is so many samples more."""
        known = self.page.evaluate("heard.length")
        self.page.wait_for_function("(n) => heard.length >= n", arg=known + n)
        return np.array(self.page.evaluate("heard"))

    def heard(self, n=24000):
        """What goes to the loudspeaker from now on."""
        self.page.evaluate("hearAnew()")
        return self.more(n)

    def close(self):
        assert self.complaints == []
        self.page.close()


class OpenedPage(WatchedPage):
    """A page that is a file."""

    def __init__(self, browser, file, width=1280, *, tapped=False):
        super().__init__(browser, file.as_uri(), width, 800, tapped=tapped)

    def state(self):
        return self.page.evaluate(
            "({ playing: engine.playing, at: engine.now(), "
            "title: engine.key === null ? null : about[engine.key].title })"
        )
