"""Recording chain of the augmentation: room, noise, microphone, rate, gain, codec and cut."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import resample_poly

from noise.training.classifier.augmentation.backgrounds import background
from noise.training.classifier.augmentation.codecs import coded, quantised
from noise.training.classifier.augmentation.microphones import (
    clipped,
    levelled,
    through_a_microphone,
)
from noise.training.classifier.augmentation.places import a_weighted, in_a_place, place
from noise.training.classifier.augmentation.rooms import in_a_room

RATES = (16_000, 22_050, 30_000, 32_000, 44_100, 48_000, 96_000)
"""Sampling rates that recordings come in [Hz]."""

_LOW_RATES = (8_000, 11_025, 12_000)
"""Those of telephones and of files made small [Hz]."""

_LOW = 0.12
"""Share of the clips that come in one of them, where enough of the sound is left [-]."""

_LEFT = 0.5
"""Share of the A-weighted power that is enough [-]."""

_IN_A_PLACE = 0.5
"""Share of the clips that are recorded where an engineer would [-]."""

_SNR = (-15.0, 30.0)
"""How far a sound lies above the place that it is heard in [dB(A)]."""

_KINDS = {"free": 0.62, "phone": 0.28, "pocket": 0.05, "stethoscope": 0.05}
"""Shares of the microphones [-]."""

_LONGEST = 5.0
"""Of a clip with what is before and after the sound [s]."""


@dataclass(frozen=True, eq=False)
class RecordedSound:
    """A sound as it was recorded.

    Parameters
    ----------
    samples : ndarray, shape (n,)
        In fractions of full scale [-].
    rate : int
        Sampling rate [Hz].
    span : tuple of float
        From when to when the sound lasts within the clip [s]; the rest is silence or background.
    """

    samples: NDArray[np.float64]
    rate: int
    span: tuple[float, float]


def resampled(signal: NDArray[np.float64], rate: float, wanted: float) -> NDArray[np.float64]:
    """Resample to another rate, band-limited; rates are taken to the nearest hertz.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [any unit]
    rate, wanted : float
        Its rate, and the other [Hz].

    Returns
    -------
    ndarray, shape (m,)
        [unit of `signal`]

    Examples
    --------
    >>> resampled(np.zeros(96), 96_000, 44_100).size
    45
    """
    up, down = round(wanted), round(rate)
    common = math.gcd(up, down)
    if up == down:
        return signal
    return np.asarray(resample_poly(signal, up // common, down // common, padtype="line"))


def recorded(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator, *, kind: str = "free"
) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """Record a sound in some room, car or hall through some microphone.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Pressure close to the source [Pa].
    rate : float
        Sampling rate [Hz].
    rng : numpy.random.Generator
    kind : str
        Of the microphone, as `noise.training.classifier.augmentation.microphones` has them.

    Returns
    -------
    samples : ndarray, shape (n,)
        Of unit standard deviation [-] or, where the sound is zero, noise alone.
    span : tuple of float
        From when to when the sound is to be heard [s].
    """
    span = (0.0, sound.size / rate)
    signal = in_a_room(sound, rate, rng) if rng.random() < 0.7 else sound
    if rng.random() < _IN_A_PLACE:
        around = place(sound.size, rate, rng)
        signal, span = in_a_place(signal, around, rate, rng.uniform(*_SNR))
    signal = through_a_microphone(signal, rate, rng, kind=kind)
    level = float(signal.std())
    snr = rng.uniform(6.0, 50.0) if rng.random() < 0.6 else 60.0
    noise_level = level * 10.0 ** (-snr / 20.0) if level > 0.0 else 1.0
    signal = signal + noise_level * background(signal.size, rate, rng)
    return np.asarray(signal / signal.std()), span


def augmented(sound: NDArray[np.float64], rate: float, rng: np.random.Generator) -> RecordedSound:
    """Record a sound as anybody might: any microphone, rate, gain, codec and cut.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Pressure close to the source [Pa].
    rate : float
        Sampling rate [Hz].
    rng : numpy.random.Generator

    Examples
    --------
    >>> clip = augmented(np.sin(np.arange(24_000.0)), 48e3, np.random.default_rng(0))
    >>> clip.rate in RATES, bool(np.abs(clip.samples).max() <= 1.0)
    (True, True)
    """
    wanted = int(rng.choice(RATES))
    low = int(rng.choice(_LOW_RATES)) if rng.random() < 2.0 * _LOW else wanted
    if low < wanted and not _left(sound, rate, low):
        low = wanted
    kind = list(_KINDS)[int(rng.choice(len(_KINDS), p=list(_KINDS.values())))]
    signal, span = recorded(sound, rate, rng, kind=kind)
    signal = resampled(signal, rate, wanted)
    if low < wanted and rng.random() < 0.5:
        signal, wanted = resampled(signal, wanted, low), low
    elif low < wanted or rng.random() < 0.15:  # it was stored at a lower rate before
        lower = min(wanted, low, int(rng.choice((16_000, 22_050, 32_000))))
        signal = resampled(resampled(signal, wanted, lower), lower, wanted)
    if rng.random() < (0.6 if kind in ("phone", "pocket") else 0.1):
        signal = levelled(signal, wanted, rng)
    if rng.random() < 0.08:
        signal = clipped(signal, rng)
    # To the peak, as editors do, or to any level.
    peak = 10.0 ** (rng.uniform(-50.0, -1.0) / 20.0) if rng.random() < 0.7 else 0.98
    signal = signal * (peak / float(np.abs(signal).max()))
    samples, before = _cut(signal, wanted, rng)
    span = (span[0] + before, span[1] + before)
    if rng.random() < 0.3:
        samples = np.clip(coded(samples, wanted, rng), -1.0, 1.0)
    if rng.random() < 0.5:
        samples = quantised(samples, 8 if rng.random() < 0.06 and peak > 0.3 else 16, rng)
    return RecordedSound(samples, wanted, span)


def _cut(
    sound: NDArray[np.float64], rate: int, rng: np.random.Generator
) -> tuple[NDArray[np.float64], float]:
    """Put digital silence before or after some of the sounds, as clips of one length have it.

    How long it is before the sound comes second [s].
    """
    duration = sound.size / rate
    if rng.random() < 0.3:  # just so much that windows begin elsewhere
        before = int(rng.uniform(0.0, 0.25) * rate)
        return np.pad(sound, (before, 0)), before / rate
    if rng.random() < 0.65:
        return sound, 0.0
    spare = min(_LONGEST - duration, duration) * rng.uniform(0.1, 1.0)
    before = int(spare * rate * (rng.random() if rng.random() < 0.4 else 0.0))
    after = max(int(spare * rate) - before, 0)
    return np.pad(sound, (before, after)), before / rate


def _left(sound: NDArray[np.float64], rate: float, low: float) -> bool:
    """Whether enough of a sound is left at a low rate."""
    heard = float(a_weighted(sound, rate).std()) ** 2
    return float(a_weighted(resampled(sound, rate, low), low).std()) ** 2 >= _LEFT * heard
