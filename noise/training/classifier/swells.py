"""Sounds that swell and die away, as those of a hand, a passing car or a cutting table do.

What a simulated machine does for a second it does evenly; whoever opens a door, or cuts the
recording of it, does not. All that a microphone alone records, background sounds too, gets a course
of level of its own, so that a level that changes says nothing about what sounds.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from noise.training.draws import log_uniform, wandering

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from noise.training.classifier.samples import Drawn

__all__ = ["swelling"]

_EVEN = 0.35
"""Share of the samples that stay as they are."""

_FADES_OUT, _FADES_IN = 0.5, 0.35
_LOWEST = -80.0
"""Where a fade ends [dB]."""


def swelling(drawn: Drawn, rng: np.random.Generator) -> Drawn:
    """Return a sample with a course of level; one of several channels stays as it is.

    Examples
    --------
    >>> from noise.training.classifier.samples import draw_from
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
