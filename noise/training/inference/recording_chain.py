"""Recording chain between a bushing and the recordings that the inferred intervals hold for.

Room, microphone and noise are simpler here than the classifier's
(`noise.training.classifier.augmentation`): to be called by its name a sound has to be known through
a telephone too, but an interval of 90 % is a statement about one population, and stays what it was
when the classifier learns to know more.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft, rfftfreq
from scipy.signal import fftconvolve

from noise.training.draws import coloured_noise, log_uniform


def recorded(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Record a sound in some room through some microphone, with some noise.

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
        Of unit standard deviation [-] or, where the sound is zero, noise alone.
    """
    signal = _in_a_room(sound, rate, rng) if rng.random() < 0.7 else sound
    signal = _through_a_microphone(signal, rate, rng)
    level = float(signal.std())
    snr = rng.uniform(6.0, 50.0) if rng.random() < 0.8 else 60.0
    noise = coloured_noise(signal.size, rng.uniform(0.0, 2.0), rng)
    noise_level = level * 10.0 ** (-snr / 20.0) if level > 0.0 else 1.0
    signal = signal + noise_level * noise
    return np.asarray(signal / signal.std())


def _in_a_room(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Add a diffuse tail that decays exponentially, higher frequencies faster."""
    t60 = rng.uniform(0.1, 0.8)
    n = int(min(t60, 0.6) * rate)
    time = np.arange(n) / rate
    tail = rng.standard_normal(n) * 10.0 ** (-3.0 * time / t60)
    tail[: int(rng.uniform(0.002, 0.01) * rate)] = 0.0
    tail *= 10.0 ** (rng.uniform(-20.0, 0.0) / 20.0) / math.sqrt(float(np.sum(tail**2)))
    tail[0] = 1.0
    return np.asarray(fftconvolve(sound, tail)[: sound.size])


def _through_a_microphone(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Colour by first-order slopes at both ends of the band and a gentle ripple between."""
    frequency = rfftfreq(sound.size, 1.0 / rate)
    low = log_uniform(15.0, 250.0, rng)
    high = log_uniform(5e3, 20e3, rng)
    gain = 1.0 / np.sqrt(
        (1.0 + (low / np.maximum(frequency, 1.0)) ** 2) * (1.0 + (frequency / high) ** 2)
    )
    octaves = np.log2(np.maximum(frequency, 20.0) / 1e3)
    gain *= 10.0 ** (
        rng.uniform(0.0, 4.0)
        / 20.0
        * np.sin(rng.uniform(1.0, 4.0) * octaves + rng.uniform(0.0, 6.3))
    )
    return np.asarray(irfft(rfft(sound) * gain, sound.size))
