"""Music: chords, plucked and struck notes, bowed and blown ones with vibrato, drums."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from noise.training.classifier.background_sounds.building import blow, harmonics, log_uniform

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["music"]


def music(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw notes of the tempered scale on a beat, decaying or held, now and then over drums."""
    sound = np.zeros(n)
    beat = log_uniform(0.1, 0.7, rng)
    held = rng.random() < 0.5
    roll_off = rng.uniform(0.7, 2.5)
    low, n_notes = int(rng.integers(0, 30)), int(rng.integers(1, 5))
    start = 0
    while start < n:
        length = beat * float(rng.choice((1, 1, 2, 4)))
        m = min(n - start, int((length if held else length + 1.0) * rate))
        time = np.arange(m) / rate
        for _ in range(n_notes):
            pitch = 55.0 * 2.0 ** ((low + rng.integers(0, 30)) / 12.0)
            if held:
                vibrato = rng.uniform(0.0, 0.012) * np.sin(2 * np.pi * rng.uniform(4.5, 7) * time)
                rise = np.minimum(1.0, np.minimum(time, time[::-1]) / rng.uniform(0.01, 0.08))
                note = rise * harmonics(pitch * (1.0 + vibrato), rate, roll_off, n_most=20)
            else:
                note = np.exp(-time / rng.uniform(0.08, 1.2)) * harmonics(
                    np.full(m, pitch), rate, roll_off, n_most=20
                )
            sound[start : start + m] += note
        start += int(length * rate)
    if rng.random() < 0.4:
        for at in np.arange(0.0, n / rate, beat):
            hit = blow(rate, (60.0, 5000.0), (0.01, 0.08), rng, noise=4.0)[: n - int(at * rate)]
            first = int(at * rate)
            sound[first : first + hit.size] += hit * rng.uniform(0.3, 2.0)
    return sound
