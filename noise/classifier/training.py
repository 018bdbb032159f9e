"""Training the classifier, on simulation and on made-up strangers alone.

Three sets that share no draw: one grows the forest, one calibrates its probabilities, and one is
scored and written into the card. What
a run is called follows from its physics (`noise.classifier.truth`), never from its features. The
classifier has to work with whatever channels there are, so the samples keep any subset of them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed
from scipy.optimize import minimize_scalar

from features.registry import recording_feature_names, recording_features
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.classifier.designs import random_design
from noise.classifier.forest import grow_forest
from noise.classifier.hearing import RATES, as_recorded, coloured_noise, resampled
from noise.classifier.model import LABELS, Classifier, calibrated
from noise.classifier.own_samples import (
    OWN_WEIGHT,
    as_arrays as own_arrays,
    own_card,
    split_files,
)
from noise.classifier.strangers import stranger
from noise.classifier.truth import noise_of
from sim.acquisition import Acquisition
from sim.run import simulate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

    from noise.classifier.forest import Forest
    from noise.classifier.own_samples import OwnSample

__all__ = ["Sample", "draw_sample", "train"]

N_TRAINING = 3000
"""Samples that grow the forest."""

N_CALIBRATION = 600
"""Samples that calibrate its probabilities."""

N_TEST = 600
"""Samples that are scored."""

N_TREES = 150
LEAST_LEAF = 4

_STRANGERS = 0.25
_QUIET = 0.08
"""Shares of the samples that are strangers, and noise or hum alone; the others are simulated."""

_PRESSURE_ALONE = 0.6
"""Share of the simulated samples that keep the sound alone; the others keep any subset."""

_LEAST_TONE_TO_ROOM = -5.0


@dataclass(frozen=True, eq=False)
class Sample:
    """One training sample: a segment's features and what it is."""

    features: dict[str, float]
    label: str


def train(
    *,
    seed: int = 0,
    n_training: int = N_TRAINING,
    n_calibration: int = N_CALIBRATION,
    n_test: int = N_TEST,
    added: Sequence[OwnSample] = (),
    progress: Callable[[Iterable[Sample], int], Iterable[Sample]] | None = None,
) -> Classifier:
    """Train a classifier; the same seed gives the same classifier.

    Parameters
    ----------
    seed : int
    n_training, n_calibration, n_test : int
        Samples to learn from, to calibrate on and to score.
    added : sequence of OwnSample
        Of the user's own recordings, to learn from as well (`noise.classifier.own_samples`).
    progress : callable, optional
        ``progress(samples, total)`` passes the samples on and shows how far it is.

    Returns
    -------
    Classifier
        Its card tells the scores on the last of the three sets and, where recordings were added,
        on those of them that were held out.
    """
    total = n_training + n_calibration + n_test
    children = np.random.SeedSequence(seed).spawn(total)
    drawn: Iterable[Sample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw_sample)(child) for child in children
    )
    samples = list(progress(drawn, total) if progress else drawn)
    # Levels are left out: the samples are not calibrated, and a noise is one at any level.
    names = [
        name
        for name in recording_feature_names()
        if any(np.isfinite(sample.features[name]) for sample in samples[:n_training])
    ]
    x = np.array([[sample.features[name] for name in names] for sample in samples])
    y = np.array([LABELS.index(sample.label) for sample in samples])
    missing = set(range(len(LABELS))) - set(y[:n_training].tolist())
    if missing:
        absent = ", ".join(LABELS[i] for i in sorted(missing))
        raise ParameterError(f"{n_training} training samples hold no {absent}; draw more of them")
    learn, calibrate, test = np.split(np.arange(total), [n_training, n_training + n_calibration])
    forest = grow_forest(x[learn], y[learn], n_trees=N_TREES, least_leaf=LEAST_LEAF, seed=seed)
    own: dict[str, object] = {}
    if added:
        forest, own["own"] = _grown_with(added, forest, names, x[learn], y[learn], seed)
    sharpness = _fitted_sharpness(forest.probabilities(x[calibrate]), y[calibrate])
    card: dict[str, object] = {
        "seed": seed,
        "samples": dict(Counter(sample.label for sample in samples[:n_training])),
        "test": _scores(calibrated(forest.probabilities(x[test]), sharpness), y[test]),
        **own,
    }
    return Classifier(tuple(names), forest, sharpness, card)


def draw_sample(seed: np.random.SeedSequence) -> Sample:
    """Draw one sample: a simulated run, a stranger, or noise alone."""
    rng = np.random.default_rng(seed)
    kind = rng.random()
    if kind < _STRANGERS:
        recording, label = _stranger(rng), "unknown"
    elif kind < _STRANGERS + _QUIET:
        recording, label = _quiet(rng), "none"
    else:
        recording, label = _simulated(rng)
    return Sample(recording_features(recording), label)


def _grown_with(
    added: Sequence[OwnSample],
    without: Forest,
    names: Sequence[str],
    x: NDArray[np.float64],
    y: NDArray[np.int64],
    seed: int,
) -> tuple[Forest, dict[str, object]]:
    """Grow the forest on the user's own samples as well; return it and what the card says of it."""
    learned, held = split_files(added, seed)
    own_x, own_y = own_arrays(learned, names)
    forest = grow_forest(
        np.concatenate([x, own_x]),
        np.concatenate([y, own_y]),
        n_trees=N_TREES,
        least_leaf=LEAST_LEAF,
        seed=seed,
        weights=np.concatenate([np.ones(y.size), np.full(own_y.size, OWN_WEIGHT)]),
    )
    held_x, _ = own_arrays(held, names)
    before, after = without.probabilities(held_x), forest.probabilities(held_x)
    return forest, own_card(learned, held, before, after)


def _simulated(rng: np.random.Generator) -> tuple[Recording, str]:
    while True:
        design = random_design(rng)
        try:
            run = simulate(
                design.rig,
                design.speed,
                interference=design.interference,
                support_stiffness=design.support_stiffness,
                seconds=float(rng.uniform(0.5, 1.0)),
                acquisition=Acquisition(noise={}),
                rng=rng,
            )
        except ParameterError:  # a drawn design that cannot be built
            continue
        break
    label = noise_of(run)
    source = run.pressure if label != "none" else np.zeros_like(run.pressure)
    rate = int(rng.choice(RATES))
    sound = resampled(as_recorded(source, run.motion.rate, rng), run.motion.rate, rate)
    heard = _one_track(sound, rate, rng)
    if rng.random() < _PRESSURE_ALONE:
        return heard, label
    # Torque and acceleration have noise of their own, small against the oscillation or not.
    torque, acceleration = run.recording["torque"], run.recording["acceleration"]
    measured = {
        "torque": torque
        + 10.0 ** rng.uniform(-3.5, -1.5)
        * np.abs(torque).mean()
        * rng.standard_normal(torque.size),
        "acceleration": acceleration
        + 10.0 ** rng.uniform(-3.0, 0.5) * rng.standard_normal(acceleration.size),
    }
    rows = {"pressure": heard.samples[0]} | {
        name: resampled(signal, run.recording.rate, rate) for name, signal in measured.items()
    }
    kept = [name for name in rows if rng.random() < 0.6] or [str(rng.choice(list(rows)))]
    n = min(row.size for row in rows.values())
    recording = replace(
        heard,
        samples=np.stack([rows[name][:n] for name in kept]),
        channels=tuple(Channel(name) for name in kept),
    )
    return recording, label


def _stranger(rng: np.random.Generator) -> Recording:
    rate = int(rng.choice(RATES))
    n = int(rng.uniform(0.4, 1.0) * rate)
    return _one_track(as_recorded(stranger(n, rate, rng), rate, rng), rate, rng)


def _quiet(rng: np.random.Generator) -> Recording:
    """Noise, with or without hum, as a microphone records where nothing sounds."""
    rate = int(rng.choice(RATES))
    n = int(rng.uniform(0.4, 1.0) * rate)
    noise = coloured_noise(n, rng.uniform(0.0, 2.2), rng)
    if rng.random() < 0.5:
        time = np.arange(n) / rate
        mains = float(rng.choice((50.0, 60.0)))
        for k in range(1, int(rng.integers(2, 8))):
            phase = 2 * np.pi * (k * mains * time + rng.random())
            noise += 10.0 ** rng.uniform(_LEAST_TONE_TO_ROOM / 20.0, 1.0) / k * np.sin(phase)
    return _one_track(noise, rate, rng)


def _one_track(sound: NDArray[np.float64], rate: float, rng: np.random.Generator) -> Recording:
    gain = 10.0 ** rng.uniform(-3.0, -0.5)
    return Recording(gain * sound[None, :], rate, (Channel("pressure"),), calibrated=False)


def _fitted_sharpness(votes: NDArray[np.float64], y: NDArray[np.int64]) -> float:
    """Exponent with the smallest log loss."""

    def log_loss(sharpness: float) -> float:
        p = calibrated(votes, sharpness)
        return float(-np.mean(np.log(p[np.arange(y.size), y])))

    return float(minimize_scalar(log_loss, bounds=(0.3, 5.0), method="bounded").x)


def _scores(p: NDArray[np.float64], y: NDArray[np.int64]) -> dict[str, float]:
    from sklearn.metrics import f1_score

    found = p.argmax(axis=1)
    certainty = p.max(axis=1)
    bins = np.minimum((10.0 * certainty).astype(int), 9)
    right = found == y
    ece = sum(
        np.mean(bins == b) * abs(np.mean(right[bins == b]) - np.mean(certainty[bins == b]))
        for b in np.unique(bins)
    )
    return {
        "n": int(y.size),
        "accuracy": round(float(np.mean(right)), 4),
        "macro_f1": round(float(f1_score(y, found, average="macro")), 4),
        "expected_calibration_error": round(float(ece), 4),
    }
