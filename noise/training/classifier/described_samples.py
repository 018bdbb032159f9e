"""Samples to learn from: what was drawn, described where its label holds and something sounds.

Samples of the classifier: recordings drawn at random, each with the name of its noise.

Nothing is measured: bushings are simulated and called by their physics
(`noise.noise_definition`), other bodies creak, squawk and squeal by the same mechanisms
(`noise.training.classifier.friction_sources`), background sounds and quiet are recipes. All go
through rooms, microphones, recorders and codecs (`noise.training.classifier.augmentation`).

Recordings of simulated bushings: by anybody's microphone, or on a rig's three channels.

Creaks of doors, floors, trees, hinges and panels: slips that strike a body.

Each slip of `noise.training.classifier.friction_sources.slider` lets go of a force in proportion to
its size, as a pulse of half a sine, 0.03 to 0.5 ms long, with the rattle of its asperities; the
body (`noise.training.classifier.friction_sources.modal_body`) rings from it. Two contacts may creak
at once, and the sliding between hisses softly.

Squawks: several discrete frequencies, sustained, as `noise.noise_definition` defines them.

- chatter: a slider on a spring at a steady drive sticks and slips some 60 to 500 times a second,
  and the sawtooth of its force, whose harmonics lie within 18 dB of the first, is heard through a
  body that is damped too well to knock.
- modes: friction feeds two to five modes at once, none of which wins, with harmonics.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from features.windows.table import HOP, LENGTH
from models.blocks import RecordingBlocks
from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.labels.windows import window_features
from noise.training.classifier.augmentation.backgrounds import quiet
from noise.training.classifier.augmentation.recorder import augmented, recorded
from noise.training.classifier.background_sounds import RECIPES, WEIGHTS, background_sound
from noise.training.classifier.bushings import random_run
from noise.training.classifier.friction_sources.limit_cycle import (
    ENVELOPE_RATE,
    amplitudes,
    carried,
)
from noise.training.classifier.friction_sources.modal_body import (
    ModalBody,
    overlapping_modes,
    random_body,
)
from noise.training.classifier.friction_sources.slider import Slips, random_drive, slide
from noise.training.classifier.friction_sources.squeals import SQUEALS, squeal
from noise.training.classifier.surroundings import may_sound
from noise.training.draws import coloured_noise, log_uniform, wandering
from sim.acquisition import Acquisition

if TYPE_CHECKING:
    from noise.training.classifier.bushings import LabelledRun

SQUAWKS = ("chatter", "modes")
"""What squawks."""


def squawk(kind: str, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a squawk of unit peak.

    Parameters
    ----------
    kind : str
        One of `SQUAWKS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> sound = squawk("chatter", 24_000, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((24000,), 1.0)
    """
    sound = _chatter(n, rate, rng) if kind == "chatter" else _modes(n, rate, rng)
    hiss = coloured_noise(n, rng.uniform(0.2, 1.5), rng)
    sound = sound + float(sound.std()) * 10.0 ** (rng.uniform(-40.0, -10.0) / 20.0) * hiss
    return np.asarray(sound / np.abs(sound).max())


def _chatter(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    slips_a_second = log_uniform(60.0, 500.0, rng)
    drive = np.full(n, slips_a_second)
    drive *= 1.0 + rng.uniform(0.0, 0.03) * wandering(n, rate, rng.uniform(0.5, 5.0), rng)
    slips = slide(
        drive,
        rate,
        ageing_time=rng.uniform(0.02, 0.1) / slips_a_second,
        scatter=rng.uniform(0.0, 0.04),
        rng=rng,
    )
    # The spring's force: it rises with the drive and falls at each slip, in a millisecond or so.
    force = np.cumsum(drive) / rate
    fallen = np.zeros(n)
    np.add.at(fallen, np.minimum((slips.time * rate).astype(int), n - 1), slips.size)
    m = max(2, int(rng.uniform(0.03, 0.25) / slips_a_second * rate))
    fall = np.hanning(m + 2)[1:-1]
    force -= np.cumsum(fftconvolve(fallen, fall / fall.sum())[:n])
    body = ModalBody(
        np.exp(rng.uniform(math.log(120.0), math.log(2500.0), int(rng.integers(3, 9)))),
        rng.uniform(0.08, 0.3, 1),
        np.ones(1),
    )
    # Broad resonances over the force itself: no blow rings on until the next.
    response = ModalBody(
        body.frequency,
        np.broadcast_to(body.damping_ratio, body.frequency.shape),
        rng.standard_normal(body.frequency.size),
    ).impulse_response(rate)
    through = fftconvolve(np.gradient(force), response)[:n]
    direct = np.gradient(force)
    return np.asarray(
        through / (through.std() + 1e-12) + rng.uniform(0.2, 1.0) * direct / (direct.std() + 1e-12)
    )


def _modes(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    n_modes = int(rng.integers(2, 6))
    m = int(n / rate * ENVELOPE_RATE) + 2
    frequency = np.exp(rng.uniform(math.log(110.0), math.log(2200.0), n_modes))
    pace = 2.0 * np.pi * frequency * rng.uniform(0.003, 0.03)
    wander = [wandering(m, ENVELOPE_RATE, rng.uniform(0.5, 4.0), rng) for _ in range(n_modes)]
    growth = pace[:, None] * (1.0 + 0.2 * np.array(wander))
    detuning = 2.0 * np.pi * frequency[:, None] * rng.uniform(0.0, 0.01) * np.array(wander)
    weak = rng.uniform(0.0, 0.3)
    coupling = pace[:, None] * (np.eye(n_modes) * (1.0 - weak) + weak)
    noise = rng.uniform(0.02, 0.4) * np.sqrt(pace)
    solved = amplitudes(growth, detuning, coupling, noise, rng)
    sound = np.zeros(n)
    for i in range(n_modes):
        fall = rng.uniform(-25.0, -6.0)
        harmonics = np.power(10.0, fall * np.arange(float(rng.integers(1, 5))) / 20.0)
        strength = 10.0 ** (rng.uniform(-12.0, 0.0) / 20.0)
        sound += strength * carried(solved[i], float(frequency[i]), harmonics, n, rate)
    return sound


CREAKS = ("door", "floor", "tree", "hinge", "plastic")
"""What creaks; the names of its materials."""

_FASTEST = {"door": 350.0, "floor": 200.0, "tree": 300.0, "hinge": 500.0, "plastic": 250.0}
"""Of the slips' rates, where the drive is fast [1/s]."""


def creak(material: str, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return `n` samples of a creak of unit peak.

    Parameters
    ----------
    material : str
        One of `CREAKS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> sound = creak("door", 24_000, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((24000,), 1.0)
    """
    sound = np.zeros(n)
    for _ in range(2 if rng.random() < 0.2 else 1):
        slips = random_slips(material, n, rate, rng)
        force = pulses(slips, n, rate, rng)
        parts = [_unit(random_body(material, rng).impulse_response(rate))]
        parts.append(10.0 ** (rng.uniform(-25.0, 20.0) / 20.0) * overlapping_modes(rate, rng))
        if rng.random() < 0.4:  # what it is fixed to sounds as well
            other = random_body(CREAKS[int(rng.integers(len(CREAKS)))], rng)
            parts.append(rng.uniform(0.1, 1.0) * _unit(other.impulse_response(rate)))
        body = np.zeros(max(part.size for part in parts))
        for part in parts:
            body[: part.size] += part
        struck = fftconvolve(force, body)[:n]
        # The contact itself is heard as well, as a click without a body's voice.
        click = np.diff(force, prepend=0.0)
        direct = 10.0 ** (rng.uniform(-30.0, 0.0) / 20.0) * float(np.abs(struck).max())
        struck = struck + direct * click / (np.abs(click).max() + 1e-300)
        peak = float(np.abs(struck).max())
        sound += rng.uniform(0.4, 1.0) * struck / peak if peak > 0.0 else 0.0
    level = float(np.abs(sound).max()) * 10.0 ** rng.uniform(-4.0, -1.6)
    sound = sound + level * coloured_noise(n, rng.uniform(0.3, 1.5), rng)
    return np.asarray(sound / np.abs(sound).max())


def _unit(response: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(response / np.abs(response).max())


def random_slips(material: str, n: int, rate: float, rng: np.random.Generator) -> Slips:
    """Draw a drive and a contact, and find their slips; at least eight a second on the whole.

    The rate is in Hz [1/s].

    Examples
    --------
    >>> slips = random_slips("tree", 48_000, 48e3, np.random.default_rng(1))
    >>> slips.time.size >= 8
    True
    """
    while True:
        fastest = _FASTEST[material] * math.exp(rng.uniform(-1.6, 0.3))
        slowest = max(4.0, fastest * math.exp(-rng.uniform(0.7, 4.0)))
        if slowest > 0.7 * fastest:
            continue
        drive = random_drive(n, rate, slowest, fastest, rng)
        slips = slide(
            drive,
            rate,
            ageing_time=log_uniform(3e-4, 3e-2, rng),
            scatter=log_uniform(0.02, 0.35, rng),
            rng=rng,
        )
        if slips.time.size >= 8.0 * n / rate and slips.time.size < 900.0 * n / rate:
            return slips


def pulses(slips: Slips, n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Force of the slips: pulses of random strength about their size, with a rattle.

    Parameters
    ----------
    slips : Slips
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> slips = Slips(np.array([0.01]), np.array([1.0]))
    >>> force = pulses(slips, 960, 48e3, np.random.default_rng(0))
    >>> bool(np.abs(force[:470]).max() < 1e-9), bool(force.max() > 0.0)
    (True, True)
    """
    strength = slips.size ** rng.uniform(0.6, 1.6) * np.exp(
        rng.normal(0.0, rng.uniform(0.02, 0.5), slips.size.size)
    )
    place = slips.time * rate
    first = np.clip(place.astype(int), 0, n - 2)
    part = np.clip(place - first, 0.0, 1.0)
    train = np.zeros(n)
    np.add.at(train, first, strength * (1.0 - part))
    np.add.at(train, first + 1, strength * part)
    m = max(2, int(log_uniform(3e-5, 5e-4, rng) * rate))
    shape = np.sin(np.pi * (np.arange(m) + 0.5) / m)
    rattle = rng.standard_normal(4 * m) * np.exp(-np.arange(4 * m) / m)
    shape = np.concatenate([shape, np.zeros(3 * m)]) + rng.uniform(0.0, 0.8) * rattle
    return np.asarray(fftconvolve(train, shape)[:n])


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


_QUIET_DB = 30.0
"""Windows that lie so far below a sample's loudest are pauses, of which nothing is learned."""

_OUTSIDE = 0.2
"""How far a window may reach beyond the time for which the label holds [s]."""


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


def draw_sample(
    seed: np.random.SeedSequence, *, bushings: bool = True, surroundings: str = "any"
) -> Sample:
    """Draw one sample and describe the part of it where its label holds.

    It is no simulated bushing unless `bushings`.
    """
    (other,) = seed.spawn(1)
    drawn = draw(np.random.default_rng(seed), bushings=bushings, surroundings=surroundings)
    return describe_drawn(swelling(drawn, np.random.default_rng(other)))


def describe_drawn(drawn: Drawn) -> Sample:
    """Describe the windows of a drawn recording in which its label holds and something sounds."""
    found = window_features(RecordingBlocks.of(drawn.recording))
    start = np.arange(len(found.features)) * HOP
    outside = np.maximum(drawn.span[0] - start, 0.0) + np.maximum(
        np.minimum(start + LENGTH, drawn.recording.duration) - drawn.span[1], 0.0
    )
    kept = (outside <= _OUTSIDE) & (found.level > found.level.max() - _QUIET_DB)
    kept[np.argmin(outside - 1e-6 * found.level)] |= not kept.any()
    return Sample(found.features[kept], drawn.label, drawn.ambiguous, drawn.source)
