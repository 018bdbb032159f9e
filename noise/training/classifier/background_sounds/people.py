"""People: speech, babies, laughter, coughs, sneezes, snoring, breathing, sipping."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from noise.training.classifier.background_sounds.building import (
    arch,
    harmonics,
    placed,
    repeated,
    resonance,
    through_formants,
    voiced,
)
from noise.training.draws import coloured_noise, log_uniform, wandering


def speech(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Syllables: a voice with moving formants, fricatives between."""
    f0 = rng.uniform(75.0, 320.0)
    pitch = f0 * np.exp2(0.35 * wandering(n, rate, rng.uniform(1.0, 4.0), rng))
    voice = harmonics(pitch, rate, rng.uniform(0.4, 1.0), n_most=45)
    voice /= voice.std() + 1e-12
    sound = np.zeros(n)
    start = 0
    while start < n:
        m = min(n - start, int(rng.uniform(0.06, 0.3) * rate))
        part = slice(start, start + m)
        formants = (rng.uniform(250, 900), rng.uniform(900, 2400), rng.uniform(2400, 3500))
        if rng.random() < 0.75:
            sound[part] = through_formants(voice[part], formants, rate, rng)
        else:
            hiss = rng.standard_normal(m)
            sound[part] = 0.4 * resonance(hiss, rng.uniform(2e3, 7e3), 2e3, rate)
        sound[part] *= np.hanning(m) ** 0.7 * rng.uniform(0.2, 1.0)
        start += m + int(rng.uniform(0.0, 0.5) ** 3 * rate)
    return sound


def baby(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Crying: bouts of a clear or pressed voice of 300 to 900 Hz, gasps between."""
    f0 = log_uniform(280.0, 900.0, rng)
    formants = tuple(rng.uniform(0.85, 1.2) * f for f in (1000.0, 2600.0, 4200.0))
    pressed = rng.uniform(0.0, 0.9) if rng.random() < 0.5 else 0.0

    def bout(m: int) -> NDArray[np.float64]:
        x = np.linspace(0.0, 1.0, m)
        bend = rng.uniform(0.1, 0.6) * np.sin(np.pi * x ** rng.uniform(0.4, 1.0)) - 0.3 * x
        shake = 0.02 * np.sin(2 * np.pi * rng.uniform(4.0, 9.0) * x * m / rate)
        pitch = f0 * rng.uniform(0.9, 1.15) * np.exp2(bend + shake)
        sound = voiced(m, rate, pitch, formants, rng, roughness=pressed, breath=0.1)
        return np.asarray(sound * arch(m, rng))

    return repeated(n, rate, (0.35, 1.6), (0.08, 0.5), bout, rng)


def laughing(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Ha-ha: bursts of voice and breath, four to six a second, falling."""
    f0 = log_uniform(130.0, 600.0, rng)
    beat = 1.0 / rng.uniform(3.5, 6.5)

    def ha(m: int) -> NDArray[np.float64]:
        x = np.linspace(0.0, 1.0, m)
        pitch = f0 * np.exp2(rng.uniform(-0.3, 0.5) - rng.uniform(0.0, 0.5) * x)
        sound = voiced(m, rate, pitch, (800.0, 1300.0, 2600.0), rng,
                       roughness=rng.uniform(0.0, 0.5), breath=rng.uniform(0.1, 1.5))  # fmt: skip
        return np.asarray(sound * arch(m, rng))

    return repeated(n, rate, (0.4 * beat, 0.7 * beat), (0.3 * beat, 0.5 * beat), ha, rng)


def cough(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a burst of breath, then a hoarse voice; in twos and threes."""

    def one(m: int) -> NDArray[np.float64]:
        x = np.linspace(0.0, 1.0, m)
        noise = through_formants(rng.standard_normal(m), (700.0, 1500.0, 3000.0), rate, rng)
        noise *= np.exp(-x / rng.uniform(0.08, 0.3)) / (np.abs(noise).max() + 1e-12)
        pitch = rng.uniform(120.0, 400.0) * np.exp2(-0.4 * x)
        voice = voiced(m, rate, pitch, (600.0, 1400.0), rng, roughness=0.9, breath=1.0)
        return np.asarray(noise + rng.uniform(0.0, 0.8) * voice * arch(m, rng, 0.4))

    return repeated(n, rate, (0.15, 0.5), (0.05, 0.8), one, rng)


def sneeze(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Drawn breath, then a sharp burst with a voice that falls."""

    def one(m: int) -> NDArray[np.float64]:
        x = np.linspace(0.0, 1.0, m)
        at = rng.uniform(0.2, 0.5)
        drawn = 0.15 * coloured_noise(m, 0.5, rng) * np.clip(x / at, 0.0, 1.0) * (x < at)
        burst = np.exp(-np.maximum(x - at, 0.0) / rng.uniform(0.05, 0.2)) * (x >= at)
        noise = resonance(rng.standard_normal(m), rng.uniform(1.5e3, 5e3), 3e3, rate)
        voice = voiced(m, rate, rng.uniform(200.0, 900.0) * np.exp2(-1.2 * np.maximum(x - at, 0)),
                       (900.0, 1900.0), rng, roughness=0.3, breath=0.5)  # fmt: skip
        noise = noise / (np.abs(noise).max() + 1e-12)
        return np.asarray(drawn + burst * (noise + rng.uniform(0.0, 1.2) * voice))

    return repeated(n, rate, (0.5, 1.4), (0.3, 1.0), one, rng)


def snoring(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw the palate flaps 20 to 120 times a second, irregularly, in time with the breath."""

    def one(m: int) -> NDArray[np.float64]:
        pace = rng.uniform(20.0, 120.0)
        gaps = rng.gamma(1.0 / rng.uniform(0.02, 0.3) ** 2, size=int(2 * pace * m / rate) + 4)
        times = np.cumsum(gaps / gaps.mean() / pace)
        hits = placed(m, times, rng.lognormal(0.0, 0.4, times.size), rate)
        flap = resonance(hits, rng.uniform(100.0, 600.0), rng.uniform(80.0, 400.0), rate)
        flap /= np.abs(flap).max() + 1e-12
        flap = through_formants(flap, (400.0, 1000.0, 2300.0), rate, rng)
        breath = rng.uniform(0.05, 1.0) * resonance(rng.standard_normal(m), 900.0, 1200.0, rate)
        envelope = np.sin(np.pi * np.linspace(0.0, 1.0, m)) ** 0.7
        sound = (flap / (flap.std() + 1e-12) + breath / (breath.std() + 1e-12) * rng.random()) * (
            envelope
        )
        return np.asarray(sound / (np.abs(sound).max() + 1e-12))

    return repeated(n, rate, (0.6, 1.8), (0.2, 1.2), one, rng)


def breathing(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Breaths: noise through a throat, in and out."""

    def one(m: int) -> NDArray[np.float64]:
        noise = through_formants(rng.standard_normal(m), (600.0, 1500.0, 3500.0), rate, rng)
        return np.asarray(noise / (noise.std() + 1e-12) * np.hanning(m))

    return repeated(n, rate, (0.4, 1.6), (0.1, 0.8), one, rng)


def sipping(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Slurps: noise that bubbles, with a resonance that rises as the cup empties."""

    def one(m: int) -> NDArray[np.float64]:
        bubbles = np.maximum(coloured_noise(m, 0.0, rng), 0.0)
        bubbles = resonance(bubbles, rng.uniform(20.0, 60.0), 40.0, rate)
        gate = np.abs(bubbles) / (np.abs(bubbles).max() + 1e-12)
        noise = resonance(rng.standard_normal(m), rng.uniform(800.0, 4e3), 1500.0, rate)
        return np.asarray(noise / (noise.std() + 1e-12) * (0.1 + gate) * arch(m, rng, 0.5))

    return repeated(n, rate, (0.2, 1.2), (0.2, 1.5), one, rng)


RECIPES = (baby, breathing, cough, laughing, sipping, sneeze, snoring, speech)
"""Each takes the number of samples, the rate [Hz] and a generator."""
