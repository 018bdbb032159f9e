"""Folders searched at any depth: links, loops, and what goes away."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from models.errors import ParameterError, RecordingError
from noise.recordings import find_recordings, read_recording


@pytest.fixture
def day(tmp_path):
    folder = tmp_path / "day1"
    folder.mkdir()
    for name in ("run07.wav", "run08.wav"):
        (folder / name).touch()
    return folder


def names(folder):
    return [name for _, name in find_recordings(folder)]


def test_a_link_to_a_folder_elsewhere_is_followed(day, tmp_path):
    (tmp_path / "campaign").mkdir()
    (tmp_path / "campaign" / "monday").symlink_to(day)
    assert names(tmp_path / "campaign") == ["monday/run07.wav", "monday/run08.wav"]


def test_links_in_a_circle_end_and_no_file_is_found_twice(day):
    (day / "again").symlink_to(day)
    (day / "above").symlink_to(day.parent)
    assert names(day) == ["run07.wav", "run08.wav"]


def test_files_are_in_order_and_what_is_hidden_is_left_out(tmp_path):
    files = ["b.wav", "a/z.FLAC", "a/b/c.ogg", "a.wav", "a.json", "notes.txt"]
    for name in (*files, ".part.wav", ".git/x.wav", "a/._z.wav"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "folder.wav").mkdir()
    found = find_recordings([tmp_path])
    assert [name for _, name in found] == ["a.wav", "a/b/c.ogg", "a/z.FLAC", "b.wav"]
    assert all(file == tmp_path / name for file, name in found)
    for name in ("notes.txt", "a/._z.wav"):  # which stand for themselves where they are named
        assert find_recordings(str(tmp_path / name)) == [(tmp_path / name, Path(name).name)]


@pytest.mark.parametrize("name", ["nowhere", "nowhere.wav", "x" * 5000])
def test_a_path_that_does_not_exist_is_refused(tmp_path, name):
    with pytest.raises(ParameterError):
        find_recordings([tmp_path, tmp_path / name])
    with pytest.raises(RecordingError):
        read_recording(tmp_path / f"{name}.wav")


def test_what_is_no_file_is_told_of_by_the_reason_and_never_opened(day, tmp_path, capsys):
    os.mkfifo(day / "pipe.wav")  # which a reader would wait for
    (day / "run09.wav").symlink_to(day / "gone.wav")
    (day / "noise.wav").symlink_to("/dev/zero")
    assert names(tmp_path) == ["day1/run07.wav", "day1/run08.wav"]
    assert capsys.readouterr().err.splitlines() == [
        f"bushing-noise: note: {tmp_path}: left out day1/noise.wav, day1/pipe.wav, day1/run09.wav: "
        "is no file, or links to nothing"
    ]


def test_recordings_that_are_not_read_are_named_once_with_what_to_do(day, tmp_path, capsys):
    others = ("memo.m4a", "MEMO2.WMA", "day1/a.aac", "day1/b.caf", "x.sie", "notes.txt", "p.pdf")
    for name in others:
        (tmp_path / name).touch()
    assert names(tmp_path) == ["day1/run07.wav", "day1/run08.wav"]
    assert capsys.readouterr().err.splitlines() == [
        f"bushing-noise: note: {tmp_path}: left out MEMO2.WMA, day1/a.aac, day1/b.caf and 2 more: "
        "recordings of this format are not read; convert to WAV or FLAC, as by ffmpeg"
    ]
