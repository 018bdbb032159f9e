"""Whether a case's files give its class away otherwise than by what was recorded.

What is looked at: names and their order, sizes, lengths, rates, channels and their order, bytes of
the headers, every number of sidecars and rig file, sizes of the responses. Levels are looked at as
well where asked for: mean, rms and peak of every channel. Samples are calibrated, so their levels
are what effects act on, and tell of them as any sound does; levels must tell nothing once the
effects are off, that is, of noise, gains and drift that were drawn for the class. A forest
guesses the class by five-fold cross-validation; chance is the same with the classes shuffled.
"""

from __future__ import annotations

import json
import re
import struct
import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["Leak", "leak", "seen_of"]


@dataclass(frozen=True)
class Leak:
    """Share of classes guessed, the same by chance, and the probability of as much by chance."""

    share: float
    by_chance: float
    p_value: float


def _numbers(value: object) -> list[float]:
    if isinstance(value, dict):
        return [x for key in sorted(value) for x in _numbers(value[key])]
    if isinstance(value, list):
        return [x for item in value for x in _numbers(item)]
    if isinstance(value, str):
        return [float(len(value)), float(sum(value.encode()))]
    return [0.0 if value is None else float(value)]


def _of_many(rows: list[list[float]]) -> list[float]:
    """First, last, mean, spread and trend of some files' numbers."""
    table = np.array(rows, dtype=float)
    order = np.linspace(-1.0, 1.0, len(table))
    return np.concatenate([
        table[0], table[-1], table.mean(axis=0), table.std(axis=0), order @ table,
    ]).tolist()  # fmt: skip


def _header(path: Path) -> list[float]:
    """Return rate, channels, bits, bytes and all that stands before the samples."""
    head = path.read_bytes()[:256]
    at = head.index(b"data")
    form, channels, rate, _, _, bits = struct.unpack("<HHIIHH", head[20:36])
    return [form, channels, rate, bits, path.stat().st_size, at, float(sum(head[12:at]))]


def _levels(path: Path) -> list[float]:
    """Return mean, rms and peak of each channel."""
    head = path.read_bytes()
    channels, at = struct.unpack("<H", head[22:24])[0], head.index(b"data") + 8
    x = np.frombuffer(head, "<f4", offset=at).reshape(-1, channels).astype(float)
    rest = x - x.mean(axis=0)
    numbers = x.mean(axis=0), np.log(rest.std(axis=0) + 1e-9), np.log(np.abs(x).max(axis=0) + 1e-9)
    return np.concatenate(numbers).tolist()


def seen_of(case: Path, *, levels: bool = False) -> list[float]:
    """Return everything of a case's folder that is no sound, as numbers; levels where asked for."""
    paths = sorted(case.iterdir())
    place = [float(x) for x in re.findall(r"\d+", case.name)] or [0.0]
    suffixes = [p.suffix for p in paths]
    counts = [float(suffixes.count(s)) for s in (".wav", ".json", ".npz", ".toml")]
    recordings = []
    for wav in (p for p in paths if p.suffix == ".wav"):
        sidecar = json.loads(wav.with_suffix(".json").read_text(encoding="utf-8"))
        said = _numbers(sidecar)
        level = _levels(wav) if levels else []
        size = wav.with_suffix(".json").stat().st_size
        recordings.append([*_header(wav), *said, size, *level])
    responses = [[p.stat().st_size] for p in paths if p.suffix == ".npz"] or [[0.0]]
    rig = tomllib.loads(case.joinpath("rig.toml").read_text(encoding="utf-8"))
    rig.pop("measured_response", None)
    return [
        place[0], float(len(paths)), *counts, *_numbers(rig),
        case.joinpath("rig.toml").stat().st_size, *_of_many(recordings), *_of_many(responses),
        float(sum(sum(p.name.encode()) for p in paths)),
    ]  # fmt: skip


def leak(cases: list[list[float]], classes: list[str], shuffles: int = 100, seed: int = 0) -> Leak:
    """Guess classes from what is seen of the cases, and from the same shuffled.

    Where rig files or recordings hold more in some cases, the rest of the others counts as 0.
    """
    from sklearn.ensemble import ExtraTreesClassifier
    from sklearn.model_selection import StratifiedKFold, permutation_test_score

    width = max(map(len, cases))
    table = np.array([[*row, *[0.0] * (width - len(row))] for row in cases])
    share, chance, p = permutation_test_score(
        ExtraTreesClassifier(30, min_samples_leaf=2, max_features=0.5, random_state=seed),
        table[:, table.std(axis=0) > 0.0], np.array(classes),
        n_permutations=shuffles, random_state=seed,
        cv=StratifiedKFold(5, shuffle=True, random_state=seed), scoring="balanced_accuracy",
    )  # fmt: skip
    return Leak(float(share), float(chance.mean()), float(p))
