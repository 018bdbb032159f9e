"""Labelling of what is open, as on the command line: killed, it goes on where it ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.app.labels.commands import Command
from noise.labels.labelling import Labelling

if TYPE_CHECKING:
    from pathlib import Path

    from noise.app.labels.store import Labels
    from noise.app.opened import Opened

__all__ = ["LabellingRun"]


class LabellingRun:
    """``bushing-noise label`` on all recordings.

    Parameters
    ----------
    labels : Labels
        Where what it does arrives.
    opened : Opened
    classifier : Path, optional
        That labels; by default the one that is shipped.
    """

    def __init__(self, labels: Labels, opened: Opened, classifier: Path | None) -> None:
        self._labels = labels
        self._opened = opened
        self._classifier = classifier
        self._command = Command(lambda _: labels.ended())

    def start(self, classifier: Path | None = None) -> None:
        """Begin, or go on, from now on with another classifier; nothing happens where it runs."""
        if self._command.running:
            return
        self._classifier = classifier or self._classifier
        self._labels.follow(Labelling(self._classifier))
        chosen = [] if self._classifier is None else ["--classifier", str(self._classifier)]
        paths = [str(path.absolute()) for path in self._opened.sources]
        self._command.start(["label", "--out", str(self._labels.path), *chosen, "--", *paths])

    def stop(self) -> None:
        """End it; what is done is kept."""
        self._command.stop()

    def state(self, done: int) -> dict[str, object]:
        """Return how far it is, of which `done` recordings have labels [-]."""
        code = self._command.code
        failed = code not in (None, 0, 1) and not self._command.running
        return {
            "done": done,
            "total": len(self._opened.jobs),
            "running": self._command.running,
            "classifier": None if self._classifier is None else self._classifier.name,
            "message": self._command.message if failed else "",
        }
