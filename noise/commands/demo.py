"""``bushing-noise demo``: the whole chain, once."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from pathlib import Path

from noise.base.progress import report, say
from noise.commands.options import Option, check_folder, seed

_DEFAULT_OUT = "bushing-noise-demo"


DESCRIPTION = (
    "Run the whole chain: simulate a creak, a squawk, a squeal and a silent run, make them "
    "audible, compute their features, label them, and write a report. The folder then holds "
    "recordings/, audio/, features.csv, labels.csv, report.html, and hits/, blows of a hammer "
    "on the modelled clamp for `bushing-noise frf`. It prints the label and the level of each "
    "recording and where the report is, and opens the report where there is a display."
)

OPTIONS = (
    Option("--out FOLDER", Path, Path(_DEFAULT_OUT)).help("folder for the results"),
    Option("--no-browser").help("do not open the report"),
    seed("seed of the sensors' noise"),
)


def run(options: Namespace) -> int:
    """Run the demonstration."""
    check_folder(options.out)
    say(f"writing the demonstration into {options.out}")
    from noise.demo import run_demo
    from noise.labels.summary import result_lines

    rows = run_demo(options.out, seed=options.seed)
    page = options.out / "report.html"
    report(*result_lines(rows), page)
    if not options.no_browser and has_display():
        import webbrowser

        webbrowser.open(page.absolute().as_uri())
    return 0


def has_display() -> bool:
    """Whether somebody sits before a screen: a terminal, and a display where it needs one."""
    if not (sys.stdout is not None and sys.stdout.isatty()):
        return False
    needs = sys.platform not in ("win32", "darwin")
    return not needs or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
