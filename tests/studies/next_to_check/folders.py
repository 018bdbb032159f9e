"""Folders of other bodies' sounds with what each truly is, and how they are parted."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from features.windows.table import HOP, LENGTH
from models.recording import Channel, Recording
from noise.base.label_names import LABELS
from noise.base.tables import write_table
from noise.labels.labelling import COLUMNS
from noise.labels.table import HUMAN
from noise.labels.windows import Described, describe
from noise.recordings import read_recording, write_recording
from noise.recordings.blocks import RecordingBlocks
from noise.training.classifier.augmentation.recorder import augmented
from noise.training.classifier.own_recordings import read_labelled
from noise.training.classifier.own_samples import OwnSample, own_samples
from noise.training.classifier.real_sounds import _FRICTION, _LABELS, _source
from noise.training.classifier.samples import draw_from, swelling

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "LEFT_OUT",
    "Clip",
    "drawn_clips",
    "halves",
    "known_and_folder",
    "real_clips",
    "variants",
]

LEFT_OUT = (
    "friction:door_creak", "friction:hinge_creak", "friction:chalk_squeal", "friction:tyre_squeal",
    "friction:chatter_squawk",
    *(
        f"background:{kind}"
        for kind in (
            "dog", "rooster", "baby", "laughing", "birds", "fire", "rain", "clock_tick",
            "footsteps", "glass", "helicopter", "chainsaw", "siren", "music",
        )
    ),
)  # fmt: skip
"""Kinds that sounds are drawn of, to choose an order by; at the start none of them is known."""

QUIET_DB = 30.0
"""What lies so far below a recording's loudest is a pause, of which a person says nothing."""


@dataclass(frozen=True, eq=False)
class Clip:
    """A recording that is one sound."""

    path: Path
    label: str
    source: str

    @cached_property
    def blocks(self) -> RecordingBlocks:
        return RecordingBlocks.of(read_recording(self.path)).track(0)

    @cached_property
    def described(self) -> Described:
        return describe(self.blocks)

    @cached_property
    def correction(self) -> list[OwnSample]:
        """What ``train --add`` learns when a person has said what the recording is."""
        table = self.path.with_name(f"{self.path.stem}.said.csv")
        rows = [
            dict.fromkeys(COLUMNS)
            | {"file": str(self.path.resolve()), "channel": "all", "label": self.label}
            | {"start_s": start, "end_s": end, "label_source": HUMAN}
            for start, end in self._stretches()
        ]
        write_table(table, COLUMNS, rows)
        windows, _ = read_labelled(table)
        table.unlink()
        return own_samples(windows)[0]

    def __getstate__(self):
        return {name: value for name, value in vars(self).items() if name != "blocks"}

    @property
    def loud(self):
        """Whether something sounds in each window."""
        return self.described.level > self.described.level.max() - QUIET_DB

    def _stretches(self):
        """Yield from when to when something sounds [s]."""
        edges = np.flatnonzero(np.diff([False, *self.loud, False])).reshape(-1, 2)
        duration = self.blocks.n_samples / self.blocks.rate
        for first, last in edges.tolist():
            yield first * HOP, min((last - 1) * HOP + LENGTH, duration)

    def right(self, label: str) -> bool:
        """Whether that is what it is; what is no noise may as well be called nothing."""
        return label == self.label or (self.label == "unknown" and label == "none")


def real_clips(folder: Path, work: Path) -> list[Clip]:
    """Return the recordings of the world; those whose class hangs on a bound are left out."""
    clips = []
    with (folder / "sources.csv").open(encoding="utf-8", newline="") as table:
        for row in csv.DictReader(table):
            label = _LABELS.get(row["class"])
            if label is None or any(word in row["file"] for word in _FRICTION):
                continue
            there = work / row["file"].replace("/", "_")
            if not there.is_file():
                there.write_bytes((folder / row["file"]).read_bytes())
            clips.append(Clip(there, label, _source(row["source"], row["licence"])))
    return clips


def known_and_folder(clips: list[Clip], seed: int = 0) -> tuple[list[Clip], list[Clip]]:
    """Part recordings by source: backgrounds known from the start, and what is in the folder.

    A third of the sources of backgrounds is known, of the noises none.
    """
    sources = sorted({clip.source for clip in clips if clip.label == "unknown"})
    np.random.default_rng([seed, 3]).shuffle(sources)
    known = set(sources[::3])
    return [c for c in clips if c.source in known], [c for c in clips if c.source not in known]


def halves(clips: list[Clip], seed: int) -> tuple[list[Clip], list[Clip]]:
    """Part a folder by source: what is corrected, and what is held out; each label over both."""
    rng = np.random.default_rng([seed, 5])
    held = {}
    for label in LABELS:
        sources = sorted({clip.source for clip in clips if clip.label == label} - set(held))
        rng.shuffle(sources)
        turn = int(rng.integers(2))
        held |= {source: bool((i + turn) % 2) for i, source in enumerate(sources)}
    return [c for c in clips if not held[c.source]], [c for c in clips if held[c.source]]


def variants(clips: list[Clip], n: int, work: Path) -> list[Clip]:
    """Return each noise as recorded `n` times more, elsewhere and by others."""
    found = []
    for clip in clips:
        if clip.label == "unknown":
            continue
        samples = clip.blocks.read(0, clip.blocks.n_samples)[0]
        for i in range(n):
            there = work / f"{clip.path.stem}.variant{i}.wav"
            if not there.is_file():
                seed = [i, *clip.path.stem.encode()]
                again = augmented(samples, clip.blocks.rate, np.random.default_rng(seed))
                _write(there, again.samples, float(again.rate))
            found.append(Clip(there, clip.label, clip.source))
    return found


def drawn_clips(work: Path, n_noises: int = 16, n_others: int = 8) -> list[Clip]:
    """Draw sounds of kinds that are left out at the start, each of a body of its own."""
    clips = []
    for kind in LEFT_OUT:
        group, _, name = kind.partition(":")
        label = name.rpartition("_")[2] if group == "friction" else "unknown"
        for i in range(n_noises if group == "friction" else n_others):
            there = work / f"{group}_{name}_{i}.wav"
            if not there.is_file():
                rng = np.random.default_rng([i, 7, *kind.encode()])
                drawn = swelling(draw_from(kind, rng), rng)
                _write(there, drawn.recording.samples[0], drawn.recording.rate)
            clips.append(Clip(there, label, there.stem))
    return clips


def _write(path: Path, samples, rate: float) -> None:
    peak = float(np.abs(samples).max()) or 1.0
    run = Recording(0.9 * samples[None] / peak, rate, (Channel("pressure"),), calibrated=False)
    write_recording(path, run)
