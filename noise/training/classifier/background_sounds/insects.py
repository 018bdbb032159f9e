"""Insects and birds: crickets, cicadas, flies; whistles, trills, twitter.

A cricket's chirp is a train of pulses of one carrier, 2 to 8 kHz, each the stroke of a wing: its
carrier is as pure as a squeal's but comes in pulses of 10 to 30 ms, three to five a chirp, or
without end. A bird's whistle is as pure too, but sweeps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from noise.training.classifier.augmentation.backgrounds import coloured_noise
from noise.training.classifier.background_sounds.building import (
    arch,
    harmonics,
    log_uniform,
    repeated,
    resonance,
    voiced,
    wavering,
)
from noise.training.classifier.friction_sources.slider import wandering

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["birds", "cicada", "crickets", "fly"]


def crickets(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """One to six crickets, each with its carrier, pulses and chirps; some trill without end."""
    sound = np.zeros(n)
    for i in range(int(rng.integers(1, 7))):
        one = chirping(
            n,
            rate,
            carrier=log_uniform(2000.0, min(8000.0, 0.4 * rate), rng),
            pulses_a_second=rng.uniform(18.0, 90.0),
            pulses_a_chirp=int(rng.integers(2, 7)) if rng.random() < 0.65 else 10_000,
            chirps_a_second=rng.uniform(1.0, 5.0),
            rng=rng,
        )
        sound += one * (1.0 if i == 0 else rng.uniform(0.02, 0.7))
    return sound


def chirping(
    n: int,
    rate: float,
    *,
    carrier: float,
    pulses_a_second: float,
    pulses_a_chirp: int,
    chirps_a_second: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """One cricket.

    Examples
    --------
    >>> song = chirping(4800, 48e3, carrier=4e3, pulses_a_second=30.0, pulses_a_chirp=3,
    ...                 chirps_a_second=2.0, rng=np.random.default_rng(0))
    >>> song.shape
    (4800,)
    """
    time = np.arange(n) / rate + rng.random()
    pulse = time * pulses_a_second
    place = pulse % 1.0
    duty = rng.uniform(0.35, 0.85)
    inside = np.where(place < duty, np.sin(np.pi * place / duty), 0.0) ** rng.uniform(0.5, 1.5)
    period = max(1, round(pulses_a_second / chirps_a_second))
    if pulses_a_chirp < period:
        inside = inside * ((pulse.astype(int) % period) < pulses_a_chirp)
    sag = 1.0 - rng.uniform(0.0, 0.04) * place
    phase = 2 * np.pi * np.cumsum(carrier * sag * wavering(n, rate, 3.0, 0.004, rng)) / rate
    song = np.sin(phase) + rng.uniform(0.0, 0.15) * np.sin(2.0 * phase) * (carrier < 0.2 * rate)
    return np.asarray(song * inside * wavering(n, rate, 4.0, 0.3, rng))


def cicada(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a band of noise at 3 to 9 kHz that buzzes some hundred times a second, and swells."""
    time = np.arange(n) / rate
    buzz = 1.0 + rng.uniform(0.2, 1.0) * np.sin(2 * np.pi * rng.uniform(60.0, 400.0) * time)
    noise = resonance(rng.standard_normal(n), rng.uniform(3e3, min(9e3, 0.4 * rate)),
                      rng.uniform(200.0, 2500.0), rate)  # fmt: skip
    swell = 1.0 + rng.uniform(0.0, 0.95) * wandering(n, rate, rng.uniform(0.5, 4.0), rng)
    return np.asarray(noise / noise.std() * buzz * swell)


def fly(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Flies, bees, mosquitoes: wings of 100 to 700 beats a second that come near and pass."""
    beats = log_uniform(100.0, 700.0, rng)
    bend = rng.uniform(0.02, 0.2) * wandering(n, rate, rng.uniform(0.7, 6.0), rng)
    sound = harmonics(beats * np.exp(bend), rate, rng.uniform(0.5, 1.5), n_most=25)
    loud = np.exp(rng.uniform(0.3, 2.0) * wandering(n, rate, rng.uniform(0.5, 6.0), rng))
    flutter = 1.0 + rng.uniform(0.0, 0.5) * coloured_noise(n, 1.0, rng)
    return np.asarray(sound * loud * flutter)


def birds(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """One to three birds: whistled sweeps, trills, or harsh twitter."""
    sound = np.zeros(n)
    for i in range(int(rng.integers(1, 4))):
        low = log_uniform(1000.0, min(6500.0, 0.3 * rate), rng)
        fast, harsh = rng.random() < 0.4, rng.random() < 0.25

        def note(
            m: int, low: float = low, fast: bool = fast, harsh: bool = harsh
        ) -> NDArray[np.float64]:
            x = np.linspace(0.0, 1.0, m)
            bend = rng.uniform(-0.8, 0.8) * x + rng.uniform(-0.5, 0.5) * np.sin(np.pi * x)
            if fast or rng.random() < 0.3:
                trill = rng.uniform(15.0, 60.0)
                bend = bend + rng.uniform(0.02, 0.3) * np.sin(2 * np.pi * trill * x * m / rate)
            pitch = np.clip(low * np.exp2(bend), 500.0, 0.45 * rate)
            if harsh:
                call = voiced(m, rate, 0.5 * pitch, (low, 1.7 * low), rng, roughness=0.7)
            else:
                call = harmonics(pitch, rate, rng.uniform(2.0, 5.0), n_most=4)
            return np.asarray(call * arch(m, rng, 0.3))

        lengths = (0.03, 0.15) if fast else (0.06, 0.6)
        part = repeated(n, rate, lengths, (0.01, 0.6), note, rng)
        sound += part * (1.0 if i == 0 else rng.uniform(0.05, 0.7))
    return sound
