"""What is opened: recordings, tables and rigs, and which table is written."""

from __future__ import annotations

import pytest

from models.errors import ParameterError
from noise.app.corrected_segments import Correction
from noise.app.label_view import routes
from noise.app.labels import Labels
from noise.app.opened import open_paths
from noise.base.tables import write_table
from noise.cli import main
from noise.labels.corrections import version
from noise.labels.table import COLUMNS, read_label_table
from tests.helpers.labelled_folder import made_row, write_folder


@pytest.fixture
def folder(tmp_path):
    return write_folder(tmp_path / "runs", ("a.wav", "b.wav"), [made_row("a.wav")])


def test_a_folder_has_its_recordings_and_the_table_in_it(folder):
    opened = open_paths([folder])
    assert [job.name for job in opened.jobs] == ["a.wav", "b.wav"]
    assert opened.table == folder / "labels.csv"
    assert opened.job(1).path == folder / "b.wav"
    assert opened.folder == folder.parent  # nothing is saved among the recordings
    assert opened.votes == folder.parent / "runs-votes.csv"
    with pytest.raises(ParameterError, match="no recording 2"):
        opened.job(2)


def test_nothing_new_is_written_among_the_recordings(tmp_path):
    fresh = write_folder(tmp_path / "fresh", ("a.wav",))
    assert open_paths([fresh]).table == tmp_path / "fresh-labels.csv"
    assert open_paths([fresh / "a.wav"]).table == tmp_path / "fresh-labels.csv"


def test_a_table_brings_the_recordings_beside_it_and_is_the_one_that_is_corrected(folder):
    (folder / "labels.csv").rename(folder / "checked.csv")
    opened = open_paths([folder / "checked.csv"])
    assert (len(opened.jobs), opened.table) == (2, folder / "checked.csv")


def test_several_paths_and_a_rig_are_opened_together(folder, tmp_path):
    other = write_folder(tmp_path / "more", ("c.wav",))
    (tmp_path / "rig.toml").write_text('base = "fluorocarbon"\n')
    opened = open_paths([folder, other / "c.wav", tmp_path / "rig.toml"], tmp_path / "all.csv")
    assert [job.name for job in opened.jobs] == ["a.wav", "b.wav", "c.wav"]
    assert (opened.rigs, opened.table) == ((tmp_path / "rig.toml",), tmp_path / "all.csv")
    assert opened.folder == tmp_path  # beside the rig file
    assert open_paths([folder], save=tmp_path / "mine").folder == tmp_path / "mine"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["gone"], "gone does not exist"),
        (["runs/labels.csv", "--out", "other.csv"], "corrections go into the label table"),
        (["runs", "--out", "labels.xls"], "tables end in"),
        (["runs", "--out", "runs/a.wav/labels.csv"], "is a file, not a folder"),
        (["empty"], "there are no recordings in it"),
        (["bad"], "is no label table"),
    ],
)
def test_what_cannot_be_opened_is_said_in_one_line(
    folder, tmp_path, monkeypatch, capsys, arguments, reason
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    write_folder(tmp_path / "bad", ("a.wav",))
    (tmp_path / "bad" / "labels.csv").write_text("x\n1\n")
    code = 1 if arguments == ["bad"] else 2  # an input is refused, or the call as a whole
    assert main(["open", "--no-browser", *arguments]) == code
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1
    assert reason in said[0]


@pytest.mark.parametrize("port", ["99999", "-1", "80.5", "http"])
def test_a_port_that_is_none_is_refused_at_once(capsys, port):
    assert main(["open", "gone", f"--port={port}"]) == 2
    said = capsys.readouterr().err
    assert "--port" in said
    assert "from 0 to 65535" in said


def test_the_folder_of_the_demo_is_matched_with_its_table(tmp_path, capsys):
    """Its table names files of ``recordings``; the same names in ``audio`` are renderings."""
    table = tmp_path / "labels.csv"
    write_table(table, COLUMNS, [made_row("creak.wav")])
    for folder in ("recordings", "audio"):
        write_folder(tmp_path / folder, ("creak.wav",), [])
    opened = open_paths([tmp_path])
    assert [job.name for job in opened.jobs] == ["recordings/creak.wav"]
    assert "left out audio/creak.wav: made for listening" in capsys.readouterr().err
    labels = Labels(opened.jobs, opened.table)
    assert labels.foreign_file() is None
    labels.correct(0, [Correction(0.0, 2.0, "squeal")], version(labels.rows(0)))
    assert [row["file"] for row in read_label_table(table)] == ["creak.wav"]


def test_a_table_that_names_other_recordings_is_noted(tmp_path, capsys):
    table = tmp_path / "labels.csv"
    write_table(table, COLUMNS, [made_row("creak.wav")])
    write_folder(tmp_path / "recordings", ("creak.wav",), [])
    routes(open_paths([tmp_path]))  # the only recording of that name
    assert capsys.readouterr().err == ""
    write_folder(tmp_path / "copies", ("creak.wav",), [])
    routes(open_paths([tmp_path]))
    assert "names none of these recordings (creak.wav, ...)" in capsys.readouterr().err
