"""The process that reads loggers' files: whatever becomes of it, the next file is read."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from models.errors import RecordingError
from noise.batch import find_jobs, perform_all
from noise.labels.labelling import Labelling
from noise.recordings import read_recording
from noise.recordings.formats.isolated import open_isolated
from tests.helpers.batch_work import in_order
from tests.helpers.logger_files import WRITERS, Wave

X = np.sin(0.01 * np.arange(200_000))
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="lists processes as Linux does")


@pytest.fixture
def path(tmp_path):
    return WRITERS[".h5"](tmp_path / "run.h5", [Wave("mic", "Pa", X), Wave("torque", "", 2 * X)])


def children(of=None):
    """Numbers of the processes that one has started, without the one that tracks semaphores."""
    stats = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has ended
            stats.append(path.read_text())
    parents = {int(stat.split()[0]): int(stat.rpartition(")")[2].split()[1]) for stat in stats}
    return {
        pid
        for pid, parent in parents.items()
        if parent == (of or os.getpid())
        and b"resource_tracker" not in Path(f"/proc/{pid}/cmdline").read_bytes()
    }


@LINUX
def test_it_lives_on_from_file_to_file_whatever_they_are(path, tmp_path):
    np.testing.assert_array_equal(read_recording(path)["torque"], 2 * X)
    before = children()
    (tmp_path / "bad.h5").write_bytes(b"no file of that sort")
    with pytest.raises(RecordingError):
        read_recording(tmp_path / "bad.h5")
    read_recording(path)
    assert children() == before


@LINUX
def test_one_that_dies_over_a_file_is_a_file_refused_and_the_next_is_read(path):
    read_recording(path)
    with open_isolated(path) as raw:
        for pid in children():
            os.kill(pid, signal.SIGKILL)
        with pytest.raises(RecordingError, match=r"run\.h5: .* no HDF5 .* ended the process"):
            raw.read(0, 100)
    assert read_recording(path).samples.shape == (2, X.size)


def test_an_interrupt_leaves_no_half_answer_behind(path):
    with pytest.raises(KeyboardInterrupt), open_isolated(path):
        raise KeyboardInterrupt
    np.testing.assert_array_equal(read_recording(path)["torque"], 2 * X)


def test_two_files_are_open_at_once(path):
    with open_isolated(path) as one, open_isolated(path) as other:
        np.testing.assert_array_equal(one.read(7, 99), other.read(7, 99))


def test_a_path_is_that_of_the_folder_where_it_is_named(path, monkeypatch):
    read_recording(path)
    monkeypatch.chdir(path.parent)
    assert read_recording("run.h5").rate == 51200.0
    with pytest.raises(RecordingError, match=r"^nowhere\.h5: there is no such file"):
        read_recording("nowhere.h5")


@LINUX
def test_it_ends_with_the_one_that_asks(path):
    code = (
        "import sys, time; from noise.recordings import read_recording;"
        "read_recording(sys.argv[1]); print('read', flush=True); time.sleep(60)"
    )
    call = [sys.executable, "-c", code, path]
    with subprocess.Popen(call, stdout=subprocess.PIPE, text=True) as asking:
        assert asking.stdout.readline() == "read\n"
        started = children(asking.pid)
        asking.kill()
    until = time.monotonic() + 20.0
    while any(Path(f"/proc/{pid}").exists() for pid in started):
        assert time.monotonic() < until
        time.sleep(0.05)


@pytest.mark.slow
def test_processes_that_share_the_work_read_the_same(path, tmp_path):
    for ending, write in WRITERS.items():
        write(tmp_path / f"run{ending}", [Wave("mic", "Pa", X)])
    (tmp_path / "bad.tdms").write_bytes(b"TDSm")
    work, jobs = Labelling(), find_jobs([tmp_path])
    work.prepare()
    assert in_order(perform_all(work, jobs, workers=2)) == in_order(perform_all(work, jobs))
