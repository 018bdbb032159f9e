"""Work and recordings for tests of batches, in a module that other processes can import."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import soundfile

from models.errors import RecordingError
from noise.batch.work import Job

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True)
class Counting:
    """Logs what it is asked; dies at `deadly`, the first time at `fragile`, refuses `bad`."""

    log: Path
    factor: float = 1.0

    doing = "counting"
    columns = ("file", "value", "error")

    def prepare(self) -> None:
        """Nothing to load."""

    def identity(self) -> dict[str, float]:
        return {"factor": self.factor}

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        with self.log.open("a") as file:
            file.write(name + "\n")
        asked = self.log.read_text().split()
        if "deadly" in name or ("fragile" in name and asked.count(name) == 1):
            os.kill(os.getpid(), signal.SIGKILL)
        if "slow" in name:
            time.sleep(0.2)
        if "bad" in name:
            raise RecordingError(f"{path}: is bad")
        values = (0.1 + 0.2, self.factor / 3.0)
        return [{"file": name, "value": value} for value in values], True


def make_jobs(folder, names):
    jobs = []
    for index, name in enumerate(names):
        path = folder / f"{name}.wav"
        path.write_bytes(b"sound")
        jobs.append(Job(index, path, path.name))
    return jobs


def in_order(found):
    return [done for _, done in sorted(found, key=lambda pair: pair[0].index)]


RATE = 16_000


def make_recordings(folder, number, broken, seconds):
    """Tones, hums and hisses in nested folders and several formats; `broken` of them no sound."""
    rng = np.random.default_rng(0)
    instants = np.arange(round(seconds * RATE)) / RATE
    for i in range(number):
        ending = ("wav", "flac", "ogg", "aiff")[i % 4]
        path = folder / f"day{i % 7}" / f"shift{i % 3}" / f"run{i:04}.{ending}"
        path.parent.mkdir(parents=True, exist_ok=True)
        if i % (number // broken) == 1:
            path.write_bytes(rng.bytes(int(rng.integers(0, 4000))))
            continue
        tone = np.sin(2 * np.pi * rng.uniform(100.0, 4000.0) * instants)
        sound = 0.3 * tone * (i % 3 > 0) + 10 ** rng.uniform(-4, -1) * rng.standard_normal(
            instants.size
        )
        soundfile.write(path, np.clip(sound, -1, 1), RATE)
