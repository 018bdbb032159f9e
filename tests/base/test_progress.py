"""Bars on a terminal, one line a step in a file."""

import fcntl
import os
import pty
import struct
import sys
import termios
import threading
from contextlib import suppress

import pytest

from noise.base.progress import say, steps


class Terminal:
    """A terminal of 100 columns, which is standard error while something works."""

    def __init__(self, monkeypatch):
        self._monkeypatch, self._shown = monkeypatch, bytearray()

    def shows(self, work):
        """All that it shows of some work."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
        reading = threading.Thread(target=self._read, args=(ours,))
        reading.start()
        with os.fdopen(theirs, "w", buffering=1) as stream:
            self._monkeypatch.setattr(sys, "stderr", stream)
            work()
        reading.join()
        os.close(ours)
        return self._shown.decode()

    def _read(self, ours):
        with suppress(OSError):  # so it ends on Linux
            while more := os.read(ours, 1 << 16):
                self._shown += more


@pytest.fixture
def terminal(monkeypatch):
    return Terminal(monkeypatch)


def work():
    with steps("screening", 3) as tell:
        for text in ("preparing", "mapping", "grading"):
            tell(text)
            say(f"{text} goes well")


def test_a_terminal_shows_how_many_steps_are_done_and_left_and_keeps_the_lines(terminal):
    shown = terminal.shows(work)
    for done in range(3):
        assert f"{done}/3 " in shown
    assert "screening" in shown
    assert "grading goes well\r\n" in shown
