"""What segments sound like to the classifier, described by a process beside the server.

It is asked on its standard input and answers on its standard output, a line of JSON each, and ends
with the server, however that ends.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from contextlib import suppress
from threading import Lock, Thread
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray

    Wanted = tuple[str, str, float, float]

__all__ = ["SegmentFeatures", "answer_lines", "mean_features"]

_LONGEST = 10.0
"""Of a longer segment its middle stands for it [s]."""

_NICE = 15
"""Whoever listens, and labelling, go first."""


class SegmentFeatures:
    """Mean features of segments, as they become known."""

    def __init__(self) -> None:
        self._asking, self._telling = Lock(), Lock()  # two, or a full pipe would stop both
        self._process: subprocess.Popen[str] | None = None
        self._asked: set[Wanted] = set()
        self._known: dict[Wanted, NDArray[np.float64]] = {}

    def ask(self, wanted: Iterable[Wanted]) -> None:
        """Ask for segments, by path, channel, start [s] and end [s]; those asked for are kept."""
        with self._asking:
            new = [one for one in wanted if one not in self._asked]
            if not new:
                return
            self._asked.update(new)
            process = self._running()
            assert process.stdin is not None
            with suppress(OSError):  # it has ended: what it has not said stays unknown
                process.stdin.writelines(json.dumps(one) + "\n" for one in new)
                process.stdin.flush()

    def known(self) -> dict[Wanted, NDArray[np.float64]]:
        """Return what is known so far: features of each, shape (n_features,), NaN where missing."""
        with self._telling:
            return dict(self._known)

    def stop(self) -> None:
        """End the process."""
        process = self._process
        if process is not None and process.poll() is None:
            process.kill()
            process.wait()

    def _running(self) -> subprocess.Popen[str]:
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                encoding="utf-8",
                start_new_session=True,  # a key in the terminal is for the server
            )
            if hasattr(os, "setpriority"):
                with suppress(OSError):
                    os.setpriority(os.PRIO_PROCESS, self._process.pid, _NICE)
            Thread(target=self._listen, args=(self._process,), daemon=True).start()
        return self._process

    def _listen(self, process: subprocess.Popen[str]) -> None:
        assert process.stdout is not None
        for line in process.stdout:
            with suppress(ValueError):
                (path, channel, start, end), features = json.loads(line)
                with self._telling:
                    self._known[path, channel, start, end] = np.array(features, dtype=np.float64)


def mean_features(path: Path, channel: str, start: float, end: float) -> NDArray[np.float64]:
    """Return the mean of the features of a segment's windows.

    Parameters
    ----------
    path : Path
    channel : str
        ``all``, or a track counted from 1.
    start, end : float
        [s]

    Returns
    -------
    ndarray, shape (n_features,)
        By `noise.labels.windows.FEATURE_NAMES` [unit of each feature]; NaN where missing.

    Raises
    ------
    RecordingError
        The recording cannot be read.
    """
    from noise.labels.windows import FEATURE_NAMES, can_be_described, describe
    from noise.recordings import read_recording
    from noise.recordings.blocks import RecordingBlocks, open_blocks

    with open_blocks(path) as opened:
        blocks = opened or RecordingBlocks.of(read_recording(path))
        if channel != "all":
            blocks = blocks.track(int(channel) - 1)
        middle, half = 0.5 * (start + end), 0.5 * min(end - start, _LONGEST)
        first = max(0, round((middle - half) * blocks.rate))
        last = min(round((middle + half) * blocks.rate), blocks.n_samples)
        part = RecordingBlocks.of(blocks.cut(first, last))
        if last - first < 2 or not can_be_described(part):
            return np.full(len(FEATURE_NAMES), np.nan)
        features = describe(part).features.astype(np.float64)
    there = np.isfinite(features)
    total = np.where(there, features, 0.0).sum(axis=0)
    number = there.sum(axis=0)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)


def answer_lines(lines: Iterable[str]) -> Iterable[str]:
    """Answer each line that asks, whatever is wrong with its recording."""
    from pathlib import Path

    for line in lines:
        path, channel, start, end = json.loads(line)
        try:
            features = mean_features(Path(path), channel, start, end).tolist()
        except Exception:  # nothing is known of it then
            continue
        said = [value if np.isfinite(value) else None for value in features]
        yield json.dumps([[path, channel, start, end], said])


if __name__ == "__main__":
    for answer in answer_lines(sys.stdin):
        sys.stdout.write(f"{answer}\n")
        sys.stdout.flush()
