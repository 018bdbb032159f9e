"""Commands called at a bad moment, or with what no machine has: one line, and the exit code."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

import pytest

from noise.cli import main
from tests.helpers.batch_work import make_recordings

ROOT = Path(__file__).parents[2]

SCRIPT = """
import os, signal, sys

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == os.environ["AT"]:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupt())
from noise.__main__ import run
run()
"""


@pytest.mark.parametrize("at", ["noise.cli", "noise.commands.features", "noise.recordings"])
def test_an_interrupt_while_a_command_is_loaded_is_one_line(tmp_path, at):
    script = tmp_path / "bushing-noise"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, script, "features", str(tmp_path)],
        capture_output=True, text=True, env={**os.environ, "AT": at, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.stderr == "bushing-noise: interrupted\n"
    assert done.returncode == 130


TWICE = """
import atexit, os, signal, sys

def interrupted(*_):
    raise KeyboardInterrupt

from noise import cli
if os.environ["AT"] == "again":
    cli.main = interrupted
else:
    cli.main = lambda: 0
    atexit.register(os.kill, os.getpid(), signal.SIGINT)
from noise.__main__ import run
run()
"""


@pytest.mark.parametrize("at", ["again", "the end"])
def test_a_second_interrupt_and_one_at_the_end_are_quiet(tmp_path, at):
    script = tmp_path / "bushing-noise"
    script.write_text(TWICE)
    done = subprocess.run(
        [sys.executable, script],
        capture_output=True, text=True, env={**os.environ, "AT": at, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.stderr in ("", "bushing-noise: interrupted\n")
    assert done.returncode == 130


@pytest.mark.skipif(sys.platform != "linux", reason="finds processes as Linux lists them")
def test_an_interrupt_while_helping_processes_are_loaded_is_not_for_them(tmp_path):
    make_recordings(tmp_path / "runs", 4, 1, 0.2)
    command = ["label", str(tmp_path / "runs"), "--workers", "2", "--out", str(tmp_path / "a.csv")]
    process = subprocess.Popen(
        [sys.executable, "-m", "noise", *command],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    told = Counter()
    while process.poll() is None:
        for helper in _processes_of(process.pid):
            with suppress(ProcessLookupError):  # it has ended
                os.kill(helper, signal.SIGINT)
            told[helper] += 1
        time.sleep(0.02)
    assert len(told) == 3  # two that work, and what cleans up after them: none is replaced
    assert "Traceback" not in process.stderr.read()
    assert process.returncode == 1  # one is no recording


def _processes_of(pid):
    try:
        return [int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:  # it has ended
        return []


@pytest.mark.parametrize("command", ["screen", "label", "features"])
@pytest.mark.parametrize("number", ["0", "1025", "100000", "9" * 5000])
def test_more_workers_than_any_machine_starts_are_refused(tmp_path, capsys, command, number):
    assert main([command, str(tmp_path), "--workers", number]) == 2
    assert "expected a whole number from 1 to 1024" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options",
    [["--speed", "5..x"], ["--interference", "11"], ["--temperature", "a"],
     ["--support-stiffness", "-1"], ["--oscillate", "15"], ["--environment", "mars"]],
)  # fmt: skip
def test_a_screen_refuses_bad_conditions_before_it_loads_the_simulator(options):
    used = os.times()
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "noise", "screen", "PDMS", *options],
        capture_output=True, text=True, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert os.times().children_user - used.children_user < 10.0
    assert done.returncode == 2
    loaded = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert not {"numba", "scipy", "sim"} & loaded


@pytest.mark.parametrize(
    "call",
    [["label", "{pipe}.wav"], ["features", "{pipe}.wav"],
     ["render", "{pipe}.wav", "--out", "a.wav"],
     ["label", "{run}.wav", "--classifier", "{pipe}.npz"],
     ["label", "{run}.wav", "--inference", "{pipe}.npz"],
     ["simulate", "--rig", "{pipe}.toml", "--speed", "5", "--out", "a.wav"],
     ["screen", "{pipe}.toml"],
     ["frf", "{pipe}.npy"], ["review", "{pipe}.csv", "--out", "a"],
     ["review", "{pipe}.json", "--out", "a"], ["label", "{pipe}.csv", "--audacity", "a"],
     ["diagnose", "{run}.wav", "--rig", "{pipe}.toml"],
     ["open", "{pipe}.wav", "--no-browser"], ["open", "{pipe}.csv", "--no-browser"]],
)  # fmt: skip
def test_a_pipe_is_refused_by_every_command_and_not_waited_for(tmp_path, monkeypatch, capsys, call):
    import numpy as np
    import soundfile

    monkeypatch.chdir(tmp_path)
    for ending in (".wav", ".npz", ".toml", ".npy", ".csv", ".json"):
        os.mkfifo(f"pipe{ending}")
    soundfile.write("run.wav", np.full(2000, 0.1), 48_000)
    assert main([part.format(pipe="pipe", run="run") for part in call]) in (1, 2)
    assert "is a pipe, not a file" in capsys.readouterr().err
