"""Recordings far longer, wider and more than memory: what a command needs is bounded.

The files are written block by block, and taken away again.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import soundfile

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads /proc"),
]

MOST = 600e6
"""Memory that any of these needs at most [byte]."""

GROWTH = 60e6
"""What half an hour more, or 4,500 tiny files more, may cost [byte]: tables, not sound."""

MEASURED = """
import resource, sys
from noise.cli import main
code = main(sys.argv[1:])
with open("/proc/self/status") as file:
    own = next(line for line in file if line.startswith("VmHWM")).split()[1]
helper = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss  # reads what loggers write
print("peak", int(own) + helper)
sys.exit(code)
"""

COMMANDS = ("features", "label", "review")
OUTPUTS = {"features": "table.csv", "label": "table.csv", "render": "sound", "review": "page"}


def ten_seconds(rate, channels):
    """A squeal, blows, and what else there is."""
    rng, time = np.random.default_rng(1), np.arange(10 * rate) / rate
    sound = 0.05 * rng.standard_normal(time.size)
    sound[3 * rate : 6 * rate] += 0.3 * np.sin(2.0 * np.pi * 1046.0 * time[: 3 * rate])
    blow = np.exp(-np.arange(rate // 50) / (0.003 * rate))
    for at in np.arange(6.5, 9.5, 0.05):
        first = round(at * rate)
        sound[first : first + blow.size] += 0.5 * blow * rng.standard_normal(blow.size)
    return np.repeat(sound[:, np.newaxis], channels, axis=1)


def written(path, rate, channels, seconds):
    block = ten_seconds(rate, channels)
    with soundfile.SoundFile(path, "w", rate, channels, subtype="PCM_16") as file:
        for number in range(seconds // 10):
            file.write(block * (0.5 + (number * 7919 % 13) / 30.0))
    return path


def logged(path, rate, channels, seconds):
    """The same as a logger keeps it."""
    block = ten_seconds(rate, 1)[:, 0].astype(np.float32)
    with h5py.File(path, "w") as file:
        for number in range(channels):
            data = file.create_dataset(
                f"mic{number}", (seconds * rate,), np.float32, chunks=(65_536,)
            )
            data.attrs.update({"unit": "Pa", "rate_Hz": float(rate)})
            for first in range(0, seconds * rate, block.size):
                data[first : first + block.size] = block
    return path


def peak(folder, command, *options):
    """Memory that a call needs, in a process of its own [byte]."""
    call = [sys.executable, "-c", MEASURED, command, *map(str, options)]
    out = folder / OUTPUTS[command]
    done = subprocess.run([*call, "--out", str(out)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return 1024.0 * int(done.stdout.rsplit("peak", 1)[1])


@pytest.mark.parametrize("command", COMMANDS)
def test_forty_minutes_of_two_channels_of_a_logger(tmp_path, command):
    assert peak(tmp_path, command, logged(tmp_path / "run.h5", 48_000, 2, 2400)) < MOST


@pytest.mark.parametrize("command", COMMANDS)
def test_memory_does_not_grow_with_length(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    peaks = []
    for seconds in (600, 2400):
        path = written(tmp_path / f"{seconds}.wav", 48_000, 2, seconds)
        peaks.append(peak(tmp_path, command, path))
        path.unlink()
    assert peaks[1] < peaks[0] + GROWTH


@pytest.mark.parametrize("command", [*COMMANDS, "render"])
def test_five_thousand_tiny_files(tmp_path, command):
    block = ten_seconds(8000, 1)
    peaks = []
    for count in (500, 5000):
        folder, out = tmp_path / f"in-{count}", tmp_path / f"out-{count}"
        folder.mkdir()
        out.mkdir()
        for number in range(count):
            start = number * 13 % 70_000
            soundfile.write(folder / f"{number}.wav", block[start : start + 4000], 8000)
        peaks.append(peak(out, command, folder))
    assert peaks[1] < peaks[0] + GROWTH
