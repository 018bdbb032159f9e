"""The process that reads loggers' files: whatever becomes of it, the next file is read."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from models.errors import RecordingError
from noise.batch import find_jobs, perform_all
from noise.labels.labelling import Labelling
from noise.recordings import read_recording
from noise.recordings.formats import isolated
from tests.helpers.batch_work import in_order
from tests.helpers.logger_files import WRITERS, Wave

X = np.sin(0.01 * np.arange(200_000))


@pytest.fixture
def path(tmp_path):
    return WRITERS[".h5"](tmp_path / "run.h5", [Wave("mic", "Pa", X), Wave("torque", "", 2 * X)])


def process():
    return isolated._processes[os.getpid()]


def test_it_lives_on_from_file_to_file(path, tmp_path):
    run = read_recording(path)
    first = process().pid
    np.testing.assert_array_equal(run["torque"], 2 * X)
    (tmp_path / "bad.h5").write_bytes(b"no file of that sort")
    with pytest.raises(RecordingError):
        read_recording(tmp_path / "bad.h5")
    read_recording(path)
    assert process().pid == first


def test_one_that_died_is_replaced(path):
    read_recording(path)
    process().kill()
    process().wait()
    assert read_recording(path).samples.shape == (2, X.size)


def test_one_that_dies_over_a_file_is_a_file_refused(path, monkeypatch):
    read_recording(path)
    monkeypatch.setattr(
        isolated, "_answer", lambda _: process().kill() or isolated.pickle.loads(b"")
    )
    with pytest.raises(
        RecordingError, match=r"run\.h5: is damaged or no HDF5 .* ended the process"
    ):
        read_recording(path)
    monkeypatch.undo()
    assert read_recording(path).samples.shape == (2, X.size)


def test_an_interrupt_leaves_no_half_answer_behind(path, monkeypatch):
    answered = []
    answer = isolated._answer

    def interrupted(process):
        answered.append(answer(process))
        if len(answered) == 2:
            raise KeyboardInterrupt
        return answered[-1]

    monkeypatch.setattr(isolated, "_answer", interrupted)
    with pytest.raises(KeyboardInterrupt):
        read_recording(path)
    monkeypatch.undo()
    np.testing.assert_array_equal(read_recording(path)["torque"], 2 * X)


def test_a_path_is_that_of_the_folder_where_it_is_named(path, monkeypatch):
    read_recording(path)
    monkeypatch.chdir(path.parent)
    assert read_recording("run.h5").rate == 51200.0
    with pytest.raises(RecordingError, match=r"^nowhere\.h5: there is no such file"):
        read_recording("nowhere.h5")


@pytest.mark.skipif(sys.platform == "win32", reason="a process is asked for by its number")
def test_it_ends_with_the_one_that_asks(path):
    told = (
        "import os, sys; from noise.recordings import read_recording, files;"
        "from noise.recordings.formats import isolated; read_recording(sys.argv[1]);"
        "print(isolated._processes[os.getpid()].pid, flush=True); os.kill(os.getpid(), 9)"
    )
    done = subprocess.run([sys.executable, "-c", told, path], capture_output=True, text=True)
    assert done.returncode == -signal.SIGKILL
    until = time.monotonic() + 20.0
    while time.monotonic() < until:
        try:
            os.kill(int(done.stdout), 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    pytest.fail("it is still there")


@pytest.mark.slow
def test_processes_that_share_the_work_read_the_same(path, tmp_path):
    for ending, write in WRITERS.items():
        write(tmp_path / f"run{ending}", [Wave("mic", "Pa", X)])
    (tmp_path / "bad.tdms").write_bytes(b"TDSm")
    work, jobs = Labelling(), find_jobs([tmp_path])
    work.prepare()
    assert in_order(perform_all(work, jobs, workers=2)) == in_order(perform_all(work, jobs))
