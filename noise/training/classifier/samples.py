"""Samples of the classifier: recordings drawn at random, each with the name of its noise.

Nothing is measured: bushings are simulated and called by their physics
(`noise.noise_definition`), other bodies creak, squawk and squeal by the same mechanisms
(`noise.training.classifier.friction_sources`), background sounds and quiet are recipes. All go
through rooms, microphones, recorders and codecs (`noise.training.classifier.augmentation`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.training.classifier.augmentation.backgrounds import quiet
from noise.training.classifier.augmentation.recorder import augmented
from noise.training.classifier.background_sounds import RECIPES, WEIGHTS, background_sound
from noise.training.classifier.bushing_recordings import bushing_recording
from noise.training.classifier.bushings import random_run
from noise.training.classifier.friction_sources.creaks import CREAKS, creak
from noise.training.classifier.friction_sources.squawks import SQUAWKS, squawk
from noise.training.classifier.friction_sources.squeals import SQUEALS, squeal
from noise.training.classifier.surroundings import may_sound
from noise.training.draws import log_uniform, wandering

_RATE = 48_000.0
"""Sampling rate of friction sources and background sounds [Hz]."""

_FRICTION = {
    **{f"friction:{kind}_creak": ("creak", kind) for kind in CREAKS},
    **{f"friction:{kind}_squeal": ("squeal", kind) for kind in SQUEALS},
    **{f"friction:{kind}_squawk": ("squawk", kind) for kind in SQUAWKS},
}
"""Label and kind by source."""

SHARES = {"bushing": 0.31, "friction": 0.26, "background": 0.30, "quiet": 0.13}
"""Of the samples [-]."""

_LABEL_SHARES = {"creak": 0.42, "squeal": 0.42, "squawk": 0.16}
"""Of the friction sources [-]."""

SOURCES = ("bushing", *_FRICTION, *(f"background:{name}" for name in RECIPES), "quiet")
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


def draw(rng: np.random.Generator, *, bushings: bool = True, surroundings: str = "any") -> Drawn:
    """Draw a sample.

    Parameters
    ----------
    rng : numpy.random.Generator
    bushings : bool
        Whether it may be a simulated bushing, which takes ten times as long as any other.
    surroundings : str
        What else may sound, of `noise.training.classifier.surroundings.SURROUNDINGS`.

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
        heard = {name: w for name, w in WEIGHTS.items() if may_sound(name, surroundings)}
        return draw_from(f"background:{_picked(heard, rng)}", rng)
    if group == "friction":
        label = _picked(_LABEL_SHARES, rng)
        kinds = [source for source, (own, _) in _FRICTION.items() if own == label]
        return draw_from(kinds[int(rng.integers(len(kinds)))], rng)
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
    label, kind = _FRICTION[source]
    make = {"creak": creak, "squeal": squeal, "squawk": squawk}[label]
    return _augmented(make(kind, n, _RATE, rng), label, source, rng)


def _length(rng: np.random.Generator) -> float:
    """Length of a sound [s]: some are just long enough to be looked at."""
    return float(rng.uniform(0.6, 3.0) if rng.random() < 0.6 else rng.uniform(0.6, 1.2))


def _augmented(
    sound: NDArray[np.float64], label: str, source: str, rng: np.random.Generator
) -> Drawn:
    if not sound.any():  # digital silence stays so
        recording = Recording(sound[None, :], _RATE, (Channel("pressure"),), calibrated=False)
        return Drawn(recording, label, None, source, (0.0, recording.duration))
    clip = augmented(sound, _RATE, rng)
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
