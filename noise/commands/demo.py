"""``bushing-noise demo``: run the whole chain on four simulated conditions."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from pathlib import Path

from noise.base.progress import report, say
from noise.commands.options import Option, check_folder

_DEFAULT_OUT = "bushing-noise-demo"


OPTIONS = (Option("--out FOLDER", Path, Path(_DEFAULT_OUT)), Option("--no-browser"))


def run(options: Namespace) -> int:
    """Run the demonstration and open its report."""
    check_folder(options.out)
    say(f"writing the demonstration into {options.out}")
    from noise.demo import run_demo
    from noise.labels.summary import result_lines

    rows = run_demo(options.out, seed=options.seed)
    page = options.out / "report.html"
    report(*result_lines(rows), page)
    say(f"to listen and to correct labels: bushing-noise open {options.out}")
    if not options.no_browser and has_display():
        import webbrowser

        webbrowser.open(page.absolute().as_uri())
    return 0


def has_display() -> bool:
    """Whether the program runs on a terminal with a display."""
    if not (sys.stdout is not None and sys.stdout.isatty()):
        return False
    needs = sys.platform not in ("win32", "darwin")
    return not needs or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
