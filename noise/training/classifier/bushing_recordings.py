"""Recordings of simulated bushings: by anybody's microphone, or on a rig's three channels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.recording import Channel, Recording
from noise.training.classifier.augmentation.recorder import augmented, recorded
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
