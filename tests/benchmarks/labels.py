# ruff: noqa: E402, T201
"""Labels of an hour of sound, beside librosa's MFCC alone on the same files.

    python -m tests.benchmarks.labels [--minutes 60]

Both read the same FLAC files of one minute, simulated noises and noise in turn, at 48 kHz; the
MFCC with librosa's own defaults at the file's rate, in as many processes. Told are the time on the
clock, the processor's time, which other work on the machine does not stretch as much, and seconds
of sound a second; all with what starting takes, once for each worker.
"""

from __future__ import annotations

import argparse
import os
import resource
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np
import soundfile

from models.rig_file import load_material_rig
from noise.cli import main
from noise.training.draws import coloured_noise
from sim.acquisition import Acquisition
from sim.run import simulate

if TYPE_CHECKING:
    from collections.abc import Callable

RATE = 48_000
MINUTE = 60


def write_files(folder: Path, minutes: int) -> None:
    rig = load_material_rig("fluorocarbon")
    rng = np.random.default_rng(0)
    sounds = []
    for speed, interference, stiffness in ((1.0, 0.381e-3, 2214.0), (10.0, 0.279e-3, 3745.0)):
        run = simulate(
            rig,
            speed,
            interference=interference,
            support_stiffness=stiffness,
            seconds=10.0,
            acquisition=Acquisition(rate=float(RATE)),
        )
        pressure = run.recording["pressure"]
        sounds.append(0.2 * pressure / np.abs(pressure).max())
    for number in range(minutes):
        parts = [
            sounds[int(rng.integers(2))]
            if rng.random() < 0.5
            else 0.02 * coloured_noise(10 * RATE, rng.uniform(0.0, 2.0), rng)
            for _ in range(MINUTE // 10)
        ]
        track = np.concatenate(parts) + 1e-3 * rng.standard_normal(MINUTE * RATE)
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


def label_all(folder: Path, workers: int) -> None:
    with tempfile.TemporaryDirectory() as out:
        table = Path(out) / "labels.csv"
        code = main(["label", str(folder), "--out", str(table), "--workers", str(workers)])
    if code != 0:
        raise SystemExit(code)


def processor_time() -> float:
    usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in usage)


def measure(what: str, task: Callable[[Path, int], None], folder: Path, workers: int) -> None:
    seconds = MINUTE * len(list(folder.glob("*.flac")))
    before, start = processor_time(), time.perf_counter()
    task(folder, workers)
    elapsed, used = time.perf_counter() - start, processor_time() - before
    print(
        f"{what:6s} {workers} workers: {elapsed:7.1f} s on the clock, {used:7.1f} s of processor, "
        f"{seconds / elapsed:6.0f} times real time, {1e3 * elapsed * workers / seconds:.2f} ms a "
        f"second of sound and core",
        flush=True,
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=int, default=60)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        write_files(Path(name), options.minutes)
        for count in (1, 2):
            measure("label", label_all, Path(name), count)
            measure("MFCC", mfcc_of_all, Path(name), count)
