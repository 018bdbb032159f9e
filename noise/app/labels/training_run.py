"""Learning from corrections, as ``bushing-noise train --add`` does; then all else is labelled anew.

What was learned stands beside the table, and labels whatever is opened there later.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from noise.app.labels.commands import Command
from noise.base.tables import write_table
from noise.classifier import load_classifier
from noise.labels.labelling import COLUMNS
from noise.labels.table import HUMAN

if TYPE_CHECKING:
    from noise.app.labels.labelling_run import LabellingRun
    from noise.app.labels.store import Labels
    from noise.app.opened import Opened

__all__ = ["TrainingRun", "own_classifier"]


def own_classifier(table: Path) -> Path:
    """Where what was learned from a table's corrections stands.

    Examples
    --------
    >>> own_classifier(Path("runs") / "labels.csv").name
    'labels.classifier.npz'
    """
    return table.with_name(f"{table.stem}.classifier.npz")


class TrainingRun:
    """``bushing-noise train --add`` on what a person has said.

    Parameters
    ----------
    labels : Labels
    labelling : LabellingRun
        Which labels all else afterwards.
    opened : Opened
    """

    def __init__(self, labels: Labels, labelling: LabellingRun, opened: Opened) -> None:
        self._labels = labels
        self._labelling = labelling
        self._opened = opened
        self._corrections: tempfile.TemporaryDirectory[str] | None = None
        self._command = Command(self._ended)
        self._learned = own_classifier(labels.path)

    def start(self) -> None:
        """Begin; nothing happens where it runs.

        Raises
        ------
        ParameterError
            Nothing is corrected yet.
        """
        if self._command.running:
            return
        rows = [
            row | {"file": str(job.path.absolute())}
            for job in self._opened.jobs
            for row in self._labels.rows(job.index)
            if row.get("label_source") == HUMAN
        ]
        if not rows:
            raise ParameterError("nothing is corrected yet, so there is nothing to learn from")
        self._corrections = tempfile.TemporaryDirectory(prefix="bushing-noise-")
        table = Path(self._corrections.name) / "corrections.csv"
        write_table(table, COLUMNS, rows)
        samples = self._opened.samples
        number = [] if samples is None else ["--samples", str(samples)]
        keep = _cache() / f"samples{'' if samples is None else f'-{samples}'}.npz"
        files = ["--add", str(table), "--out", str(self._learned), "--keep", str(keep)]
        self._command.start(["train", *files, *number])

    def stop(self) -> None:
        """End it; nothing comes of it."""
        self._command.stop()

    def state(self) -> dict[str, object]:
        """Return how far it is, and how well it does on what was left out."""
        shown = self._labels.summaries()
        done, of = self._command.progress
        return {
            "running": self._command.running,
            "done": done,
            "of": of,
            "corrected": sum(bool(one["corrected"]) for one in shown),
            "message": self._message(),
            "scores": self._scores(),
        }

    def _message(self) -> str:
        if self._command.running:
            return self._command.message
        if self._command.code in (None, 0, 1):
            return "" if self._command.code is None else "Learned; the others are labelled anew."
        return f"Nothing was learned: {self._command.message}"

    def _scores(self) -> dict[str, object] | None:
        """Return what the card of the last classifier says of the corrected files."""
        if self._command.running or not self._learned.is_file():
            return None
        try:
            own = load_classifier(self._learned).card.get("own")
        except BushingNoiseError:
            return None
        if not isinstance(own, dict):
            return None
        labels = [{"label": label, **found} for label, found in own["labels"].items()]
        return {"files": own["files"], "labels": labels}

    def _ended(self, code: int) -> None:
        if self._corrections is not None:
            self._corrections.cleanup()
        if code in (0, 1):  # 1: some of what was corrected could not be learned from
            self._labelling.stop()
            self._labelling.start(self._learned)


def _cache() -> Path:
    """Return the folder in which programs of this user keep what they can make again."""
    home = Path.home()
    if sys.platform == "win32":
        above = Path(os.environ.get("LOCALAPPDATA", home / "AppData" / "Local"))
    elif sys.platform == "darwin":
        above = home / "Library" / "Caches"
    else:
        above = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return above / "bushing-noise"
