"""Samples that the classifier learns from: recordings drawn at random, each with its label.

Nothing is measured: bushings are simulated and called by their physics
(`noise.noise_definition`), other bodies creak, squawk and squeal by the same mechanisms
(`noise.training.classifier.friction_sources`), background sounds and quiet are recipes. All go
through rooms, microphones, recorders and codecs (`noise.training.classifier.augmentation`). A
sample is described where its label holds and something sounds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from features.windows.table import HOP, LENGTH
from models.blocks import RecordingBlocks
from models.recording import Channel, Recording
from noise.labels.windows import window_features
from noise.training.classifier.augmentation.backgrounds import quiet
from noise.training.classifier.augmentation.recorder import augmented, recorded, with_sensor_noise
from noise.training.classifier.background_sounds import WEIGHTS, background_sound
from noise.training.classifier.bushings import LabelledRun, random_run
from noise.training.classifier.friction_sources.friction_sounds import (
    FRICTION_SOUNDS,
    friction_sound,
)
from noise.training.draws import log_uniform, picked, wandering
from sim.acquisition import Acquisition

_CHANNELS = ("torque", "acceleration", "pressure")

_PRESSURE_ALONE = 0.45
"""Share of the bushings of which the sound alone is left; the others have all three channels."""

_AS_COMPUTED = 0.3
"""Share of those with three channels that are what the simulation gives, in a quiet room."""

_QUIET_ROOM = Acquisition().noise

_AUDIBLE = 6e-4
"""Standard deviation of what a sensor adds by itself, 30 dB re 20 uPa [Pa]."""

_RATE = 48_000.0
"""Sampling rate of friction sources and background sounds [Hz]."""

SHARES = {"bushing": 0.31, "friction": 0.26, "background": 0.30, "quiet": 0.13}
"""Of the samples [-]."""

_LABEL_SHARES = {"creak": 0.41, "squeal": 0.41, "squawk": 0.18}
"""Of the friction sources [-]."""

SOURCES = (
    "bushing",
    *(f"friction:{name}" for name in FRICTION_SOUNDS),
    *(f"background:{name}" for name in WEIGHTS),
    "quiet",
)
"""All that is drawn from."""

_EVEN = 0.35
"""Share of the samples whose level has no course of its own."""

_FADES_OUT, _FADES_IN = 0.5, 0.35
_LOWEST = -80.0
"""Where a fade ends [dB]."""

_QUIET_DB = 30.0
"""Windows that lie so far below a sample's loudest are pauses, of which nothing is learned."""

_OUTSIDE = 0.2
"""How far a window may reach beyond the time for which the label holds [s]."""

_OF_EVENT = 0.9
"""Share of a short event that lies in a window of it [-]."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A labelled recording.

    Parameters
    ----------
    recording : Recording
        Pressure alone, or all three channels, as somebody would have recorded it.
    label : str
        creak, squawk, squeal, none or unknown.
    source : str
        One of `SOURCES`.
    span : tuple of float
        From when to when the label holds within the recording [s].
    ambiguous : bool
        Whether the label hangs on a bound of its definition.
    """

    recording: Recording
    label: str
    source: str
    span: tuple[float, float]
    ambiguous: bool = False


@dataclass(frozen=True, eq=False)
class Sample:
    """Windows of one sound with one label.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `noise.labels.windows.FEATURE_NAMES` [unit of each feature].
    label : str
    source : str
        Where it is from, as `Drawn` has it, or who recorded it; samples of one source are left out
        together.
    weight : float
        Simulated samples that it counts as [-].
    kind : str
        Of a real sound, what sounds, in words.
    real, varied : bool
        Whether it was recorded in the world, and whether it is a variation of such a sound: then it
        is learned from and neither calibrates nor is scored.
    ambiguous : bool
        Whether the label hangs on a bound of its definition.
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
    """Draw one sample, and describe it.

    Parameters
    ----------
    seed : numpy.random.SeedSequence
    bushings : bool
        As of `draw`.
    """
    (other,) = seed.spawn(1)
    drawn = draw(np.random.default_rng(seed), bushings=bushings)
    return described(swelling(drawn, np.random.default_rng(other)))


def described(drawn: Drawn) -> Sample:
    """Describe the windows of a recording in which its label holds and something sounds."""
    windows = window_features(RecordingBlocks.of(drawn.recording))
    start = np.arange(len(windows.features)) * HOP
    end = np.minimum(start + LENGTH, drawn.recording.duration)
    inside = np.minimum(end, drawn.span[1]) - np.maximum(start, drawn.span[0])
    # Of a window that holds a short event all but that is left aside as it is described.
    enough = np.minimum(end - start - _OUTSIDE, _OF_EVENT * (drawn.span[1] - drawn.span[0]))
    chosen = (inside >= enough) & (windows.level > windows.level.max() - _QUIET_DB)
    chosen[np.argmax(inside + 1e-6 * windows.level)] |= not chosen.any()
    return Sample(windows.features[chosen], drawn.label, drawn.source, ambiguous=drawn.ambiguous)


def draw(rng: np.random.Generator, *, bushings: bool = True) -> Drawn:
    """Draw a labelled recording.

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
    group = picked({g: share for g, share in SHARES.items() if bushings or g != "bushing"}, rng)
    if group == "background":
        return draw_from(f"background:{picked(WEIGHTS, rng)}", rng)
    if group == "friction":
        label = picked(_LABEL_SHARES, rng)
        rows = {n: row["weight"] for n, row in FRICTION_SOUNDS.items() if row["label"] == label}
        return draw_from(f"friction:{picked(rows, rng)}", rng)
    return draw_from(group, rng)


def draw_from(source: str, rng: np.random.Generator) -> Drawn:
    """Draw a labelled recording from one of `SOURCES`.

    Examples
    --------
    >>> draw_from("friction:door_creak", np.random.default_rng(0)).label
    'creak'
    """
    if source == "bushing":
        run = random_run(rng)
        recording, span = bushing_recording(run, rng)
        return Drawn(recording, run.label, source, span, run.ambiguous)
    # Some are just long enough to be looked at.
    seconds = rng.uniform(0.6, 3.0) if rng.random() < 0.6 else rng.uniform(0.6, 1.2)
    n = int(seconds * _RATE)
    group, _, name = source.partition(":")
    if group == "friction":
        made = friction_sound(name, n, _RATE, rng)
        clip, span = sound_recording(made.samples, _RATE, rng, span=made.span)
        return Drawn(clip, made.label, source, span, made.ambiguous)
    sound = quiet(n, _RATE, rng) if group == "quiet" else background_sound(n, _RATE, rng, name)
    label = "none" if group == "quiet" else "unknown"
    if not sound.any():  # digital silence stays so
        return Drawn(_of_sound(sound, _RATE), label, source, (0.0, n / _RATE))
    clip, span = sound_recording(sound, _RATE, rng)
    return Drawn(clip, label, source, span)


def bushing_recording(
    drawn: LabelledRun, rng: np.random.Generator
) -> tuple[Recording, tuple[float, float]]:
    """Record a run by anybody's microphone, or by the rig's computer on three channels.

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
    >>> rng = np.random.default_rng(5)
    >>> recording, span = bushing_recording(random_run(rng), rng)
    >>> 0.5 <= span[1] - span[0] <= 3.0
    True
    """
    run = drawn.run.recording
    torque, acceleration, pressure = (run[kind] for kind in _CHANNELS)
    # What is below hearing shall not be lifted above the noise again.
    if drawn.label == "none" and pressure.std() <= _AUDIBLE:
        pressure = np.zeros_like(pressure)
    if rng.random() < _PRESSURE_ALONE:
        clip, span = sound_recording(pressure, run.rate, rng)
        return replace(clip, condition=run.condition), span
    if rng.random() < _AS_COMPUTED:
        rows = [
            run[kind] + _QUIET_ROOM[kind] * rng.standard_normal(run[kind].size)
            for kind in _CHANNELS
        ]
    else:
        rows = [
            *with_sensor_noise(torque, acceleration, rng),
            recorded(pressure, run.rate, rng)[0] * 10.0 ** rng.uniform(-3.0, -0.5),
        ]
    channels = tuple(Channel(kind) for kind in _CHANNELS)
    recording = Recording(np.stack(rows), run.rate, channels, run.condition, calibrated=False)
    return recording, (0.0, run.duration)


def sound_recording(
    sound: NDArray[np.float64],
    rate: float,
    rng: np.random.Generator,
    *,
    span: tuple[float, float] | None = None,
) -> tuple[Recording, tuple[float, float]]:
    """Record a sound as anybody might; arguments as of `augmented`.

    Returns
    -------
    recording : Recording
        One uncalibrated channel of pressure.
    span : tuple of float
        From when to when the sound lasts in it [s].
    """
    clip = augmented(sound, rate, rng, span=span)
    return _of_sound(clip.samples, float(clip.rate)), clip.span


def _of_sound(samples: NDArray[np.float64], rate: float) -> Recording:
    return Recording(samples[None, :], rate, (Channel("pressure"),), calibrated=False)


def swelling(drawn: Drawn, rng: np.random.Generator) -> Drawn:
    """Return a recording with a course of level; one of several channels stays as it is.

    Parameters
    ----------
    drawn : Drawn
    rng : numpy.random.Generator

    Returns
    -------
    Drawn
    """
    recording = drawn.recording
    if len(recording.channels) > 1 or rng.random() < _EVEN:
        return drawn
    n, rate = recording.samples.shape[1], recording.rate
    time = np.arange(n) / rate
    depth, speed = rng.uniform(0.0, 8.0), rng.uniform(0.3, 4.0)
    level = depth * wandering(n, rate, speed, rng)
    if rng.random() < _FADES_OUT:
        start = rng.uniform(0.1, 1.0) * time[-1]
        level -= log_uniform(15.0, 250.0, rng) * np.maximum(time - start, 0.0)
    if rng.random() < _FADES_IN:
        end = rng.uniform(0.0, 0.5) * time[-1]
        level -= log_uniform(30.0, 600.0, rng) * np.maximum(end - time, 0.0)
    gain = 10.0 ** (np.maximum(level - level.max(), _LOWEST) / 20.0)
    return replace(drawn, recording=replace(recording, samples=recording.samples * gain))
