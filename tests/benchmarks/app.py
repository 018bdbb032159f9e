# ruff: noqa: T201
"""How soon the app shows a list of 5,000 recordings and the spectrogram of a minute.

Run by hand: ``python -m tests.benchmarks.app [REPEATS]``. Processor seconds of server and
browser stand beside the clock's, since the machine may have other work; each is told for every
repeat (default 3).
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from models.recording import Channel, Recording
from noise.recordings import write_recording
from tests.app.test_list_in_browser import MOUNT, written
from tests.helpers.browser import chromium
from tests.helpers.opened_app import opened_app

RATE = 48_000
FIRST_ROWS = f"""async () => {{
  const start = performance.now();
  await ({MOUNT})();
  while (!document.querySelector("[role=option] b")?.textContent.endsWith(".wav"))
    await new Promise(requestAnimationFrame);
  return (performance.now() - start) / 1000;
}}"""
SCROLL = """() => new Promise((done) => {
  const rows = document.querySelector(".rows"), times = [];
  const step = (now) => {
    times.push(now);
    rows.scrollTop += 137;
    times.length < 300 ? requestAnimationFrame(step) : done(times);
  };
  requestAnimationFrame(step);
})"""


def processor_seconds(pid):
    """Of a process and all below it, where /proc tells [s]."""
    parents, used = {}, {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        one = int(stat.parent.name)
        parents[one], used[one] = int(fields[1]), 0.01 * (int(fields[11]) + int(fields[12]))
    below = {pid}
    while more := {one for one, above in parents.items() if above in below} - below:
        below |= more
    return sum(used.get(one, 0.0) for one in below)


def timed(server, ours, act):
    """Return what `act` returns, seconds of the clock, and processor seconds of both."""
    at, served, browsed = time.perf_counter(), processor_seconds(server), processor_seconds(ours)
    found = act()
    clock = time.perf_counter() - at
    both = processor_seconds(server) - served, processor_seconds(ours) - browsed
    return found, clock, *both


def the_list(browser, folder, repeats):
    """Tell when the first rows are there, and how it scrolls."""
    with opened_app(written(folder, 5000)) as app:
        for _ in range(repeats):
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.goto(app.address)
            server = app.process.pid
            first, _, served, whole = timed(
                server, os.getpid(), lambda page=page: page.evaluate(FIRST_ROWS)
            )
            print(
                f"first rows of 5,000 after {first:.2f} s (processor: server {served:.2f} s, "
                f"browser {whole - served:.2f} s)"
            )
            times, clock, served, whole = timed(
                server, os.getpid(), lambda page=page: page.evaluate(SCROLL)
            )
            steps = np.diff(times)
            print(
                f"scrolling: {1000.0 * steps.size / steps.sum():.0f} frames a second, median frame "
                f"{np.median(steps):.1f} ms (processor in {clock:.1f} s: server {served:.2f} s, "
                f"browser {whole - served:.2f} s)"
            )
            page.close()


def a_minute(browser, folder, repeats):
    """Tell when the spectrogram of a recording of a minute is on the screen."""
    rng = np.random.default_rng(0)
    names = [f"minute {number}.wav" for number in range(repeats + 1)]
    for name in names:
        sound = 0.1 * rng.standard_normal((1, 60 * RATE))
        write_recording(folder / name, Recording(sound, RATE, (Channel("pressure"),)))
    with opened_app(folder) as app:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(app.address)

        def seen(name):
            page.get_by_role("option").filter(has_text=name).first.click()
            page.get_by_role("heading", name=name).wait_for()
            page.locator(".plot[data-drawn]").wait_for()

        seen(names[0])  # what is compiled at first use is compiled here
        for name in names[1:]:
            _, clock, served, whole = timed(
                app.process.pid, os.getpid(), lambda name=name: seen(name)
            )
            print(
                f"spectrogram of 60 s on the screen {clock:.2f} s after the click (processor: "
                f"server {served:.2f} s, browser {whole - served:.2f} s)"
            )


if __name__ == "__main__":
    n_repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    with tempfile.TemporaryDirectory() as made, chromium() as started:
        the_list(started, Path(made) / "list", n_repeats)
        (Path(made) / "minute").mkdir()
        a_minute(started, Path(made) / "minute", n_repeats)
