"""Bars on a terminal, one line a step in a file."""

import io
import sys

from noise.base.progress import say, steps


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_terminal_shows_how_many_steps_are_done_and_left_and_keeps_the_lines(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    with steps("screening", 3) as tell:
        for text in ("preparing", "mapping", "grading"):
            tell(text)
            say(f"{text} goes well")
    shown = sys.stderr.getvalue()
    for done in range(3):
        assert f"{done}/3 " in shown
    assert "screening" in shown
    assert "grading goes well\n" in shown
