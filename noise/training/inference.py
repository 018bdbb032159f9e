"""Training of the inference of conditions, on simulation alone.

Two independent sets of runs grow the forests and calibrate the intervals. The features
of the channels of a run do not depend on one another, so one run represents all subsets of its
channels and logged conditions; the forests learn random subsets, and the intervals are calibrated
for each subset.

Calibration is conformal: for each set of channels, calibration and other logged conditions, 5 % of
the recordings of the second set lie below the interval and 5 % above it, and counting one more
gives a coverage of at least 90 % (V. Vovk, A. Gammerman, G. Shafer, *Algorithmic Learning in a
Random World*, 2005). Whether an interval is reported is decided first, by separate counts, so that
the final counts hold for recordings with an interval.

The intervals hold for a population: fluorocarbon bushings whose stiffness, torques, inertia and
friction scatter by 3 % about the shipped rig's, like specimens; an interference of 0.15-0.42 mm;
supports of 1000-10000 Nm/rad, or the bolted clamp; 0.1-15 rad/s; and runs with a creak, squawk or
squeal. The wider scatter of `noise.training.classifier.bushings` would widen the intervals, because
the rate of a creak depends on speed and torque.

Each run is recorded twice. On the *rig*, samples are calibrated, the microphone is at its place in
the thesis, and levels depend on the torque. In the *field*, nothing is calibrated, and there are a
room, another microphone, noise and other sampling rates. Room and noise are simpler than those of
the classifier, and the microphone is its free one (`noise.training.classifier.recorder`), so that
the population does not change with the classifier.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from features.table import recording_feature_names, recording_features
from models.condition import FIXED
from models.recording import Channel, Recording
from models.rig import LawSpec, Rig
from models.rig_file import load_material_rig
from noise.base.arrays import Array, Rng
from noise.inference.model import (
    INTERFERENCE_RANGE,
    KINDS,
    LONGEST,
    MATERIAL,
    QUANTITIES,
    RATES,
    SHORTEST,
    SPEED_RANGE,
    SUPPORT_RANGE,
    Inference,
    of_channels,
    scaled,
    segment_features,
)
from noise.noise_definition import label_by_physics
from noise.training.classifier.bushings import SHAPES, scaled as scaled_fit
from noise.training.classifier.recorder import resampled, through_a_microphone, with_sensor_noise
from noise.training.draws import coloured_noise, log_uniform
from noise.training.trees import PER_LEAF, grow_quantile_forest
from sim.run import Run, simulate


def recorded(sound: Array, rate: float, rng: Rng) -> Array:
    """Return a sound as recorded in a random room by a random microphone, with noise.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Pressure close to the source [Pa].
    rate : float
        Sampling rate [Hz].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        Recorded sound of unit standard deviation [-]; only noise if the sound is zero.
    """
    signal = _in_a_room(sound, rate, rng) if rng.random() < 0.7 else sound
    signal = through_a_microphone(signal, rate, rng)
    level = float(signal.std())
    snr = rng.uniform(6.0, 50.0) if rng.random() < 0.8 else 60.0
    noise = coloured_noise(signal.size, rng.uniform(0.0, 2.0), rng)
    noise_level = level * 10.0 ** (-snr / 20.0) if level > 0.0 else 1.0
    signal = signal + noise_level * noise
    return np.asarray(signal / signal.std())


def _in_a_room(sound: Array, rate: float, rng: Rng) -> Array:
    """Return a sound with a diffuse tail that decays exponentially."""
    t60 = rng.uniform(0.1, 0.8)
    n = int(min(t60, 0.6) * rate)
    time = np.arange(n) / rate
    tail = rng.standard_normal(n) * 10.0 ** (-3.0 * time / t60)
    tail[: int(rng.uniform(0.002, 0.01) * rate)] = 0.0
    tail *= 10.0 ** (rng.uniform(-20.0, 0.0) / 20.0) / math.sqrt(float(np.sum(tail**2)))
    tail[0] = 1.0
    return np.asarray(fftconvolve(sound, tail)[: sound.size])


class RunSample(NamedTuple):
    """Features of one audible run, with its label and condition.

    Parameters
    ----------
    label : str
        Noise by physics (`noise.noise_definition`).
    scaled : ndarray, shape (3,)
        Condition, as from `noise.inference.model.scaled` [-, mm, -].
    features : tuple of (mapping of str to float)
        In the field, and on the rig [unit of each feature].
    """

    label: str
    scaled: Array
    features: tuple[Mapping[str, float], Mapping[str, float]]


def draw_run_sample(seed: np.random.SeedSequence) -> RunSample:
    """Return the features of both recordings of a random audible run.

    Examples
    --------
    >>> sample = draw_run_sample(np.random.SeedSequence(0))
    >>> sample.label in ("creak", "squawk", "squeal"), sample.scaled.shape
    (True, (3,))
    """
    rng = np.random.default_rng(seed)
    while (label := label_by_physics(run := _draw_run(rng))) == "none":
        pass
    whole = rng.random() < 0.5
    seconds = LONGEST if whole else float(rng.uniform(SHORTEST, LONGEST))
    start = float(rng.uniform(0.0, LONGEST - seconds))
    rig = _on_the_rig(run, rng)
    field = _in_the_field(run, rng)
    features = tuple(recording_features(_cut(one, start, seconds)) for one in (field, rig))
    return RunSample(label, scaled(run.recording.condition), (features[0], features[1]))


def _draw_run(rng: Rng) -> Run:
    low, high = SPEED_RANGE
    # Log-uniform for slow creaks, and uniform for the boundary of squawk and squeal.
    even = rng.random() < 0.5
    speed = rng.uniform(low, high) if even else log_uniform(low, high, rng)
    softest, stiffest = SUPPORT_RANGE
    support = log_uniform(softest, stiffest, rng)
    if rng.random() < 0.25:
        support = FIXED
    return simulate(
        _specimen(rng),
        float(speed),
        interference=float(rng.uniform(*INTERFERENCE_RANGE)),
        support_stiffness=support,
        seconds=LONGEST,
        rng=rng,
    )


def _specimen(rng: Rng) -> Rig:
    rig = load_material_rig(MATERIAL)

    def about(value: float) -> float:
        return value * math.exp(rng.normal(0.0, 0.03))

    def jittered(spec: LawSpec) -> LawSpec:
        return LawSpec(
            spec.name,
            {
                name: about(value) if isinstance(value, float) and name not in SHAPES else value
                for name, value in spec.parameters.items()
            },
        )

    stiffness, torque, damping = about(1.0), about(1.0), about(1.0)
    return replace(
        rig,
        elastomer_inertia=about(rig.elastomer_inertia),
        clamp_inertia=about(rig.clamp_inertia),
        elastomer_damping_share=about(rig.elastomer_damping_share),
        fits=tuple(scaled_fit(fit, stiffness, torque, damping) for fit in rig.fits),
        friction=jittered(rig.friction),
        effects=tuple(jittered(spec) for spec in rig.effects),
    )


def _on_the_rig(run: Run, rng: Rng) -> Recording:
    """Return the recording at its own sampling rate or at another one of loggers."""
    recording = run.recording
    rate = recording.rate if rng.random() < 0.5 else float(rng.choice(RATES[1:]))
    kinds = ("torque", "acceleration", "pressure")
    gains = np.exp(rng.normal(0.0, 0.03, (len(kinds), 1)))
    samples = gains * [resampled(recording[kind], recording.rate, rate) for kind in kinds]
    return Recording(samples, rate, tuple(Channel(kind) for kind in kinds))


def _in_the_field(run: Run, rng: Rng) -> Recording:
    rate = float(rng.choice(RATES))
    recording, computed = run.recording, run.motion.rate
    sensed = with_sensor_noise(recording["torque"], recording["acceleration"], rng)
    rows = (
        *(resampled(signal, recording.rate, rate) for signal in sensed),
        resampled(recorded(run.pressure, computed, rng), computed, rate),
    )
    n = min(row.size for row in rows)
    channels = (Channel("torque"), Channel("acceleration"), Channel("pressure"))
    samples = 10.0 ** rng.uniform(-3.0, -0.5) * np.stack([row[:n] for row in rows])
    return Recording(samples, rate, channels, calibrated=False)


def _cut(recording: Recording, start: float, seconds: float) -> Recording:
    first = round(start * recording.rate)
    samples = recording.samples[:, first : first + round(seconds * recording.rate)]
    return replace(recording, samples=samples)


class Runs(NamedTuple):
    """Features and conditions of runs as arrays.

    Parameters
    ----------
    tables : ndarray, shape (2, n_runs, n_names)
        Features in the field, and on the rig [unit of each feature].
    scaled : ndarray, shape (n_runs, 3)
        Conditions as from `noise.inference.model.scaled` [-, mm, -].
    """

    tables: Array
    scaled: Array

    @classmethod
    def of(cls, samples: Iterable[RunSample], names: Sequence[str]) -> Runs:
        """Return samples as arrays."""
        rows = [
            [[of_one[name] for name in names] for of_one in sample.features] for sample in samples
        ]
        return cls(np.array(rows).swapaxes(0, 1), np.array([s.scaled for s in samples]))


def calibrate_intervals(model: Inference, runs: Runs) -> Inference:
    """Return a model with calibrated intervals, using the channels with the narrowest intervals.

    Parameters
    ----------
    model : Inference
        Model with trained forests.
    runs : Runs
        Runs that were not used to grow the forests.

    Returns
    -------
    Inference
    """
    used, outside = model.used.copy(), model.outside.copy()
    widths = np.full(used.shape, np.inf)
    for case in _cases():
        index, calibrated, subset, others = case
        at = (index, subset, calibrated, others)
        values = _distribution(model, runs, *case)
        counts = _counts_outside(model, index, values, rounded(runs.scaled[:, index]))
        if counts is not None:
            used[at], outside[at] = subset, counts
            widths[at] = _mean_width(model, index, values, counts)
    for index, calibrated, subset, others in _cases():
        at = (index, subset, calibrated, others)
        parts = [part for part in range(1, subset + 1) if part & subset == part]
        best = min(parts, key=lambda part: widths[index, part, calibrated, others])
        source = (index, best, calibrated, others)
        if used[source] == best:
            used[at], outside[at] = best, outside[source]
    return replace(model, used=used, outside=outside)


def _counts_outside(
    model: Inference, index: int, values: NDArray[np.float32], y: NDArray[np.float32]
) -> NDArray[np.int16] | None:
    first = _beyond(values, y)
    if first is None:
        return None
    narrow = model.is_narrow(index, values, np.array([*first, 0, 0], dtype=np.int16))
    second = _beyond(values[narrow], y[narrow])
    return None if second is None else np.array([*first, *second], dtype=np.int16)


def _mean_width(
    model: Inference, index: int, values: NDArray[np.float32], outside: NDArray[np.int16]
) -> float:
    """Return the mean width of the intervals, with that of the population for those missing."""
    low, high = np.quantile(model.prior[index], [0.05, 0.95])
    width = values[:, -1 - outside[3]] - values[:, outside[2]]
    return float(np.mean(np.where(model.is_narrow(index, values, outside), width, high - low)))


def _beyond(values: NDArray[np.float32], y: NDArray[np.float32]) -> tuple[int, int] | None:
    """Return the numbers of lowest and highest values outside of the interval, for 5 % each."""
    n = len(y)
    if n < 50:  # too few
        return None
    beyond = int(0.05 * (n + 1)) - 1  # conformal: one more counts as beyond
    # With i values left out below, recordings with at most i values at or below them are beyond.
    at_or_below = np.sort((values <= y[:, None]).sum(axis=1))
    at_or_above = np.sort((values >= y[:, None]).sum(axis=1))
    low, high = (max(0, int(counts[beyond]) - 1) for counts in (at_or_below, at_or_above))
    half = (values.shape[1] - 1) // 2
    return min(low, half), min(high, half)


def _distribution(
    model: Inference, runs: Runs, index: int, calibrated: int, subset: int, others: int
) -> NDArray[np.float32]:
    known = np.full_like(runs.scaled, np.nan)
    left = [column for column in range(len(QUANTITIES)) if column != index]
    for bit, column in enumerate(left):
        if others >> bit & 1:
            known[:, column] = runs.scaled[:, column]
    table = of_channels(runs.tables[calibrated], model.names, subset)
    return model.distribution(index, segment_features(table, model.names, known))


def rounded(y: Array) -> NDArray[np.float32]:
    """Round to the precision of the values of the leaves.

    Parameters
    ----------
    y : ndarray, shape (n,)
        [any unit]

    Returns
    -------
    ndarray of float32, shape (n,)
        [unit of `y`]

    Examples
    --------
    >>> rounded(np.array([0.279])).tolist()
    [0.279052734375]
    """
    return np.asarray(y, dtype=np.float16).astype(np.float32)


def _cases() -> Iterator[tuple[int, int, int, int]]:
    """Yield quantity, calibration, subset of channels, and set of other logged conditions."""
    return itertools.product(range(len(QUANTITIES)), (0, 1), range(1, 1 << len(KINDS)), range(4))


def train_inference(
    *,
    seed: int = 0,
    n_training: int = 1800,
    n_calibration: int = 1600,
    progress: Callable[[Iterable[RunSample], int], Iterable[RunSample]] | None = None,
) -> Inference:
    """Train the inference of conditions; the same seed gives the same model.

    Parameters
    ----------
    seed : int
    n_training, n_calibration : int
        Numbers of runs to grow the forests and to calibrate the intervals.
    progress : callable, optional
        ``progress(samples, total)`` yields the samples and shows the progress.

    Returns
    -------
    Inference

    Examples
    --------
    It takes minutes:

    >>> train_inference(seed=1).save("conditions.npz")  # doctest: +SKIP
    """
    total = n_training + n_calibration
    children = np.random.SeedSequence(seed).spawn(total)
    drawn: Iterable[RunSample] = Parallel(n_jobs=-1, return_as="generator")(
        delayed(draw_run_sample)(child) for child in children
    )
    samples = list(progress(drawn, total) if progress else drawn)
    names = tuple(
        name
        for name in recording_feature_names()
        if any(np.isfinite(sample.features[1][name]) for sample in samples[:n_training])
    )
    grown = _grown(Runs.of(samples[:n_training], names), names, seed)
    calibrated = calibrate_intervals(grown, Runs.of(samples[n_training:], names))
    labels = Counter(sample.label for sample in samples[:n_training])
    return replace(calibrated, card={"seed": seed, "samples": dict(labels)})


def _grown(runs: Runs, names: tuple[str, ...], seed: int) -> Inference:
    rng = np.random.default_rng([seed, 1])
    n = len(runs.scaled)
    forests = []
    for index in range(len(QUANTITIES)):
        rows = []
        for table in runs.tables:
            for _ in range(4):  # random subsets of channels, often the sound alone
                subsets = np.where(rng.random(n) < 0.35, 1, rng.integers(1, 1 << len(KINDS), n))
                known = np.where(rng.random((n, 3)) < 0.5, runs.scaled, np.nan)
                known[:, index] = np.nan
                partial = of_channels(table, names, subsets)
                rows.append(segment_features(partial, names, known))
        forests.append(
            grow_quantile_forest(
                np.concatenate(rows),
                np.tile(runs.scaled[:, index], len(rows)),
                n_trees=50,
                least_leaf=5,
                share=0.4,
                seed=seed,
            )
        )
    prior = rounded(np.quantile(runs.scaled, np.linspace(0.0, 1.0, PER_LEAF), axis=0).T)
    cases = (len(QUANTITIES), 1 << len(KINDS), 2, 4)
    used = np.zeros(cases, dtype=np.int16)
    outside = np.full((*cases, 4), -1, dtype=np.int16)
    return Inference(names, tuple(forests), prior, used, outside, {})
