"""Real sounds that the classifier learns beside simulated ones; they say what it takes for a noise.

Stored are the features of their windows, not the sounds (``data/real_sounds.npz``), and their
sources and licences, none of which forbids it: CC0, CC BY and MIT. After a change of the features
they are taken again from the sounds themselves, a folder of them with a table ``sources.csv`` of
the columns ``file, class, source, licence``::

    python -m noise.training.classifier.real_sounds FOLDER
"""

from __future__ import annotations

import csv
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.blocks import RecordingBlocks
from noise.base.model_file import ModelKind, load_model, save_model
from noise.labels.windows import FEATURE_NAMES, describe
from noise.recordings import read_recording
from noise.training.classifier.own_samples import OwnSample

_KIND = ModelKind(
    "set of real sounds",
    1,
    "python -m noise.training.classifier.real_sounds FOLDER, not into",
    ("noise.training.classifier", "real_sounds.npz"),
)

_LABELS = {"creak": "creak", "squawk": "squawk", "squeal": "squeal", "background": "unknown"}
"""What a class is called; others hang on a bound of the definition."""

_FRICTION = ("hacksaw", "hand_saw")
"""Files called so are friction, whatever their class: neither a noise nor a stranger."""

_CLEAN = re.compile(r"(CC0|CC BY [34]|CC-BY |MIT)")
"""How a licence begins that lets anyone learn from a sound and pass on what was learned."""

_WEIGHT_OF_NOISE, _WEIGHT_OF_OTHERS = 15.0, 4.0
"""Simulated samples that a sound counts as [-], by how sources left out are named."""

_QUIET_DB = 30.0
"""Windows that lie so far below a sound's loudest are pauses."""


@dataclass(frozen=True, eq=False)
class RealSounds:
    """Features of real sounds.

    Parameters
    ----------
    samples : tuple of OwnSample
        Each a whole sound, by the name of its source.
    kinds : tuple of str
        Of the sounds, as their files are called.
    licences : mapping of str to str
        By source.
    """

    samples: tuple[OwnSample, ...]
    kinds: tuple[str, ...]
    licences: Mapping[str, str]


def load_real_sounds() -> RealSounds:
    """Load those that are stored with the program.

    Examples
    --------
    >>> sorted({sample.label for sample in load_real_sounds().samples})
    ['creak', 'squeal', 'unknown']
    """
    return load_model(None, _KIND, _built)


def describe_folder(folder: Path) -> RealSounds:
    """Describe the sounds of a folder that have a clean licence."""
    samples, kinds, licences = [], [], {}
    with (folder / "sources.csv").open(encoding="utf-8", newline="") as table:
        rows = [row for row in csv.DictReader(table) if _CLEAN.match(row["licence"])]
    for row in rows:
        label = _LABELS.get(row["class"])
        if label is None or any(word in row["file"] for word in _FRICTION):
            continue
        blocks = RecordingBlocks.of(read_recording(folder / row["file"]))
        found = describe(blocks.track(0))
        loud = found.level > found.level.max() - _QUIET_DB
        source = _source(row["source"], row["licence"])
        samples.append(_sample(found.features[loud], label, source))
        kinds.append(Path(row["file"]).stem)
        licences[source] = row["licence"]
    return RealSounds(tuple(samples), tuple(kinds), licences)


def _source(said: str, licence: str) -> str:
    """Return who recorded a sound, as far as it is known: the same name, the same source."""
    repository, _, file = said.partition(":")
    stem = Path(file).stem
    if "ESC-10" in repository:  # 5-198411-F: fold, recording, cut
        return f"{repository.partition('@')[0]}:{stem.split('-')[1]}"
    if "(" in licence and "CC0 per file" not in licence and "sound origin" not in licence:
        return f"{repository.partition('@')[0]}:{licence.partition('(')[2].rstrip(')')}"
    if "OpenSFX" in repository or "SNU" in repository:
        return f"{repository.partition('@')[0]}:{stem.partition(' ')[0]}"
    return repository


def _sample(features: NDArray[np.float32], label: str, source: str) -> OwnSample:
    noise = label not in ("none", "unknown")
    return OwnSample(features, label, source, _WEIGHT_OF_NOISE if noise else _WEIGHT_OF_OTHERS)


def _store(found: RealSounds, path: Path) -> None:
    header = {
        "feature_names": FEATURE_NAMES,
        "labels": [s.label for s in found.samples],
        "sources": [s.name for s in found.samples],
        "kinds": found.kinds,
        "licences": found.licences,
        "card": {},
    }
    features = np.concatenate([s.features for s in found.samples])
    arrays = {
        "features": features[:, _COLUMNS].astype(np.float16),
        "counts": np.array([len(s.features) for s in found.samples]),
    }
    save_model(path, _KIND, header, arrays)


_COLUMNS = [i for i, name in enumerate(FEATURE_NAMES) if name.startswith("pressure_")]


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> RealSounds:
    if tuple(header["feature_names"]) != FEATURE_NAMES:
        raise ValueError("its features are others")
    x = np.full((len(arrays["features"]), len(FEATURE_NAMES)), np.nan, dtype=np.float32)
    x[:, _COLUMNS] = arrays["features"]
    each = np.split(x, np.cumsum(arrays["counts"])[:-1])
    told = zip(each, header["labels"], header["sources"], strict=True)
    return RealSounds(
        tuple(_sample(*one) for one in told), tuple(header["kinds"]), header["licences"]
    )


if __name__ == "__main__":
    target = resources.files("noise.training.classifier") / "data" / "real_sounds.npz"
    _store(describe_folder(Path(sys.argv[1])), Path(str(target)))
