"""Training of the classifier on simulation, synthetic background sounds and some real sounds.

Labels of simulated samples follow from physics (`noise.training.classifier.samples`); samples with
ambiguous labels are not used. Calibration and scores are by left-out sources
(`noise.training.classifier.cross_fitting`).

Of real sounds, the features of their windows are stored (``data/real_sounds.npz``), with sources
and licences: CC0, CC BY and MIT. After a change of the features they are computed again from a
folder of sounds with a table ``sources.csv`` with the columns ``file, class, source, licence``::

    python -m noise.training.classifier.fit FOLDER
"""

from __future__ import annotations

import csv
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from models.errors import ParameterError
from models.recording import RecordingBlocks
from noise.base.arrays import Array, Rng
from noise.base.labels import LABELS
from noise.base.model_file import ModelKind, load_model, save_model
from noise.classifier.model import Classifier
from noise.labels.segmentation import NOISES
from noise.labels.windows import FEATURE_NAMES, window_features
from noise.recordings import read_recording
from noise.training.classifier.cross_fitting import cross_fitted, left_out_scores, named_as
from noise.training.classifier.own_recordings import own_card
from noise.training.classifier.recorder import augmented
from noise.training.classifier.samples import (
    QUIET_DB,
    Drawn,
    Sample,
    described,
    draw_sample,
    swelling,
)
from noise.training.draws import log_uniform, low_pass

N_TRAINING = 4300
"""Number of training samples."""

_KIND = ModelKind(
    "set of real sounds",
    2,
    "python -m noise.training.classifier.fit FOLDER, not into",
    ("noise.training.classifier", "real_sounds.npz"),
)

_CLASSES = {"bowed": "squawk", "background": "unknown", "background: vehicle": "unknown"}
"""Labels of classes besides the three noises; others are ambiguous."""

_VARIATIONS = 20
"""Number of variations of each noise: parts at other speeds, in other places and recorders."""

_RATE = 48_000.0
"""Sampling rate of variations [Hz]."""

_COLUMNS = [i for i, name in enumerate(FEATURE_NAMES) if name.startswith("pressure_")]
"""Columns of the features of real sounds."""


RealSounds = tuple[tuple[Sample, ...], Mapping[str, str]]
"""Samples of whole sounds and of variations, and licences by source."""


def load_real_sounds() -> RealSounds:
    """Load the shipped real sounds.

    Examples
    --------
    >>> sorted({sample.label for sample in load_real_sounds()[0]})
    ['creak', 'squawk', 'squeal', 'unknown']
    """
    return load_model(None, _KIND, _built)


def describe_folder(folder: Path) -> RealSounds:
    """Return the features of the sounds of a folder with a suitable licence."""
    samples, licences = [], {}
    with (folder / "sources.csv").open(encoding="utf-8", newline="") as table:
        # Licences that permit training and distribution of the result.
        free = re.compile(r"(skid\.ogg )?(CC0|CC BY [34]|CC-BY |MIT)")
        rows = [row for row in csv.DictReader(table) if free.match(row["licence"])]
    for number, row in enumerate(rows):
        noise = row["class"] in LABELS[:NOISES]
        label = row["class"] if noise else _CLASSES.get(row["class"])
        # The friction of saws is neither a noise nor a background.
        if label is None or "hacksaw" in row["file"] or "hand_saw" in row["file"]:
            continue
        recording = read_recording(folder / row["file"])
        windows = window_features(RecordingBlocks.of(recording).track(0))
        loud = windows.level > windows.level.max() - QUIET_DB
        source, kind = _source(row["source"], row["licence"]), Path(row["file"]).stem
        samples.append(_sample(windows.features[loud], label, source, kind))
        licences[source] = row["licence"]
        if label != "unknown":
            rng = np.random.default_rng([number, 3])
            for _ in range(_VARIATIONS):
                features = described(_varied(recording.samples[0], recording.rate, rng)).features
                samples.append(_sample(features, label, source, kind, varied=True))
    return tuple(samples), licences


def _varied(sound: Array, rate: float, rng: Rng) -> Drawn:
    """Return a random variation of a loud part of a sound."""
    n = min(sound.size, round(log_uniform(0.15, 2.5, rng) * rate))
    loudest = np.abs(sound).max()
    parts = [sound[first : first + n] for first in rng.integers(0, sound.size - n + 1, 10)]
    part = next((one for one in parts if np.abs(one).max() > 0.5 * loudest), parts[-1])
    step = log_uniform(0.78, 1.28, rng) * rate / _RATE
    if step > 1.0:  # against aliasing
        part = low_pass(part, 0.45 * _RATE, rate)
    part = np.interp(np.arange(0.0, part.size - 1.0, step), np.arange(part.size), part)
    fade = min(round(0.005 * _RATE), part.size // 4)
    ramp = np.linspace(0.0, 1.0, fade)
    part[:fade] *= ramp
    part[part.size - fade :] *= ramp[::-1]
    before, after = (rng.uniform(0.0, 0.7, 2) * _RATE).astype(int) if rng.random() < 0.5 else (0, 0)
    span = (before / _RATE, (before + part.size) / _RATE)
    recording, span = augmented(np.pad(part, (before, after)), _RATE, rng, span=span)
    return swelling(Drawn(recording, "", "", span), rng)


def _source(name: str, licence: str) -> str:
    """Return the name of the source of a sound: its author, as far as known."""
    repository, _, file = name.partition(":")
    stem = Path(file).stem
    if "ESC-10" in repository:  # 5-198411-F: fold, recording, cut
        return f"{repository.partition('@')[0]}:{stem.split('-')[1]}"
    if "(" in licence and "CC0 per file" not in licence and "sound origin" not in licence:
        return f"{repository.partition('@')[0]}:{licence.partition('(')[2].rstrip(')')}"
    if "OpenSFX" in repository or "SNU" in repository:
        return f"{repository.partition('@')[0]}:{stem.partition(' ')[0]}"
    return repository


def _sample(
    features: NDArray[np.float32], label: str, source: str, kind: str, *, varied: bool = False
) -> Sample:
    # Relative to a simulated sample; chosen on left-out sources
    weight = (4.0 if label == "unknown" else 15.0) / (_VARIATIONS if varied else 1.0)
    return Sample(features, label, source, weight, kind, real=True, varied=varied)


def _store(sounds: RealSounds, path: Path) -> None:
    samples, licences = sounds
    header = {
        "feature_names": FEATURE_NAMES,
        "labels": [s.label for s in samples],
        "sources": [s.source for s in samples],
        "kinds": [s.kind for s in samples],
        "varied": [s.varied for s in samples],
        "licences": licences,
        "card": {},
    }
    features = np.concatenate([s.features for s in samples])
    arrays = {
        "features": features[:, _COLUMNS].astype(np.float16),
        "counts": np.array([len(s.features) for s in samples]),
    }
    save_model(path, _KIND, header, arrays)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> RealSounds:
    stored = [name for name in header["feature_names"] if name.startswith("pressure_")]
    if stored != [FEATURE_NAMES[i] for i in _COLUMNS]:
        raise ValueError("its features are others")
    x = np.full((len(arrays["features"]), len(FEATURE_NAMES)), np.nan, dtype=np.float32)
    x[:, _COLUMNS] = arrays["features"]
    each = np.split(x, np.cumsum(arrays["counts"])[:-1])
    columns = (header[name] for name in ("labels", "sources", "kinds", "varied"))
    samples = (_sample(*one, varied=varied) for *one, varied in zip(each, *columns, strict=True))
    return tuple(samples), header["licences"]


def train(
    *,
    seed: int = 0,
    n_training: int = N_TRAINING,
    added: Sequence[Sample] = (),
    progress: Callable[[Iterable[Sample], int], Iterable[Sample]] | None = None,
) -> Classifier:
    """Train a classifier; the same seed gives the same classifier.

    Parameters
    ----------
    seed : int
    n_training : int
        Number of training samples.
    added : sequence of Sample
        Samples of the user's recordings (`noise.training.classifier.own_recordings`).
    progress : callable, optional
        ``progress(samples, total)`` yields the samples and shows the progress.

    Returns
    -------
    Classifier
        Its card has scores on left-out kinds and sources.

    Raises
    ------
    ParameterError
        Too few samples to hold every label.

    Examples
    --------
    It takes some twenty minutes:

    >>> train(seed=1).save("mine.npz")  # doctest: +SKIP
    """
    n_made_up = round(0.6 * n_training)
    seeds = np.random.SeedSequence((seed, 1)).spawn(n_made_up)
    seeds += np.random.SeedSequence(seed).spawn(n_training)
    drawn: Iterable[Sample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw_sample)(one, bushings=i >= n_made_up) for i, one in enumerate(seeds)
    )
    real, licences = load_real_sounds()
    classifier = learn(
        list(progress(drawn, len(seeds)) if progress else drawn),
        seed=seed,
        real=real,
        added=added,
    )
    card = {
        "seed": seed,
        "real_sounds": _counts(sample for sample in real if not sample.varied),
        "licences": sorted(f"{name}: {licence}" for name, licence in licences.items()),
    }
    return replace(classifier, card=card | dict(classifier.card))


def learn(
    samples: Sequence[Sample],
    *,
    seed: int,
    real: Sequence[Sample] = (),
    added: Sequence[Sample] = (),
) -> Classifier:
    """Train on samples and recorded sounds, and score each by what was learned without it.

    Raises
    ------
    ParameterError
        Too few samples to hold every label.
    """
    training = [sample for sample in samples if not sample.ambiguous]
    labels = {sample.label for sample in training}
    absent = ", ".join(label for label in LABELS if label not in labels)
    if absent:
        raise ParameterError(f"{len(samples)} training samples hold no {absent}; draw more of them")
    sounds = [*training, *real, *added]
    classifier, left_out = cross_fitted(sounds, seed)
    card: dict[str, object] = {
        "samples": _counts(training),
        **left_out_scores(sounds, left_out, classifier.thresholds),
    }
    if added:
        own = left_out.alone[-len(added) :]
        names = [named_as(p, classifier.thresholds["any"]) for p in own]
        card["own"] = own_card(added, np.array(names))
    return replace(classifier, card=card)


def _counts(sounds: Iterable[Sample]) -> dict[str, int]:
    return dict(sorted(Counter(sound.label for sound in sounds).items()))


if __name__ == "__main__":
    target = resources.files("noise.training.classifier") / "data" / "real_sounds.npz"
    _store(describe_folder(Path(sys.argv[1])), Path(str(target)))
