"""Samples to learn from: what was drawn, described where its label holds and something sounds.

Samples of the classifier: recordings drawn at random, each with the name of its noise.

Nothing is measured: bushings are simulated and called by their physics
(`noise.noise_definition`), other bodies creak, squawk and squeal by the same mechanisms
(`noise.training.classifier.friction_sources`), background sounds and quiet are recipes. All go
through rooms, microphones, recorders and codecs (`noise.training.classifier.augmentation`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.windows.table import HOP, LENGTH
from models.blocks import RecordingBlocks
from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.labels.windows import window_features
from noise.training.classifier.augmentation.backgrounds import quiet
from noise.training.classifier.augmentation.recorder import augmented, recorded
from noise.training.classifier.background_sounds import WEIGHTS, background_sound
from noise.training.classifier.bushings import random_run
from noise.training.classifier.friction_sources.friction_sounds import (
    FRICTION_SOUNDS,
    friction_sound,
)
from noise.training.draws import log_uniform, wandering
from sim.acquisition import Acquisition

if TYPE_CHECKING:
    from noise.training.classifier.bushings import LabelledRun

_PRESSURE_ALONE = 0.45
"""Share of the samples that keep the sound alone; the others have all three channels."""

_AS_COMPUTED = 0.3
"""Share of those with three channels that are what the simulation gives, in a quiet room."""

_QUIET_ROOM = Acquisition().noise


def bushing_recording(
    drawn: LabelledRun, rng: np.random.Generator
) -> tuple[Recording, tuple[float, float]]:
    """Record a run: by anybody's microphone, or by the rig's computer on three channels.

    Parameters
    ----------
    drawn : LabelledRun
    rng : numpy.random.Generator

    Returns
    -------
    recording : Recording
        Uncalibrated; its condition is the run's.
    span : tuple of float
        From when to when the run lasts [s].

    Examples
    --------
    >>> from noise.training.classifier.bushings import random_run
    >>> rng = np.random.default_rng(5)
    >>> recording, span = bushing_recording(random_run(rng), rng)
    >>> 0.5 <= span[1] - span[0] <= 3.0
    True
    """
    run = drawn.run.recording
    # What is below hearing shall not be lifted above the noise again.
    pressure = run["pressure"]
    if drawn.label == "none" and not _has_noise(run):
        pressure = np.zeros_like(pressure)
    if rng.random() < _PRESSURE_ALONE:
        clip = augmented(pressure, run.rate, rng)
        samples, rate, span = clip.samples[None, :], float(clip.rate), clip.span
        kept = ["pressure"]
    else:
        rows = (
            _as_computed(run, rng)
            if rng.random() < _AS_COMPUTED
            else {
                "torque": _noisy(run["torque"], rng.uniform(-3.5, -1.5), mean=True, rng=rng),
                "acceleration": _noisy(
                    run["acceleration"], rng.uniform(-3.0, 0.5), mean=False, rng=rng
                ),
                "pressure": recorded(pressure, run.rate, rng)[0] * 10.0 ** rng.uniform(-3.0, -0.5),
            }
        )
        kept = list(rows)
        samples = np.stack(list(rows.values()))
        rate, span = run.rate, (0.0, run.duration)
    channels = tuple(Channel(name) for name in kept)
    recording = Recording(samples, rate, channels, run.condition, calibrated=False)
    return recording, span


def _as_computed(recorded: Recording, rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    """Return the channels as a run has them by default, the sensors' noise included."""
    return {
        kind: recorded[kind] + _QUIET_ROOM[kind] * rng.standard_normal(recorded[kind].size)
        for kind in ("torque", "acceleration", "pressure")
    }


def _has_noise(recorded: Recording) -> bool:
    """Whether a sensor has noise of its own, 30 dB re 20 uPa or more."""
    return float(recorded["pressure"].std()) > 6e-4


def _noisy(
    signal: NDArray[np.float64], exponent: float, *, mean: bool, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Add a sensor's noise: ``10 ** exponent`` in the unit, or of the signal's mean size."""
    size = float(np.abs(signal).mean()) if mean else 1.0
    return np.asarray(signal + 10.0**exponent * size * rng.standard_normal(signal.size))


_RATE = 48_000.0
"""Sampling rate of friction sources and background sounds [Hz]."""

_FRICTION = {f"friction:{name}": row for name, row in FRICTION_SOUNDS.items()}
"""Rows by source."""

SHARES = {"bushing": 0.31, "friction": 0.26, "background": 0.30, "quiet": 0.13}
"""Of the samples [-]."""

_LABEL_SHARES = {"creak": 0.41, "squeal": 0.41, "squawk": 0.18}
"""Of the friction sources [-]."""

SOURCES = ("bushing", *_FRICTION, *(f"background:{name}" for name in WEIGHTS), "quiet")
"""All that is drawn from."""


_EVEN = 0.35
"""Share of the samples that stay as they are."""

_FADES_OUT, _FADES_IN = 0.5, 0.35
_LOWEST = -80.0
"""Where a fade ends [dB]."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A sample to learn from.

    Parameters
    ----------
    recording : Recording
        Pressure alone, or all three channels, as somebody would have recorded it.
    label : str
        creak, squawk, squeal, none or unknown.
    condition : Condition or None
        What a bushing was simulated at; its speed is ``None`` where it varied.
    source : str
        One of `SOURCES`.
    span : tuple of float
        From when to when the label holds within the recording [s].
    ambiguous : bool
        Whether the label hangs on a bound of its definition.
    """

    recording: Recording
    label: str
    condition: Condition | None
    source: str
    span: tuple[float, float]
    ambiguous: bool = False


def draw(rng: np.random.Generator, *, bushings: bool = True) -> Drawn:
    """Draw a sample.

    Parameters
    ----------
    rng : numpy.random.Generator
    bushings : bool
        Whether it may be a simulated bushing, which takes ten times as long as any other.

    Returns
    -------
    Drawn

    Examples
    --------
    >>> drawn = draw(np.random.default_rng(1))
    >>> drawn.label in ("creak", "squawk", "squeal", "none", "unknown"), drawn.source in SOURCES
    (True, True)
    """
    shares = {group: share for group, share in SHARES.items() if bushings or group != "bushing"}
    group = _picked(shares, rng)
    if group == "background":
        return draw_from(f"background:{_picked(WEIGHTS, rng)}", rng)
    if group == "friction":
        label = _picked(_LABEL_SHARES, rng)
        kinds = {name: row["weight"] for name, row in _FRICTION.items() if row["label"] == label}
        return draw_from(_picked(kinds, rng), rng)
    return draw_from(group, rng)


def draw_from(source: str, rng: np.random.Generator) -> Drawn:
    """Draw a sample from one source.

    Parameters
    ----------
    source : str
        One of `SOURCES`.
    rng : numpy.random.Generator

    Raises
    ------
    ParameterError
        If there is no such source.

    Examples
    --------
    >>> draw_from("friction:chalk_squeal", np.random.default_rng(0)).label
    'squeal'
    """
    if source not in SOURCES:
        raise ParameterError(f"source {source!r} is unknown; there are {', '.join(SOURCES)}")
    if source == "bushing":
        run = random_run(rng)
        recording, span = bushing_recording(run, rng)
        return Drawn(recording, run.label, recording.condition, source, span, run.ambiguous)
    n = int(_length(rng) * _RATE)
    if source == "quiet":
        return _augmented(quiet(n, _RATE, rng), "none", source, rng)
    group, _, name = source.partition(":")
    if group == "background":
        return _augmented(background_sound(n, _RATE, rng, name), "unknown", source, rng)
    made = friction_sound(name, n, _RATE, rng)
    drawn = _augmented(made.samples, made.label, source, rng, made.span)
    return replace(drawn, ambiguous=made.ambiguous)


def _length(rng: np.random.Generator) -> float:
    """Length of a sound [s]: some are just long enough to be looked at."""
    return float(rng.uniform(0.6, 3.0) if rng.random() < 0.6 else rng.uniform(0.6, 1.2))


def _augmented(
    sound: NDArray[np.float64],
    label: str,
    source: str,
    rng: np.random.Generator,
    span: tuple[float, float] | None = None,
) -> Drawn:
    if not sound.any():  # digital silence stays so
        recording = Recording(sound[None, :], _RATE, (Channel("pressure"),), calibrated=False)
        return Drawn(recording, label, None, source, (0.0, recording.duration))
    clip = augmented(sound, _RATE, rng, span=span)
    recording = Recording(
        clip.samples[None, :], float(clip.rate), (Channel("pressure"),), calibrated=False
    )
    return Drawn(recording, label, None, source, clip.span)


def _picked(shares: Mapping[str, float], rng: np.random.Generator) -> str:
    weights = np.array(list(shares.values()))
    return list(shares)[int(rng.choice(weights.size, p=weights / weights.sum()))]


def swelling(drawn: Drawn, rng: np.random.Generator) -> Drawn:
    """Return a sample with a course of level; one of several channels stays as it is.

    What a simulated machine does for a second it does evenly; whoever opens a door, or cuts the
    recording of it, does not. All that a microphone alone records, background sounds too, gets a
    course of level of its own, so that a level that changes says nothing about what sounds.

    Examples
    --------
    >>> drawn = draw_from("friction:chalk_squeal", np.random.default_rng(0))
    >>> other = swelling(drawn, np.random.default_rng(1))
    >>> bool(np.abs(other.recording.samples).max() <= 2.0 * np.abs(drawn.recording.samples).max())
    True
    """
    recording = drawn.recording
    if len(recording.channels) > 1 or rng.random() < _EVEN:
        return drawn
    n, rate = recording.samples.shape[1], recording.rate
    gain = 10.0 ** (_course(n, rate, rng) / 20.0)
    return replace(drawn, recording=replace(recording, samples=recording.samples * gain))


def _course(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Level over time [dB], 0 at most."""
    time = np.arange(n) / rate
    depth, speed = rng.uniform(0.0, 8.0), rng.uniform(0.3, 4.0)
    level = depth * wandering(n, rate, speed, rng)
    if rng.random() < _FADES_OUT:
        start = rng.uniform(0.1, 1.0) * time[-1]
        level -= log_uniform(15.0, 250.0, rng) * np.maximum(time - start, 0.0)
    if rng.random() < _FADES_IN:
        end = rng.uniform(0.0, 0.5) * time[-1]
        level -= log_uniform(30.0, 600.0, rng) * np.maximum(end - time, 0.0)
    return np.asarray(np.maximum(level - level.max(), _LOWEST))


_QUIET_DB = 30.0
"""Windows that lie so far below a sample's loudest are pauses, of which nothing is learned."""

_OUTSIDE = 0.2
"""How far a window may reach beyond the time for which the label holds [s]."""

_OF_EVENT = 0.9
"""Share of a short event that lies in a window of it [-]."""


@dataclass(frozen=True, eq=False)
class Sample:
    """One training sample.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the windows in which the label holds, by `noise.labels.windows.FEATURE_NAMES`
        [unit of each feature].
    label : str
    ambiguous : bool
        Whether the label hangs on a bound of its definition.
    name : str
        Kind of body or of background, one of `noise.training.classifier.described_samples.SOURCES`.
    """

    features: NDArray[np.float32]
    label: str
    ambiguous: bool
    name: str = ""
    weight = 1.0


def draw_sample(seed: np.random.SeedSequence, *, bushings: bool = True) -> Sample:
    """Draw one sample and describe the part of it where its label holds.

    It is no simulated bushing unless `bushings`.
    """
    (other,) = seed.spawn(1)
    drawn = draw(np.random.default_rng(seed), bushings=bushings)
    return describe_drawn(swelling(drawn, np.random.default_rng(other)))


def describe_drawn(drawn: Drawn) -> Sample:
    """Describe the windows of a drawn recording in which its label holds and something sounds."""
    found = window_features(RecordingBlocks.of(drawn.recording))
    start = np.arange(len(found.features)) * HOP
    end = np.minimum(start + LENGTH, drawn.recording.duration)
    inside = np.minimum(end, drawn.span[1]) - np.maximum(start, drawn.span[0])
    # Of a window that holds a short event all but that is left aside as it is described.
    enough = np.minimum(end - start - _OUTSIDE, _OF_EVENT * (drawn.span[1] - drawn.span[0]))
    kept = (inside >= enough) & (found.level > found.level.max() - _QUIET_DB)
    kept[np.argmax(inside + 1e-6 * found.level)] |= not kept.any()
    return Sample(found.features[kept], drawn.label, drawn.ambiguous, drawn.source)
