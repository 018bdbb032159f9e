"""The same work on a Dask cluster."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from models.errors import ParameterError
from noise.batch import journal_path, perform_all
from noise.cli import main
from tests.helpers.batch_work import Counting, in_order, make_jobs, make_recordings

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}


def test_the_missing_library_is_named_with_the_command_that_installs_it(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, "distributed", None)
    (tmp_path / "a.wav").touch()
    assert main(["label", str(tmp_path), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert 'pip install "bushing-noise[cluster]"' in capsys.readouterr().err


def test_a_scheduler_that_is_not_there_is_named(tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("noise.batch.cluster._PATIENCE", 0.5)
    jobs = make_jobs(tmp_path, ["a"])
    with pytest.raises(ParameterError, match="does not answer"):
        list(perform_all(Counting(tmp_path / "log"), jobs, scheduler="tcp://127.0.0.1:9"))


def test_two_ways_to_share_the_work_are_refused(tmp_path, capsys):
    assert main(["label", str(tmp_path), "--workers", "2", "--scheduler", "x"]) == 2
    assert "not allowed with" in capsys.readouterr().err


@pytest.mark.slow
def test_labels_from_a_cluster_are_byte_for_byte_those_of_one_process(
    tmp_path, cluster, monkeypatch
):
    make_recordings(tmp_path / "runs", 12, 3, 0.5)
    (tmp_path / "runs" / "day0" / "broken.json").write_text("{")
    (tmp_path / "runs" / "day0" / "broken.wav").write_bytes(
        (tmp_path / "runs" / "day0" / "shift0" / "run0000.wav").read_bytes()
    )
    monkeypatch.chdir(tmp_path)
    assert main(["label", "runs", "--out", "one.csv"]) == 1
    given = ["--out", "cluster.csv", "--scheduler", cluster.scheduler_address]
    assert main(["label", "runs", *given]) == 1
    assert Path("cluster.csv").read_bytes() == Path("one.csv").read_bytes()
    assert "runs/day0/broken.json: is no JSON" in Path("one.csv").read_text()


@pytest.mark.slow
def test_a_thousand_recordings_survive_the_death_of_command_and_worker(tmp_path, cluster):
    make_recordings(tmp_path / "runs", 1000, 20, 1.0)
    out = tmp_path / "cluster.csv"
    given = [sys.executable, "-m", "noise", "label", str(tmp_path / "runs"), "--out", str(out)]
    given += ["--scheduler", cluster.scheduler_address]
    for share in (200, 400, 600):
        command = subprocess.Popen(given, stderr=subprocess.DEVNULL)
        while (
            not journal_path(out).exists()
            or len(journal_path(out).read_bytes().splitlines()) < share
        ):
            assert command.poll() is None
            time.sleep(0.05)
        if share < 600:
            command.kill()
        else:
            os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)
        command.wait()
    assert main(["label", str(tmp_path / "runs"), "--out", str(tmp_path / "one.csv")]) == 1
    assert out.read_bytes() == (tmp_path / "one.csv").read_bytes()


@pytest.mark.slow
def test_workers_with_another_version_are_refused(tmp_path, cluster, monkeypatch):
    monkeypatch.setattr("noise.batch.cluster.program_identity", lambda: "another")
    jobs = make_jobs(tmp_path, ["a"])
    work = Counting(tmp_path / "log")
    with pytest.raises(ParameterError, match="another version"):
        list(perform_all(work, jobs, scheduler=cluster.scheduler_address))


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, worker_dashboard_address=None
    ) as cluster:
        yield cluster


@pytest.mark.slow
def test_deaths_on_a_cluster_cost_no_more_than_the_recording_at_fault(tmp_path, cluster):
    jobs = make_jobs(tmp_path, ["a", "fragile", "bad", "deadly", *"cdefgh"])
    found = in_order(
        perform_all(Counting(tmp_path / "log"), jobs, scheduler=cluster.scheduler_address)
    )
    refused = {job.name for job, done in zip(jobs, found, strict=True) if done.error}
    assert refused == {"bad.wav", "deadly.wav"}


@pytest.mark.slow
def test_a_worker_is_killed_and_the_table_is_the_same(tmp_path, cluster):
    names = [f"slow{i:02}" for i in range(20)]
    jobs = make_jobs(tmp_path, [*names, "bad"])
    alone = in_order(perform_all(Counting(tmp_path / "log"), jobs))
    found = []
    for pair in perform_all(Counting(tmp_path / "log2"), jobs, scheduler=cluster.scheduler_address):
        found.append(pair)
        if len(found) == 5:
            os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)
    assert in_order(found) == alone


def dask(port, *, folder):
    """A scheduler and two workers, processes of this machine."""
    address, module = f"tcp://127.0.0.1:{port}", [sys.executable, "-m", "distributed.cli.dask_"]
    given = {
        "scheduler": ["--host", "127.0.0.1", "--port", str(port)],
        "worker": [address, "--nthreads", "1", "--no-nanny"],
    }
    started = []
    for kind in ("scheduler", "worker", "worker"):
        call = [*module[:2], f"{module[2]}{kind}", *given[kind], "--no-dashboard"]
        started.append(
            subprocess.Popen(call, cwd=folder, env=ENVIRONMENT, stderr=subprocess.DEVNULL)
        )
    return address, started


@pytest.mark.slow
def test_a_scheduler_is_killed_and_the_same_call_goes_on_with_another(tmp_path):
    pytest.importorskip("distributed")
    make_recordings(tmp_path / "runs", 120, 6, 1.0)
    out = tmp_path / "cluster.csv"
    call = [sys.executable, "-m", "noise", "label", str(tmp_path / "runs"), "--out", str(out)]
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    for again in (False, True):
        address, started = dask(port, folder=tmp_path)
        try:
            command = subprocess.Popen(
                [*call, "--scheduler", address], env=ENVIRONMENT, stderr=subprocess.PIPE, text=True
            )
            while not again and (
                not journal_path(out).exists() or len(journal_path(out).read_bytes()) < 2000
            ):
                assert command.poll() is None, command.communicate()
                time.sleep(0.05)
            if not again:
                started[0].kill()
                kept = journal_path(out).read_bytes().rpartition(b"\n")[0].splitlines()
            _, told = command.communicate(timeout=120)
        finally:
            for process in started:
                process.kill()
                process.wait()
        if not again:
            assert command.returncode == 2
            assert f"--scheduler {address}: went away during the work" in told
            assert "Traceback" not in told
            assert not out.exists()
    assert command.returncode == 1, told
    assert journal_path(out).read_bytes().splitlines()[: len(kept)] == kept
    assert main(["label", str(tmp_path / "runs"), "--out", str(tmp_path / "one.csv")]) == 1
    assert out.read_bytes() == (tmp_path / "one.csv").read_bytes()
