"""Bars on a terminal, one line a step in a file."""

import fcntl
import io
import os
import pty
import select
import struct
import sys
import termios
import time

import pytest

from noise.base.progress import say, steps, track


def on_terminal(monkeypatch, work):
    """What a terminal of 100 columns shows of some work."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
    with os.fdopen(theirs, "w", buffering=1) as stream:
        monkeypatch.setattr(sys, "stderr", stream)
        work()
        stream.flush()
        shown = b""
        while select.select([ours], [], [], 0.2)[0]:
            shown += os.read(ours, 1 << 16)
    os.close(ours)
    return shown.decode()


def in_file(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    return stream


def work():
    with steps("screening", 3) as tell:
        for text in ("preparing", "mapping", "grading"):
            tell(text)
            say(f"{text} goes well")


def test_a_terminal_shows_how_many_steps_are_done_and_left_and_keeps_the_lines(monkeypatch):
    shown = on_terminal(monkeypatch, work)
    for done in range(3):
        assert f"{done}/3 " in shown
    assert "screening" in shown
    assert "grading goes well\r\n" in shown


def test_the_bar_of_a_long_step_goes_on_showing_how_long_it_takes(monkeypatch):
    def long():
        with steps("screening", 2) as tell:
            tell("mapping")
            time.sleep(2.2)

    shown = on_terminal(monkeypatch, long)
    assert "[00:01<" in shown
    assert "[00:02<" in shown


def test_the_bar_of_items_goes_on_while_one_takes_long(monkeypatch):
    def long():
        for _ in track(["drive"], "computing", unit="row group"):
            time.sleep(2.2)

    shown = on_terminal(monkeypatch, long)
    assert "0/1 " in shown
    assert "[00:02<" in shown


def test_more_steps_than_were_expected_are_never_more_than_all(monkeypatch):
    def fits():
        with steps("diagnosing", 1) as tell:
            for number in range(4):
                tell(f"fit {number}")

    assert "3/4 " in on_terminal(monkeypatch, fits)


def test_fewer_steps_than_were_expected_and_items_in_a_step_end_well(monkeypatch):
    def train():
        with steps("training", 9) as tell:
            tell("simulating")
            assert list(track([1, 2], "drawing", unit="sample")) == [1, 2]

    assert "drawing" in on_terminal(monkeypatch, train)


def test_an_error_ends_the_bar(monkeypatch):
    def fails():
        with steps("screening", 2) as tell:
            tell("mapping")
            raise RuntimeError

    def work():
        with pytest.raises(RuntimeError):
            fails()
        say("told")

    assert on_terminal(monkeypatch, work).endswith("told\r\n")


def test_a_file_gets_the_lines_alone(monkeypatch):
    stream = in_file(monkeypatch)
    work()
    assert stream.getvalue().splitlines() == [
        line for text in ("preparing", "mapping", "grading") for line in (text, f"{text} goes well")
    ]


def test_a_closed_standard_error_is_no_reason_to_stop(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    work()
