"""The command killed at any moment, and called again."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import noise
from noise.batch import journal_path
from noise.cli import main
from tests.helpers.batch_work import make_recordings


def start(folder, out, *options, **how):
    command = [sys.executable, "-m", "noise", "label", str(folder), "--out", str(out), *options]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how
    )


def done_in(journal):
    if not journal.exists():
        return []
    whole = journal.read_bytes().rpartition(b"\n")[0].splitlines()
    return [json.loads(line.rpartition(b" ")[0])[0] for line in whole[1:]]


def kill_when(process, out, number, how=signal.SIGKILL, *, group=False):
    """Kill the command once so many recordings are in its journal."""
    while len(done_in(journal_path(out))) < number:
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    (os.killpg if group else os.kill)(process.pid, how)
    return process.communicate()


def killed_three_times(tmp_path, number, broken, seconds, *options):
    make_recordings(tmp_path / "runs", number, broken, seconds)
    out = tmp_path / "new" / "labels.csv"
    for share in (0.1, 0.3, 0.6):  # so much is left that it is not done before the kill comes
        kill_when(start(tmp_path / "runs", out, *options), out, share * (number - broken))
        assert not out.exists()
        assert not list(out.parent.glob("*.part*"))
    last = start(tmp_path / "runs", out, *options)
    _, err = last.communicate()
    assert last.returncode == 1
    assert f"{number} recordings, {broken} refused" in err
    done = done_in(journal_path(out))
    assert len(done) == len(set(done)) == number - broken
    return out


def undisturbed(tmp_path, ending=".csv"):
    out = tmp_path / f"undisturbed{ending}"
    main(["label", str(tmp_path / "runs"), "--out", str(out)])
    return out


def test_killed_three_times_the_table_is_that_of_an_undisturbed_run(tmp_path):
    out = killed_three_times(tmp_path, 40, 4, 0.2)
    assert out.read_bytes() == undisturbed(tmp_path).read_bytes()


@pytest.mark.slow
def test_a_thousand_recordings_survive_three_kills(tmp_path):
    out = killed_three_times(tmp_path, 1000, 20, 1.0, "--workers", "2")
    assert out.read_bytes() == undisturbed(tmp_path).read_bytes()


@pytest.mark.parametrize("ending", [".csv", ".xlsx", ".jsonl", ".parquet"])
@pytest.mark.slow
def test_the_table_is_the_same_with_two_processes(tmp_path, ending):
    make_recordings(tmp_path / "runs", 12, 2, 0.5)
    out = tmp_path / f"two{ending}"
    start(tmp_path / "runs", out, "--workers", "2").communicate()
    assert out.read_bytes() == undisturbed(tmp_path, ending).read_bytes()


def test_told_to_end_it_keeps_what_it_did(tmp_path):
    make_recordings(tmp_path / "runs", 40, 4, 0.2)
    out = tmp_path / "labels.csv"
    process = start(tmp_path / "runs", out)
    _, err = kill_when(process, out, 5, signal.SIGTERM)
    assert process.returncode == 143
    assert "interrupted: " in err
    kept = out.read_text().splitlines()[1:]
    assert len({line.split(",")[0] for line in kept}) >= 5


@pytest.mark.slow
def test_an_interrupt_ends_all_processes_and_the_next_call_goes_on(tmp_path, capsys):
    make_recordings(tmp_path / "runs", 40, 4, 0.2)
    out = tmp_path / "labels.csv"
    process = start(tmp_path / "runs", out, "--workers", "2", start_new_session=True)
    _, err = kill_when(process, out, 5, signal.SIGINT, group=True)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert main(["label", str(tmp_path / "runs"), "--out", str(out)]) == 1
    assert "of 40 recordings are done already" in capsys.readouterr().err
    assert out.read_bytes() == undisturbed(tmp_path).read_bytes()


def test_later_calls_do_only_what_is_new_or_changed(tmp_path, capsys):
    make_recordings(tmp_path / "runs", 8, 2, 0.2)
    out = tmp_path / "labels.csv"
    assert main(["label", str(tmp_path / "runs"), "--out", str(out)]) == 1
    (tmp_path / "runs" / "new.wav").write_bytes(
        (tmp_path / "runs" / "day0" / "shift0" / "run0000.wav").read_bytes()
    )
    (tmp_path / "runs" / "day2" / "shift2" / "run0002.json").write_text(
        '{"conditions": {"speed_rad_s": 5.0}}'
    )
    capsys.readouterr()
    assert main(["label", str(tmp_path / "runs"), "--out", str(out)]) == 1
    err = capsys.readouterr().err
    assert "5 of 9 recordings are done already" in err  # but for 2 refused, 1 new, 1 changed
    assert out.read_bytes() == undisturbed(tmp_path).read_bytes()


def test_a_notebook_goes_on_where_the_command_stopped_and_the_command_where_the_notebook_did(
    tmp_path, monkeypatch, capsys
):
    make_recordings(tmp_path / "runs", 40, 4, 0.2)
    out = tmp_path / "labels.csv"
    kill_when(start(tmp_path / "runs", out), out, 10)
    by_command = done_in(journal_path(out))

    def interrupted(work, path, name, of=noise.batch.work.perform, left=[10]):  # noqa: B006
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        return of(work, path, name)

    with monkeypatch.context() as patch:
        patch.setattr("noise.batch.work.perform", interrupted)
        with pytest.raises(KeyboardInterrupt):
            noise.label(tmp_path / "runs", out=out)
    both = done_in(journal_path(out))
    assert both[: len(by_command)] == by_command
    assert 5 <= len(both) - len(by_command) <= 10
    assert not out.exists()
    assert main(["label", str(tmp_path / "runs"), "--out", str(out)]) == 1
    assert f"{len(both)} of 40 recordings are done already" in capsys.readouterr().err
    done = done_in(journal_path(out))
    assert len(done) == len(set(done)) == 36
    table = noise.label(tmp_path / "runs", out=tmp_path / "notebook.csv")
    assert (tmp_path / "notebook.csv").read_bytes() == out.read_bytes()
    assert len(table.refused) == 4


@pytest.mark.slow
def test_the_processes_of_a_killed_command_end_as_well(tmp_path):
    pytest.importorskip("fcntl")
    make_recordings(tmp_path / "runs", 40, 4, 0.2)
    out = tmp_path / "labels.csv"
    process = start(tmp_path / "runs", out, "--workers", "2")
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    if not children.exists():
        pytest.skip("tells no children of a process")
    while len(done_in(journal_path(out))) < 5:
        time.sleep(0.02)
    ours = [Path("/proc") / pid for pid in children.read_text().split()]
    assert len(ours) >= 2
    # Their standard error is ours, and is closed when the last of them is gone.
    os.kill(process.pid, signal.SIGKILL)
    process.communicate(timeout=20)
