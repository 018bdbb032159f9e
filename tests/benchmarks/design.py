# ruff: noqa: T201
"""How soon a slider of the design view is heard, and what is missing of its sound.

Run by hand: ``python -m tests.benchmarks.design [SECONDS]`` (default 60). Each slider that is heard
at once is moved ten times a second, the speed's and the interference's in turn. Processor seconds
of server and browser stand beside the clock's, since the machine may have other work.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.app.design.test_design_in_browser import DesignPage
from tests.benchmarks.app import timed
from tests.helpers.browser import chromium
from tests.helpers.opened_app import opened_app

STEP = 0.1
"""From one movement to the next [s]."""


def sliding(opened, seconds):
    """Move sliders as long."""
    started = time.perf_counter()
    for i in range(round(seconds / STEP)):
        key, value = [("speed", 300 + 4 * (i % 150)), ("interference", 300 + 2 * (i % 150))][i % 2]
        opened.slide(key, value)
        time.sleep(max(0.0, started + (i + 1) * STEP - time.perf_counter()))
    opened.until("document.querySelector('#view-design').design.sound.waiting.length === 0")


if __name__ == "__main__":
    n_seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    with tempfile.TemporaryDirectory() as made, chromium() as started_browser:
        rig = Path(made) / "mine.toml"
        rig.write_text('base = "fluorocarbon"\n', encoding="utf-8")
        with opened_app(rig) as app:
            shown = DesignPage(started_browser, app)
            shown.play()
            missed = shown.sound("missing")
            _, clock, served, whole = timed(
                app.process.pid, os.getpid(), lambda: sliding(shown, n_seconds)
            )
            latencies = np.array(shown.sound("latencies"))
            costs = np.array(shown.sound("costs"))
            median, high = np.median(latencies), np.percentile(latencies, 95)
            print(
                f"{latencies.size} changes in {clock:.0f} s: heard after {median:.0f} ms (median; "
                f"95 %: {high:.0f} ms), {shown.sound('missing') - missed} samples missing, "
                f"{shown.sound('doubled')} doubled; a block costs {np.median(costs):.1f} ms "
                f"(processor: server {served:.0f} s, browser {whole - served:.0f} s)"
            )
