"""The same work on a Dask cluster."""

from __future__ import annotations

import sys
from contextlib import closing
from pathlib import Path

import pytest

from models.errors import ParameterError
from noise.batch.journal import Journal
from noise.batch.work import perform_all
from noise.cli import main
from tests.helpers.batch_work import Counting, in_order, make_jobs, make_recordings


def performed(work, jobs, **how):
    with closing(Journal()) as journal:
        return in_order(perform_all(work, jobs, journal, **how))


def test_the_missing_library_is_named_with_the_command_that_installs_it(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, "distributed", None)
    (tmp_path / "a.wav").touch()
    assert main(["label", str(tmp_path), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert 'pip install "bushing-noise[cluster]"' in capsys.readouterr().err


def test_a_scheduler_that_is_not_there_is_named(tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("noise.batch.cluster._TIMEOUT", 0.5)
    jobs = make_jobs(tmp_path, ["a"])
    with pytest.raises(ParameterError, match="does not answer"):
        performed(Counting(tmp_path / "log"), jobs, scheduler="tcp://127.0.0.1:9")


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, worker_dashboard_address=None
    ) as cluster:
        yield cluster


@pytest.mark.slow
def test_labels_from_a_cluster_are_byte_for_byte_those_of_one_process(
    tmp_path, cluster, monkeypatch
):
    make_recordings(tmp_path / "runs", 12, 3, 0.5)
    first = tmp_path / "runs" / "day0"
    (first / "broken.json").write_text("{")
    (first / "broken.wav").write_bytes((first / "shift0" / "run0000.wav").read_bytes())
    monkeypatch.chdir(tmp_path)
    assert main(["label", "runs", "--out", "one.csv"]) == 1
    given = ["--out", "cluster.csv", "--scheduler", cluster.scheduler_address]
    assert main(["label", "runs", *given]) == 1
    assert Path("cluster.csv").read_bytes() == Path("one.csv").read_bytes()
    assert "runs/day0/broken.json: is no JSON" in Path("one.csv").read_text()


@pytest.mark.slow
def test_workers_with_another_version_are_refused(tmp_path, cluster, monkeypatch):
    monkeypatch.setattr("noise.batch.cluster.RESULTS_VERSION", -1)
    jobs = make_jobs(tmp_path, ["a"])
    with pytest.raises(ParameterError, match="another version"):
        performed(Counting(tmp_path / "log"), jobs, scheduler=cluster.scheduler_address)


@pytest.mark.slow
def test_deaths_on_a_cluster_cost_no_more_than_the_recording_at_fault(tmp_path, cluster):
    jobs = make_jobs(tmp_path, ["a", "fragile", "bad", "deadly", *"cdefgh"])
    address = cluster.scheduler_address
    found = performed(Counting(tmp_path / "log"), jobs, scheduler=address)
    refused = {job.name for job, done in zip(jobs, found, strict=True) if done.error}
    assert refused == {"bad.wav", "deadly.wav"}
