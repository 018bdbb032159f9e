"""Of a command that is killed no process is left that worked for it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

SCRIPT = """
import os, sys, time
from joblib import Parallel, delayed
from noise.base.processes import ending_with_parent
def rest(seconds):
    time.sleep(seconds)
    return os.getpid()
def both(seconds, n):
    return set(Parallel(n_jobs=2)(delayed(ending_with_parent(rest))(seconds) for _ in range(n)))
while len(both(0.05, 8)) < 2:  # one may have done it all while the other was loaded
    pass
print("ready", flush=True)
both(float(sys.argv[1]), 2)
time.sleep(600.0)
"""


@pytest.mark.skipif(os.name == "nt", reason="tells no process that another one is gone")
@pytest.mark.parametrize("at_work", [0.0, 600.0])
def test_processes_end_with_the_one_that_they_work_for(at_work):
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(at_work)], stdout=subprocess.PIPE, cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert process.stdout.readline() == b"ready\n"
    process.kill()
    # They write to where it wrote, which ends when the last of them does.
    process.communicate(timeout=30.0)
