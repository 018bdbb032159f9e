"""Training samples of the classifier: random synthetic recordings with labels, and their features.

Bushings are simulated and labelled by physics (`noise.noise_definition`), other bodies creak,
squawk and squeal by the same mechanisms (`noise.training.classifier.friction_sounds`), and
background sounds and quiet are synthesised. All pass through random rooms, microphones, recorders
and codecs (`noise.training.classifier.recorder`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from features.windows.table import HOP, LENGTH
from models.recording import Channel, Recording, RecordingBlocks
from noise.base.arrays import Rng
from noise.labels.windows import window_features
from noise.training.classifier.background_sounds import WEIGHTS, background_sound
from noise.training.classifier.bushings import LabelledRun, random_run
from noise.training.classifier.friction_sounds import (
    FRICTION_SOUNDS,
    friction_sound,
)
from noise.training.classifier.places import quiet
from noise.training.classifier.recorder import (
    augmented,
    recorded,
    sound_recording,
    with_sensor_noise,
)
from noise.training.draws import Span, log_uniform, picked, wandering
from sim.acquisition import Acquisition

_CHANNELS = ("torque", "acceleration", "pressure")

_RATE = 48_000.0
"""Sampling rate of friction sources and background sounds [Hz]."""

SHARES = {"bushing": 0.31, "friction": 0.26, "background": 0.30, "quiet": 0.13}
"""Shares of the samples [-]."""

SOURCES = (
    "bushing",
    *(f"friction:{name}" for name in FRICTION_SOUNDS),
    *(f"background:{name}" for name in WEIGHTS),
    "quiet",
)
"""Names of all sources."""

QUIET_DB = 30.0
"""Level below the loudest window from which a window is a pause and not learned [dB]."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """Synthetic recording with a label.

    Parameters
    ----------
    recording : Recording
        Pressure alone, or torque, acceleration and pressure.
    label : str
        creak, squawk, squeal, none or unknown.
    source : str
        One of `SOURCES`.
    span : tuple of float
        Start and end of the label in the recording [s].
    ambiguous : bool
        Whether the label is close to a bound of its definition.
    """

    recording: Recording
    label: str
    source: str
    span: Span
    ambiguous: bool = False


@dataclass(frozen=True, eq=False)
class Sample:
    """Features of the windows of a sound with one label.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `noise.labels.windows.FEATURE_NAMES` [unit of each feature].
    label : str
    source : str
        One of `SOURCES`, or the source of a real sound; samples of one source are in the same
        part of the cross-validation.
    weight : float
        Weight relative to a simulated sample [-].
    kind : str
        Kind of a real sound, in words.
    real, varied : bool
        Whether it is a real sound, and whether it is a variation of one, which is used to grow
        trees, but not to calibrate or score them.
    ambiguous : bool
        Whether the label is close to a bound of its definition.
    """

    features: NDArray[np.float32]
    label: str
    source: str
    weight: float = 1.0
    kind: str = ""
    real: bool = False
    varied: bool = False
    ambiguous: bool = False


def draw_sample(seed: np.random.SeedSequence, *, bushings: bool = True) -> Sample:
    """Return the features of a random sample.

    Parameters
    ----------
    seed : numpy.random.SeedSequence
    bushings : bool
        As in `draw`.
    """
    (other,) = seed.spawn(1)
    drawn = draw(np.random.default_rng(seed), bushings=bushings)
    return described(swelling(drawn, np.random.default_rng(other)))


def described(drawn: Drawn) -> Sample:
    """Return the features of the windows in the span of the label, without pauses."""
    windows = window_features(RecordingBlocks.of(drawn.recording))
    start = np.arange(len(windows.features)) * HOP
    end = np.minimum(start + LENGTH, drawn.recording.duration)
    inside = np.minimum(end, drawn.span[1]) - np.maximum(start, drawn.span[0])
    # All but 0.2 s of a window is in the span, or 0.9 of a short event: window features describe
    # the event alone (`features.windows.table`).
    enough = np.minimum(end - start - 0.2, 0.9 * (drawn.span[1] - drawn.span[0]))
    chosen = (inside >= enough) & (windows.level > windows.level.max() - QUIET_DB)
    chosen[np.argmax(inside + 1e-6 * windows.level)] |= not chosen.any()
    return Sample(windows.features[chosen], drawn.label, drawn.source, ambiguous=drawn.ambiguous)


def draw(rng: Rng, *, bushings: bool = True) -> Drawn:
    """Return a random labelled recording.

    Parameters
    ----------
    rng : numpy.random.Generator
    bushings : bool
        Whether to include simulated bushings, which take ten times as long as others.

    Returns
    -------
    Drawn

    Examples
    --------
    >>> drawn = draw(np.random.default_rng(1))
    >>> drawn.label in ("creak", "squawk", "squeal", "none", "unknown"), drawn.source in SOURCES
    (True, True)
    """
    group = picked({g: share for g, share in SHARES.items() if bushings or g != "bushing"}, rng)
    if group == "background":
        return draw_from(f"background:{picked(WEIGHTS, rng)}", rng)
    if group == "friction":
        label = picked({"creak": 0.41, "squeal": 0.41, "squawk": 0.18}, rng)
        rows = {n: row["weight"] for n, row in FRICTION_SOUNDS.items() if row["label"] == label}
        return draw_from(f"friction:{picked(rows, rng)}", rng)
    return draw_from(group, rng)


def draw_from(source: str, rng: Rng) -> Drawn:
    """Return a random labelled recording of one of `SOURCES`.

    Examples
    --------
    >>> draw_from("friction:door_creak", np.random.default_rng(0)).label
    'creak'
    """
    if source == "bushing":
        run = random_run(rng)
        recording, span = bushing_recording(run, rng)
        return Drawn(recording, run.label, source, span, run.ambiguous)
    seconds = rng.uniform(0.6, 3.0) if rng.random() < 0.6 else rng.uniform(0.6, 1.2)
    n = int(seconds * _RATE)
    group, _, name = source.partition(":")
    if group == "friction":
        rubbed, span, ambiguous = friction_sound(name, n, _RATE, rng)
        clip, span = augmented(rubbed, _RATE, rng, span=span)
        return Drawn(clip, FRICTION_SOUNDS[name]["label"], source, span, ambiguous)
    sound = quiet(n, _RATE, rng) if group == "quiet" else background_sound(n, _RATE, rng, name)
    label = "none" if group == "quiet" else "unknown"
    if not sound.any():  # digital silence is not augmented
        return Drawn(sound_recording(sound, _RATE), label, source, (0.0, n / _RATE))
    clip, span = augmented(sound, _RATE, rng)
    return Drawn(clip, label, source, span)


def bushing_recording(drawn: LabelledRun, rng: Rng) -> tuple[Recording, Span]:
    """Return a random recording of a run: the sound alone, or three channels.

    Parameters
    ----------
    drawn : LabelledRun
    rng : numpy.random.Generator

    Returns
    -------
    recording : Recording
        Uncalibrated; its condition is the run's.
    span : tuple of float
        Start and end of the run [s].

    Examples
    --------
    >>> rng = np.random.default_rng(5)
    >>> recording, span = bushing_recording(random_run(rng), rng)
    >>> 0.5 <= span[1] - span[0] <= 3.0
    True
    """
    run = drawn.run.recording
    torque, acceleration, pressure = (run[kind] for kind in _CHANNELS)
    # Inaudible sound, of 30 dB re 20 uPa, must not be amplified above the noise.
    if drawn.label == "none" and pressure.std() <= 6e-4:
        pressure = np.zeros_like(pressure)
    if rng.random() < 0.45:  # the sound alone
        clip, span = augmented(pressure, run.rate, rng)
        return replace(clip, condition=run.condition), span
    if rng.random() < 0.3:  # as simulated, in a quiet room
        noise = Acquisition().noise
        rows = [run[kind] + noise[kind] * rng.standard_normal(run[kind].size) for kind in _CHANNELS]
    else:
        rows = [
            *with_sensor_noise(torque, acceleration, rng),
            recorded(pressure, run.rate, rng)[0] * 10.0 ** rng.uniform(-3.0, -0.5),
        ]
    channels = tuple(Channel(kind) for kind in _CHANNELS)
    recording = Recording(np.stack(rows), run.rate, channels, run.condition, calibrated=False)
    return recording, (0.0, run.duration)


def swelling(drawn: Drawn, rng: Rng) -> Drawn:
    """Return a recording with a random modulation of its level, if it has one channel.

    Parameters
    ----------
    drawn : Drawn
    rng : numpy.random.Generator

    Returns
    -------
    Drawn
    """
    recording = drawn.recording
    if len(recording.channels) > 1 or rng.random() < 0.35:
        return drawn
    n, rate = recording.samples.shape[1], recording.rate
    time = np.arange(n) / rate
    depth, speed = rng.uniform(0.0, 8.0), rng.uniform(0.3, 4.0)
    level = depth * wandering(n, rate, speed, rng)
    if rng.random() < 0.5:  # fades out
        start = rng.uniform(0.1, 1.0) * time[-1]
        level -= log_uniform(15.0, 250.0, rng) * np.maximum(time - start, 0.0)
    if rng.random() < 0.35:  # fades in
        end = rng.uniform(0.0, 0.5) * time[-1]
        level -= log_uniform(30.0, 600.0, rng) * np.maximum(end - time, 0.0)
    gain = 10.0 ** (np.maximum(level - level.max(), -80.0) / 20.0)
    return replace(drawn, recording=replace(recording, samples=recording.samples * gain))
