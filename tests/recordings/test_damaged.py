"""Damaged recordings, and the process that reads loggers' files: one file refused, the next read.

Damage of all sorts, on every reader and command, is in `tests/fuzz`.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings, strategies as st

from noise.recordings import read_recording
from noise.recordings.formats.isolated import open_isolated
from tests.helpers.files import refusal
from tests.helpers.logger_files import WRITERS, Wave, uff

ENDINGS = (*WRITERS, ".uff", ".wav", ".flac")


@pytest.fixture(scope="module")
def valid(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valid")
    x, y = np.random.default_rng(7).normal(0, 0.1, (2, 300))
    for ending, write in WRITERS.items():
        waves = [Wave("mic", "Pa", x), Wave("torque", "", y)]
        write(folder / f"valid{ending}", waves, {"speed_rad_s": 5.0, "material": "PDMS"})
    uff(folder / "valid.uff", (x, "Pa"))
    for ending in (".wav", ".flac"):
        soundfile.write(folder / f"valid{ending}", x, 51200, subtype="PCM_16")
    assert {read_recording(path).rate for path in folder.iterdir()} == {51200.0}
    return {ending: (folder / f"valid{ending}").read_bytes() for ending in ENDINGS}


def refusal_of(folder: Path, ending: str, content: bytes) -> str:
    path = folder / f"run{ending}"
    path.write_bytes(content)
    return refusal(path)


@pytest.mark.parametrize("ending", ENDINGS)
@settings(max_examples=30, suppress_health_check=list(HealthCheck))
@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(valid, tmp_path_factory, ending, share):
    # In text, all samples are there once the mark of the end has begun.
    content = valid[ending]
    whole = content.rindex(b"    -1") if ending == ".uff" else len(content)
    refusal_of(tmp_path_factory.mktemp("cut"), ending, content[: int(share * whole)])


def at(content: bytearray, place: int, width: int, value: int) -> bytes:
    content[place : place + width] = value.to_bytes(width, "little")
    return bytes(content)


def text_of_4_gb(c):
    place = c.index(b"unit\0")
    return at(c, c.index((2).to_bytes(4, "little"), place + 32), 4, 2**32 - 1)


def heap_without_end(c):
    heap = c.index(b"GCOL")
    at(c, heap + 24, 8, 0)  # length of the first text ...
    return at(c, heap + 16, 2, 0)  # ... which is now free space that goes nowhere


def group_that_follows_itself(c):
    group = c.index(b"##DG")
    return at(c, group + 24, 8, group)


def text_beyond_the_end(c):
    return at(c, c.index(b"##CN") + 24 + 16, 8, 1 << 40)  # third link of a channel


def channel_outside_its_record(c):
    channel = c.index(b"##CN")
    links = int.from_bytes(c[channel + 16 : channel + 24], "little")
    return at(c, channel + 24 + 8 * links + 4, 4, 10**6)


FOUND = {
    "text of 4 GB": (".h5", text_of_4_gb, "memory"),
    "heap without an end": (".h5", heap_without_end, "(reading it took longer than 1 s)"),
    "circle of groups": (".mf4", group_that_follows_itself, "(reading it took longer than 1 s)"),
    "text beyond the end": (".mf4", text_beyond_the_end, "exceeds the file size"),
    "channel outside": (".mf4", channel_outside_its_record, "is damaged or no MDF file"),
    "open segment": (".tdms", lambda c: at(c, 12, 8, 2**64 - 1), "its last segment goes on"),
}


@pytest.mark.parametrize(("ending", "damage", "reason"), FOUND.values(), ids=FOUND)
def test_what_fuzzing_found_is_refused(valid, tmp_path, monkeypatch, ending, damage, reason):
    if "longer" in reason:
        monkeypatch.setattr("noise.recordings.formats.isolated._TIME_LIMIT", 1.0)
    assert reason in refusal_of(tmp_path, ending, damage(bytearray(valid[ending])))


# The process that reads

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
def test_a_file_that_is_open_and_the_next_do_without_the_process_that_read_the_last(path):
    with open_isolated(path) as raw:
        for pid in children():
            os.kill(pid, signal.SIGKILL)
        np.testing.assert_array_equal(raw.read(7, 99)[1], 2 * X[7:99])
    assert read_recording(path).samples.shape == (2, X.size)


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


def test_a_process_that_may_start_no_other_reads_as_well(path):
    process = get_context("spawn").Process(target=read_recording, args=(path,), daemon=True)
    process.start()
    process.join(60.0)
    assert process.exitcode == 0
