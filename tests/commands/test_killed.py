"""Batches that are killed or interrupted and called again go on where they were."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from noise.batch.journal import journal_path
from noise.cli import main
from tests.helpers.batch_work import make_recordings
from tests.helpers.kept import results_in

pytestmark = pytest.mark.skipif(os.name == "nt", reason="has no SIGKILL")

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
_TOOK = re.compile(rb'"seconds": [\d.]+|Screened in [\d.]+ s|Time taken</dt><dd>[\d.]+ s')
"""How long it took is told, and differs."""


def contents(folder):
    """All files of a folder, hidden ones as well, but for journals and parts of a file."""
    return {
        path.relative_to(folder).as_posix(): _TOOK.sub(b"", path.read_bytes())
        for path in folder.rglob("*")
        if path.is_file() and ".journal" not in path.name and ".part" not in path.name
    }


def start(call, folder, **how):
    return subprocess.Popen(
        [sys.executable, "-m", "noise", *call], cwd=folder, env=ENVIRONMENT,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how,
    )  # fmt: skip


def wait_for(process, journal, number):
    """Wait until a journal has so many results."""
    while len(results_in(journal)) < number:
        assert process.poll() is None, process.communicate()
        time.sleep(1e-3)


def held(journal, process):
    """Give a journal a second name, which outlives the call."""
    wait_for(process, journal, 1)
    second = journal.with_name("held.journal")
    if not second.exists():
        os.link(journal, second)
    return second


RUNS = ["runs", "--out", "t.csv"]
KEEPING = {  # call, what its journal is of, exit code, results after which it is killed
    "label": (["label", *RUNS], "t.csv", 1, (4,)),
    "screen": (["screen", "fluorocarbon", "PDMS", "--simulations", "200", "--no-tolerances",
                "--sounds", "1", "--out", "screen"], "screen/map.csv", 0, (1, 4)),
}  # fmt: skip


@pytest.mark.parametrize(
    "command",
    [pytest.param(name, marks=[pytest.mark.slow] * (name != "label")) for name in KEEPING],
)
def test_what_was_done_before_a_kill_is_not_done_again(command, tmp_path, monkeypatch):
    call, target, code, numbers = KEEPING[command]
    undisturbed, killed = tmp_path / "undisturbed", tmp_path / "killed"
    make_recordings(undisturbed / "runs", 12, 2, 0.2)
    shutil.copytree(undisturbed / "runs", killed / "runs")
    monkeypatch.chdir(undisturbed)
    assert main(call) == code
    journal, kept = killed / journal_path(Path(target)), None
    for number in numbers:
        process = start(call, killed)
        wait_for(process, journal, number)
        kept = held(journal, process)
        process.kill()
        process.communicate()
        assert not (killed / target).exists()
    before = results_in(journal)
    monkeypatch.chdir(killed)
    assert main(call) == code
    after = results_in(kept)
    assert after[: len(before)] == before
    assert len(after) == len({key for _, key in after}) > len(before)
    assert contents(killed) == contents(undisturbed)
    assert journal.exists() == (command != "screen")


def test_interrupted_it_writes_what_it_did_and_ends_its_processes(tmp_path, capsys):
    make_recordings(tmp_path / "runs", 20, 4, 0.2)
    table = tmp_path / "t.csv"
    process = start(["label", *RUNS, "--workers", "2"], tmp_path, start_new_session=True)
    wait_for(process, journal_path(table), 5)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)  # its processes have the same standard error
    assert process.returncode == 130
    assert "interrupted: " in err
    assert "Traceback" not in err
    assert len({line.split(",")[0] for line in table.read_text().splitlines()[1:]}) >= 5
    assert main(["label", str(tmp_path / "runs"), "--out", str(table)]) == 1
    assert "of 20 recordings are done already" in capsys.readouterr().err
