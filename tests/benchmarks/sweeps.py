# ruff: noqa: T201
"""How fast sweeps and long runs are, beside a loop over single runs.

Run by hand: ``python tests/benchmarks/sweeps.py [SECONDS]``; the second part writes a recording of
so many simulated seconds (default 60) to a temporary folder and prints the process's peak memory.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from models.rig_file import load_material_rig
from noise.long_run import write_run
from sim.analysis.sweep import motion_features, sweep as run_sweep
from sim.blocks import simulate_blocks
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

RIG = load_material_rig("fluorocarbon-thesis")
RUNS = 10_000


def main() -> None:
    rng = np.random.default_rng(1)
    speed = rng.uniform(0.5, 15.0, RUNS)
    interference = rng.uniform(0.178e-3, 0.381e-3, RUNS)
    stiffness = rng.uniform(2000.0, 4000.0, RUNS)

    def sweep(workers: int) -> None:
        start, used = time.perf_counter(), time.process_time()
        run_sweep(RIG, speed, interference, stiffness, seconds=0.1, workers=workers)
        passed, used = time.perf_counter() - start, time.process_time() - used
        name = f"{RUNS} runs of 0.1 s, workers {workers}"
        print(f"{name:40}{passed:8.2f} s{used:8.2f} s of processor time")

    sweep(1)
    for workers in (1, 2, -1, 1, 2, -1):
        sweep(workers)
    start = time.perf_counter()
    for i in range(RUNS // 20):
        motion = simulate_motion(
            RIG, ConstantSpeed(speed[i]), interference=interference[i],
            support_stiffness=stiffness[i], seconds=0.1, rate=30e3,
        )  # fmt: skip
        motion_features(motion)
    print(f"{'one by one (a twentieth, times 20)':40}{20 * (time.perf_counter() - start):8.2f} s")
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        path = write_run(Path(folder) / "long", simulate_blocks(RIG, 2.5, seconds=seconds))
        size = path.stat().st_size / 1e6
    passed = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{seconds:g} s to a file of {size:.0f} MB: {passed:.1f} s, peak memory {peak:.0f} MB")


if __name__ == "__main__":
    main()
