"""Population of rigs, conditions and recordings for which the inferred intervals hold.

An interval of 90 % is a statement about a population. Here it consists of fluorocarbon bushings
whose stiffness, torques, inertia and friction scatter by 3 % about the shipped rig's, like
specimens; an interference of 0.15-0.42 mm; supports of 1000-10000 Nm/rad, or the bolted clamp;
0.1-15 rad/s; and runs with a creak, squawk or squeal. The wider scatter of
`noise.training.classifier.designs` would widen the intervals, because the rate of a creak depends
on speed and torque.

Each run is recorded twice. On the *rig*, samples are calibrated, the microphone is at its place in
the thesis, and levels depend on the torque. In the *field*, nothing is calibrated, and there are a
room, another microphone, noise and other sampling rates. Room and noise are simpler than those of
the classifier, and the microphone is its free one (`noise.training.classifier.augmentation`), so
that the population does not change with the classifier.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from features.recording import recording_features
from models.condition import FIXED
from models.recording import Channel, Recording
from models.rig import LawSpec, Rig
from models.rig_file import load_material_rig
from noise.inference.inputs import (
    INTERFERENCE_RANGE,
    LONGEST,
    MATERIAL,
    RATES,
    SHORTEST,
    SPEED_RANGE,
    SUPPORT_RANGE,
    scaled,
)
from noise.noise_definition import label_by_physics
from noise.training.classifier.augmentation.recorder import (
    resampled,
    through_a_microphone,
    with_sensor_noise,
)
from noise.training.classifier.designs import SHAPES, scaled as scaled_fit
from noise.training.draws import coloured_noise, log_uniform
from sim.run import Run, simulate


def recorded(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
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


def _in_a_room(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return a sound with a diffuse tail that decays exponentially."""
    t60 = rng.uniform(0.1, 0.8)
    n = int(min(t60, 0.6) * rate)
    time = np.arange(n) / rate
    tail = rng.standard_normal(n) * 10.0 ** (-3.0 * time / t60)
    tail[: int(rng.uniform(0.002, 0.01) * rate)] = 0.0
    tail *= 10.0 ** (rng.uniform(-20.0, 0.0) / 20.0) / math.sqrt(float(np.sum(tail**2)))
    tail[0] = 1.0
    return np.asarray(fftconvolve(sound, tail)[: sound.size])


_FIXED_SHARE = 0.25
_SCATTER = 0.03
_GAIN_SCATTER = 0.03
"""Scatter of the gains of calibrations [-]."""


@dataclass(frozen=True, eq=False)
class RunSample:
    """Features of one audible run, with its label and condition.

    Parameters
    ----------
    label : str
        Noise by physics (`noise.noise_definition`).
    scaled : ndarray, shape (3,)
        Condition, as from `noise.inference.inputs.scaled` [-, mm, -].
    features : tuple of (mapping of str to float)
        In the field, and on the rig [unit of each feature].
    """

    label: str
    scaled: NDArray[np.float64]
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


def _draw_run(rng: np.random.Generator) -> Run:
    low, high = SPEED_RANGE
    # Log-uniform for slow creaks, and uniform for the boundary of squawk and squeal.
    even = rng.random() < 0.5
    speed = rng.uniform(low, high) if even else log_uniform(low, high, rng)
    softest, stiffest = SUPPORT_RANGE
    support = log_uniform(softest, stiffest, rng)
    if rng.random() < _FIXED_SHARE:
        support = FIXED
    return simulate(
        _specimen(rng),
        float(speed),
        interference=float(rng.uniform(*INTERFERENCE_RANGE)),
        support_stiffness=support,
        seconds=LONGEST,
        rng=rng,
    )


def _specimen(rng: np.random.Generator) -> Rig:
    rig = load_material_rig(MATERIAL)

    def about(value: float) -> float:
        return value * math.exp(rng.normal(0.0, _SCATTER))

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


def _on_the_rig(run: Run, rng: np.random.Generator) -> Recording:
    """Return the recording at its own sampling rate or at another one of loggers."""
    recording = run.recording
    rate = recording.rate if rng.random() < 0.5 else float(rng.choice(RATES[1:]))
    kinds = ("torque", "acceleration", "pressure")
    gains = np.exp(rng.normal(0.0, _GAIN_SCATTER, (len(kinds), 1)))
    samples = gains * [resampled(recording[kind], recording.rate, rate) for kind in kinds]
    return Recording(samples, rate, tuple(Channel(kind) for kind in kinds))


def _in_the_field(run: Run, rng: np.random.Generator) -> Recording:
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
