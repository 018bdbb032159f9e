"""Designs kept as sounds: recordings, WAVs to listen to, a page to send, by our own commands."""

from __future__ import annotations

from threading import Lock
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.app.design.design import design_of
from noise.app.design.player import RATE
from noise.app.design.rig_saving import name_of
from noise.app.labels.commands import Command
from noise.base.atomic import atomic

if TYPE_CHECKING:
    from pathlib import Path

    from noise.app.design.bases import Base

__all__ = ["DesignExport"]

_SLOTS = ("A", "B")
_LONGEST = 60.0
"""Of each sound [s]."""


class DesignExport:
    """One set at a time, command by command.

    Parameters
    ----------
    bases : dict of str to Base
        That designs name.
    folder : Path
        Where sets go, each into a folder of its own.
    """

    def __init__(self, bases: dict[str, Base], folder: Path) -> None:
        self._bases, self._folder = bases, folder
        self._lock = Lock()
        self._steps: list[list[str]] = []
        self._done = self._total = 0
        self._command: Command | None = None
        self._stopped = False
        self._error = ""
        self._result: Path | None = None

    def start(self, said: object) -> dict[str, object]:
        """Begin to keep designs, and tell the state.

        Parameters
        ----------
        said : object
            ``{"name": ..., "designs": {"A": ..., "B": ...}, "seconds": 4, "page": false}``, with
            ``"replace": true`` where a set of that name may be written over.

        Raises
        ------
        ParameterError
            Something of it cannot be, or a set is being kept.
        """
        name = name_of(said)
        if not isinstance(said, dict):
            raise ParameterError("set: must be an object with name and designs")
        stated, seconds = said.get("designs"), said.get("seconds", 4.0)
        if not isinstance(stated, dict) or not stated or not set(stated) <= set(_SLOTS):
            raise ParameterError("set: designs must be A, B or both")
        if isinstance(seconds, bool) or not isinstance(seconds, int | float):
            raise ParameterError("set: seconds must be a number")
        if not 0.5 <= seconds <= _LONGEST:
            raise ParameterError(f"set: seconds must be from 0.5 to {_LONGEST:g}")
        designs = {slot: design_of(stated[slot], self._bases) for slot in sorted(stated)}
        target, page = self._folder / name, self._folder / f"{name}.html"
        wanted = page if said.get("page") is True else target
        for one in (target, wanted):
            if one.exists() and said.get("replace") is not True:
                raise ParameterError(
                    f"{one.name} is there already; take another name, or save again over it"
                )
        with self._lock:
            if self._steps or (self._command is not None and self._command.running):
                raise ParameterError("set: another one is being kept; wait until it is done")
            steps = []
            for slot, design in designs.items():
                rig = target / f"{slot}.toml"
                with atomic(rig) as part:
                    part.write_text(design.text(target, rig.name), encoding="utf-8")
                options = design.options.split()
                if "--seconds" not in options:
                    options += ["--seconds", f"{seconds:g}"]
                recording = target / "recordings" / slot
                steps.append(
                    ["simulate", "--rig", str(rig), *options, "--rate", str(RATE),
                     "--out", str(recording)]
                )  # fmt: skip
            recordings = str(target / "recordings")
            if wanted == page:
                told = "; ".join(f"{slot}: {design.words}" for slot, design in designs.items())
                steps.append(
                    ["review", recordings, "--title", f"{name}. {told}", "--out", str(page)]
                )
            else:
                steps.append(["render", recordings, "--out", str(target / "sounds")])
            self._steps, self._total, self._done = steps, len(steps), 0
            self._error, self._result = "", wanted
            self._next()
        return self.state()

    def state(self) -> dict[str, object]:
        """Return what is done of how much [-], what went wrong, and where the result is."""
        with self._lock:
            running = bool(self._steps)
            done = not running and self._total > 0 and not self._error
            return {
                "running": running,
                "done": self._done,
                "total": self._total,
                "error": self._error,
                "result": str(self._result) if done and self._result else None,
            }

    def stop(self) -> None:
        """End what is being done."""
        with self._lock:
            self._stopped, command = True, self._command
        if command is not None:
            command.stop()

    def _next(self) -> None:
        command = Command(lambda code: self._ended(command, code))
        self._command = command
        command.start(self._steps[0])

    def _ended(self, command: Command, code: int) -> None:
        with self._lock:
            self._done += 1
            if code != 0 or self._stopped:
                self._error = command.message or "it was ended"
                self._steps = []
                return
            self._steps = self._steps[1:]
            if self._steps:
                self._next()
