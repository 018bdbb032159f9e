"""The log of the sealed set: each opening is a line, and what it gave another.

The line is written before anything sealed is made, so that a run which breaks off has been seen.
"""

from __future__ import annotations

import json
import subprocess
from datetime import UTC, datetime
from pathlib import Path

__all__ = ["LOG", "commit", "log_figures", "log_opening"]

LOG = Path(__file__).parents[1] / "sealed_log.jsonl"


def commit(folder: Path = LOG.parent) -> tuple[str, bool | None]:
    """Return the commit that a folder is at, and whether something is changed since."""
    said = []
    for call in (["rev-parse", "HEAD"], ["status", "--porcelain"]):
        try:
            done = subprocess.run(
                ["git", "-C", str(folder), *call], capture_output=True, text=True, check=True
            )
        except (OSError, subprocess.CalledProcessError):
            return "unknown", None
        said.append(done.stdout.strip())
    return said[0], bool(said[1])


def _append(log: Path, entry: dict) -> None:
    with log.open("a", encoding="utf-8") as file:
        file.write(json.dumps(entry) + "\n")


def log_opening(log: Path, **about: object) -> str:
    """Write that the sealed set is opened, by what and for what; return the time as its name."""
    at = datetime.now(UTC).isoformat(timespec="microseconds")
    name, dirty = commit()
    _append(log, {"opened": at, "commit": name, "dirty": dirty, **about})
    return at


def log_figures(log: Path, opened: str, figures: dict) -> None:
    """Write what an opening gave, in all and by kind of bench."""
    in_all = {name: f for name, f in figures.items() if name != "by bench"}
    benches = {bench: _short(of) for bench, of in figures.get("by bench", {}).items()}
    _append(log, {"figures_of": opened, "figures": _short(in_all), "by_bench": benches})


def _short(figures: dict) -> dict[str, list]:
    return {
        name: [f["cases"], f["value"], f["low"], f["high"], *([f["bench"]] if "bench" in f else [])]
        for name, f in figures.items()
        if f["value"] is not None
    }
