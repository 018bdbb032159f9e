"""A command of the program that runs beside the server, which stays quick meanwhile."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from threading import Thread

from noise.base.progress import LINES

_NICE = 10
"""Whoever listens goes first."""

_PATIENCE = 10.0
"""A command that is told to end writes what it has, which takes no longer [s]."""

_OF = re.compile(r".*: (\d+) of (\d+)(, .* left)?")
"""A line of progress."""

_KEPT = 20
"""Lines of what it said that are kept."""


class Command:
    """A command with its progress, one at a time.

    Parameters
    ----------
    ended : callable
        Called with the exit code when it has ended.
    """

    def __init__(self, ended: Callable[[int], None]) -> None:
        self._ended = ended
        self._process: subprocess.Popen[str] | None = None
        self._watcher: Thread | None = None
        self._said: deque[str] = deque(maxlen=_KEPT)
        self.code: int | None = None

    @property
    def running(self) -> bool:
        """Whether it is at work, or what it did is being taken up."""
        return self._watcher is not None and self._watcher.is_alive()

    @property
    def message(self) -> str:
        """The last line that it said."""
        return self._said[-1] if self._said else ""

    @property
    def progress(self) -> tuple[int, int]:
        """What is done and how much there is, of what it does now [-]; 0 of 0 where unknown."""
        found = _OF.fullmatch(self.message)
        return (int(found[1]), int(found[2])) if found else (0, 0)

    def start(self, arguments: Sequence[str]) -> None:
        """Begin; nothing happens where it runs."""
        if self.running:
            return
        self._said.clear()
        self.code = None
        process = subprocess.Popen(
            [sys.executable, "-m", "noise", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env={**os.environ, LINES: "1"},
        )
        if hasattr(os, "setpriority"):
            with suppress(OSError):  # it has ended already
                os.setpriority(os.PRIO_PROCESS, process.pid, _NICE)
        self._process = process
        self._watcher = Thread(target=self._watch, args=(process,), daemon=True)
        self._watcher.start()

    def stop(self) -> None:
        """Tell it to end, and wait until it has."""
        process, watcher = self._process, self._watcher
        if process is None or watcher is None:
            return
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(_PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
        watcher.join(_PATIENCE)

    def _watch(self, process: subprocess.Popen[str]) -> None:
        assert process.stderr is not None
        with process.stderr as lines:
            for line in lines:
                self._said.append(line.strip())
        self.code = process.wait()
        self._ended(self.code)
