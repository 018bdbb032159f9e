"""What a call keeps until it is done: there after a kill, gone after the end."""

from __future__ import annotations

import pytest

from models.errors import ParameterError
from noise.batch import journal_path
from noise.batch.lines import kept_results


def call(target, identity, end=None):
    """Keep one result, then end; return what was there before."""
    with kept_results(target, identity) as lines:
        there = dict(lines.found)
        lines.add("a", [0.1, float("inf")], "said")
        if end is not None:
            raise end
    return there


def no_room():
    """As of a file that was to be written."""
    error = ParameterError("labels.csv: cannot be written (no space left on device)")
    error.__context__ = OSError("no space left on device")
    return error


def test_what_is_kept_is_there_until_the_call_has_come_to_its_end(tmp_path):
    target = tmp_path / "new" / "set"
    for end in (KeyboardInterrupt(), no_room()):
        with pytest.raises(type(end)):
            call(target, "same", end)
    assert call(target, "same") == {"a": [[0.1, float("inf")], "said"]}
    assert not list(target.parent.iterdir())


def test_of_another_call_nothing_is_taken(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        call(tmp_path / "set", "one", KeyboardInterrupt())
    assert call(tmp_path / "set", "another") == {}


def test_a_call_that_is_refused_leaves_nothing(tmp_path):
    (tmp_path / "there").mkdir()
    for folder in ("there", "new"):
        with pytest.raises(ParameterError, match="clip"):
            call(tmp_path / folder / "set", "same", ParameterError("would clip"))
        with pytest.raises(ParameterError), kept_results(tmp_path / folder / "set", "same"):
            raise ParameterError("no such design")
    assert [path.name for path in tmp_path.rglob("*")] == ["there"]


def test_what_another_process_keeps_is_left_to_it(tmp_path):
    pytest.importorskip("fcntl")
    with kept_results(tmp_path / "set", "same") as lines:
        lines.add("a", 1)
        with (
            pytest.raises(ParameterError, match="another process"),
            kept_results(tmp_path / "set", "same"),
        ):
            pass
        assert journal_path(tmp_path / "set").exists()


def test_without_a_target_nothing_is_kept():
    with kept_results(None, "same") as lines:
        assert lines is None
