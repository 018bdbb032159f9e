# ruff: noqa: E402, T201
"""How fast the program simulates, labels and screens; run by hand on an idle machine.

    python -m tests.benchmarks simulate
    python -m tests.benchmarks label [--minutes 60]
    python -m tests.benchmarks screen

`simulate`: a second of stick-slip by each law, with each effect and recorded. `label`: files of a
minute beside librosa's MFCC alone, in one process and in two. `screen`: a map of 10,000 conditions.
Processor seconds stand beside the clock's.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import tempfile
import time
from dataclasses import replace
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np
import soundfile

from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.cli import main
from noise.screening.design import Use, spread
from noise.screening.screen import screen
from sim.acquisition import Acquisition
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import LAWS
from sim.motion import simulate_motion
from sim.run import simulate
from sim.shaft import ConstantSpeed

RATE, MINUTE = 48_000, 60


def seconds_of(call) -> tuple[float, float]:
    """Seconds by the clock and of the processor, with processes that ended meanwhile."""

    def used() -> float:
        whose = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        return sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, whose))

    begun = time.perf_counter(), used()
    call()
    return time.perf_counter() - begun[0], used() - begun[1]


def time_simulator() -> None:
    rig = load_material_rig("fluorocarbon-thesis")
    rows = {"true stick": rig} | {f"law {n}": replace(rig, friction=LawSpec(n)) for n in LAWS}
    for name, effect in EFFECTS.items():
        if effect.contact is not None or effect.drive is not None:
            rows[f"true stick and {name}"] = replace(rig, effects=(LawSpec(name),))
    calls = {
        name: lambda rig=rig: simulate_motion(
            rig, ConstantSpeed(1.0), interference=0.279e-3, support_stiffness=3745.0, seconds=1.0,
            rate=30e3, effects=activated(rig.effects, EFFECTS),
        )
        for name, rig in rows.items()
    }  # fmt: skip
    for name in ("fluorocarbon-thesis", "fluorocarbon"):
        calls[f"{name}, recorded"] = lambda name=name: simulate(load_material_rig(name), 1.0)
    for name, call in calls.items():
        best = min([seconds_of(call)[1] for _ in range(6)][1:])  # the first compiles and loads
        print(f"{name:42}{1e3 * best:10.2f} ms")


def write_minutes(folder: Path, minutes: int) -> None:
    rig, rng, sounds = load_material_rig("fluorocarbon"), np.random.default_rng(0), []
    for speed, interference, stiffness in ((1.0, 0.381e-3, 2214.0), (10.0, 0.279e-3, 3745.0)):
        pressure = simulate(
            rig, speed, interference=interference, support_stiffness=stiffness, seconds=10.0,
            acquisition=Acquisition(rate=float(RATE)),
        ).recording["pressure"]  # fmt: skip
        sounds.append(0.2 * pressure / np.abs(pressure).max())
    for number in range(minutes):
        hiss = 0.01 * rng.standard_normal(MINUTE * RATE)
        noises = [rng.integers(2) * sounds[rng.integers(2)] for _ in range(MINUTE // 10)]
        track = np.concatenate(noises) + hiss
        soundfile.write(folder / f"{number:03d}.flac", track.clip(-1.0, 1.0), RATE)


def mfcc(path: Path) -> float:
    import librosa

    samples, rate = librosa.load(path, sr=None, dtype=np.float32)
    return float(librosa.feature.mfcc(y=samples, sr=rate).mean())


def mfcc_of_all(folder: Path, workers: int) -> None:
    from joblib import Parallel, delayed
    from joblib.externals.loky import get_reusable_executor

    Parallel(n_jobs=workers)(delayed(mfcc)(path) for path in sorted(folder.glob("*.flac")))
    if workers > 1:  # whose time is counted once they have ended
        get_reusable_executor().shutdown(wait=True)


def time_labels(minutes: int) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_minutes(folder, minutes)
        call = ["label", name, "--fresh", "--out", str(folder / "labels.csv"), "--workers"]
        for n in (1, 2):
            for what, task in (
                ("label", lambda n=n: main([*call, str(n)])),
                ("MFCC", lambda n=n: mfcc_of_all(folder, n)),
            ):
                clock, processor = seconds_of(task)
                print(f"{what:6} {n} workers: {clock:7.1f} s, {processor:7.1f} s of processor, "
                      f"{MINUTE * minutes / clock:6.0f} times real time", flush=True)  # fmt: skip


def time_screen() -> None:
    screen(["fluorocarbon"], Use(speed=(5.0,), interference=(0.279e-3,)))  # compiled and loaded
    use = Use(spread(0.25, 13.0, 101), spread(0.178e-3, 0.381e-3, 33), (2214.0, 3745.0, math.inf))
    clock, processor = seconds_of(lambda: screen(["fluorocarbon"], use))
    print(f"9,999 conditions: {clock:.1f} s, {processor:.1f} s of processor")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["simulate", "label", "screen"])
    parser.add_argument("--minutes", type=int, default=60)
    options = parser.parse_args()
    if options.what == "simulate":
        time_simulator()
    elif options.what == "label":
        time_labels(options.minutes)
    else:
        time_screen()
