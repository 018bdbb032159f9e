"""Folders searched at any depth: links, loops, and what goes away."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from models.errors import RecordingError
from noise.recordings import find_recordings, read_recording
from noise.recordings.folders import files_below


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


def test_links_in_a_circle_end_where_they_began(day):
    (day / "again").symlink_to(day)
    (day / "above").symlink_to(day.parent)
    assert names(day) == ["run07.wav", "run08.wav"]


def test_a_folder_that_is_there_keeps_its_own_name_whatever_links_lead_to_it(day, tmp_path):
    (tmp_path / "a-link").symlink_to(day)
    assert names(tmp_path) == ["day1/run07.wav", "day1/run08.wav"]


def test_a_link_to_nowhere_and_what_is_hidden_are_left_out(day):
    (day / "run09.wav").symlink_to(day / "gone.wav")
    (day / ".trash").mkdir()
    (day / ".trash" / "run01.wav").touch()
    (day / ".run02.wav").touch()
    assert names(day) == ["run07.wav", "run08.wav"]


def test_what_is_no_file_is_told_of_in_one_line_and_never_opened(day, tmp_path, capsys):
    os.mkfifo(day / "pipe.wav")  # which a reader would wait for
    (day / "run09.wav").symlink_to(day / "gone.wav")
    (day / "noise.wav").symlink_to("/dev/zero")
    assert names(tmp_path) == ["day1/run07.wav", "day1/run08.wav"]
    assert capsys.readouterr().err == (
        f"bushing-noise: note: {tmp_path}: left out day1/noise.wav: is a device, not a file; "
        "day1/pipe.wav: is a pipe, not a file; day1/run09.wav: links to nothing\n"
    )


def test_a_folder_that_nobody_may_look_into_costs_no_other(day, tmp_path, capsys, monkeypatch):
    (tmp_path / "day2").mkdir()
    listed = os.scandir

    def refusing(place):
        if Path(place).name == "day2":
            raise PermissionError(13, "Permission denied", str(place))
        return listed(place)

    monkeypatch.setattr(os, "scandir", refusing)
    assert names(tmp_path) == ["day1/run07.wav", "day1/run08.wav"]
    assert "left out day2: cannot be looked into" in capsys.readouterr().err


def test_a_folder_that_goes_away_while_it_is_searched_costs_no_other(day, tmp_path, monkeypatch):
    (tmp_path / "day2").mkdir()
    (tmp_path / "day2" / "run10.wav").touch()
    listed = os.scandir

    def vanishing(place):
        if Path(place).name == "day2":
            raise FileNotFoundError(2, "No such file or directory", str(place))
        return listed(place)

    monkeypatch.setattr(os, "scandir", vanishing)
    assert [name for _, name in files_below(tmp_path)] == ["day1/run07.wav", "day1/run08.wav"]


def test_recordings_that_are_not_read_are_named_once_with_what_to_do(day, tmp_path, capsys):
    for name in (
        "memo.m4a",
        "MEMO2.WMA",
        "day1/a.aac",
        "day1/b.caf",
        "x.mat",
        "notes.txt",
        "p.pdf",
    ):
        (tmp_path / name).touch()
    assert names(tmp_path) == ["day1/run07.wav", "day1/run08.wav"]
    assert capsys.readouterr().err.splitlines() == [
        f"bushing-noise: note: {tmp_path}: left out MEMO2.WMA, day1/a.aac, day1/b.caf and 1 more: "
        "not read; convert to WAV or FLAC, as by: ffmpeg -i MEMO2.WMA MEMO2.wav",
        f"bushing-noise: note: {tmp_path}: left out x.mat: not read; export as TDMS, MDF4, HDF5, "
        "UFF58 or WAV from the program that wrote it",
    ]


def test_a_recording_that_is_not_read_is_refused_with_what_to_do(tmp_path):
    path = tmp_path / "memo.M4A"
    path.write_bytes(b"ftypM4A ")
    with pytest.raises(RecordingError, match=r"ffmpeg -i memo.M4A memo.wav"):
        read_recording(path)
