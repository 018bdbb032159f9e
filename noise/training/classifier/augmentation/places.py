"""Places where engineers record, and how a sound is put into one by its level in dB(A).

Some families are never learned from, so that a score on them is one of places left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import fftconvolve

from features.kernels.levels import a_weighting
from noise.training.classifier.augmentation.cabins import CABINS, cabin
from noise.training.classifier.augmentation.halls import HALLS
from noise.training.classifier.background_sounds.blows import slam
from noise.training.classifier.background_sounds.building import blow, placed
from noise.training.classifier.background_sounds.people import speech
from noise.training.classifier.background_sounds.signals import music

PLACES = (*CABINS, *HALLS)
"""Families of cabins and halls."""

LEFT_OUT = ("lorry", "convertible", "climate_chamber", "compressor_room")
"""Families that the shipped classifier has not learned from."""

LEARNED = tuple(name for name in PLACES if name not in LEFT_OUT)
"""All others."""

_HEARD_DB = 3.0
"""What is heard stands so far above the place in some half octave for some time [dB]."""

_HEARD_SHARE = 0.95
"""Quantile of its frames that must stand out for it to be heard [-]."""

_FRAME = 0.032
"""Within it a sound's level is taken [s]."""

_PAUSE_DB = 18.0
"""A sound so far below its loudest is a pause [dB]."""

_LIFTS = (0.0, 10.0, 20.0, 40.0)
"""A sound is lifted by one of these until it is heard for long enough [dB]."""

_SHORTEST = 0.5
"""Long enough [s]."""

_LONGEST_PAUSE = 0.3
"""Of a pause that belongs to the sound [s]: blows of a creak lie closer."""

_BANDS = 160.0 * 2.0 ** (0.5 * np.arange(12))
"""Edges of half octaves [Hz]."""


def place(
    n: int,
    rate: float,
    rng: np.random.Generator,
    *,
    among: Sequence[str] = LEARNED,
    peopled: bool = True,
) -> NDArray[np.float64]:
    """Return `n` samples of what is heard in a place where nothing creaks.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator
    among : sequence of str
        Of `PLACES`.
    peopled : bool
        Whether somebody may speak, play the radio, slam a door or signal a turn, each in one of
        ten; where not, all this is rare and faint.

    Returns
    -------
    ndarray, shape (n,)
        Of unit standard deviation [-].

    Examples
    --------
    >>> float(place(4800, 48e3, np.random.default_rng(1)).std().round(6))
    1.0
    """
    name = among[int(rng.integers(len(among)))]
    sound = HALLS[name](n, rate, rng) if name in HALLS else cabin(name, n, rate, rng)
    level = a_weighted(sound, rate).std()
    for event in (speech, music, slam, _indicator):
        if rng.random() < (0.1 if peopled else 0.04):
            other = event(n, rate, rng)
            own = a_weighted(other, rate).std()
            strength = rng.uniform(-15.0, 3.0) if peopled else rng.uniform(-25.0, -14.0)
            sound = sound + 10.0 ** (strength / 20.0) * level / (own + 1e-12) * other
    return np.asarray(sound / sound.std())


def in_a_place(
    sound: NDArray[np.float64], surroundings: NDArray[np.float64], rate: float, snr: float
) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """Put a sound into a place; it is lifted where it would not be heard at all.

    Parameters
    ----------
    sound, surroundings : ndarray, shape (n,)
        [any one unit]
    rate : float
        [Hz]
    snr : float
        Level of the sound over that of the place, both A-weighted [dB].

    Returns
    -------
    mixed : ndarray, shape (n,)
        [unit of `sound`]
    span : tuple of float
        The longest time in which the sound is heard without a pause [s].

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> tone = np.sin(2 * np.pi * 1e3 * np.arange(24_000) / 48e3)
    >>> mixed, span = in_a_place(tone, place(24_000, 48e3, rng), 48e3, 0.0)
    >>> mixed.shape, span
    ((24000,), (0.0, 0.5))
    """
    weighted, around = a_weighted(sound, rate), a_weighted(surroundings, rate)
    level = float(weighted.std())
    if not level > 0.0:
        return surroundings, (0.0, sound.size / rate)
    share = level / (float(around.std()) + 1e-300) * 10.0 ** (-snr / 20.0)
    stands = _stands_out(weighted, share * around, rate)
    lift = max(0.0, _HEARD_DB - float(np.quantile(stands, _HEARD_SHARE)))
    for more in _LIFTS:
        span = _longest(stands + lift + more > 0.0, sound.size / rate)
        if span[1] - span[0] >= _SHORTEST:
            break
    else:  # it makes pauses of its own
        span = (0.0, sound.size / rate)
    return sound + share * 10.0 ** (-(lift + more) / 20.0) * surroundings, span


def a_weighted(sound: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """A-weight a sound.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1e3 * np.arange(4800) / 48e3)
    >>> round(float(a_weighted(tone, 48e3).std() / tone.std()), 2)
    1.0
    """
    m = next_fast_len(sound.size, real=True)
    gain = 10.0 ** (a_weighting(np.maximum(rfftfreq(m, 1.0 / rate), 1.0)) / 20.0)
    return np.asarray(irfft(rfft(sound, m) * gain, m)[: sound.size])


def _stands_out(
    sound: NDArray[np.float64], surroundings: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    """Return by how much a sound stands above a place in its best half octave, frame by frame.

    So far below its loudest that it makes a pause, it does not; [dB].
    """
    frame = round(_FRAME * rate)
    heard, around = (
        np.abs(np.fft.rfft(x[: x.size // frame * frame].reshape(-1, frame) * np.hanning(frame)))
        for x in (sound, surroundings)
    )
    edges = np.unique(np.minimum(np.round(_BANDS * frame / rate).astype(int), frame // 2))[:-1]
    power = np.add.reduceat(heard**2, edges, axis=1)
    mean = np.add.reduceat(around**2, edges, axis=1).mean(axis=0)
    stands = 10.0 * np.log10((power / (mean + 1e-300)).max(axis=1) + 1e-300)
    pause = power.sum(axis=1) < 10.0 ** (-0.1 * _PAUSE_DB) * power.sum(axis=1).max()
    return np.where(pause, -300.0, stands)


def _longest(sounds: NDArray[np.bool_], duration: float) -> tuple[float, float]:
    """Return from when to when frames sound longest, but for short pauses [s]."""
    reach = 2 * round(0.5 * _LONGEST_PAUSE / _FRAME) + 1
    closed = minimum_filter1d(maximum_filter1d(sounds.astype(int), reach), reach)
    edges = np.flatnonzero(np.diff(np.r_[0, closed, 0]))
    if not edges.size:
        return 0.0, duration
    starts, ends = edges[::2], edges[1::2]
    best = int((ends - starts).argmax())
    end = duration if ends[best] == sounds.size else int(ends[best]) * _FRAME
    return int(starts[best]) * _FRAME, end


def _indicator(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return the ticking of a turn signal: a higher and a lower click in turn."""
    step = 0.5 / rng.uniform(1.2, 1.7)
    times = np.arange(0.5 * step * rng.random(), n / rate, step)
    sound = np.zeros(n)
    for part in (times[::2], times[1::2]):
        if part.size:
            click = blow(rate, (600.0, 4000.0), (0.002, 0.02), rng, noise=0.5)
            sound += fftconvolve(placed(n, part, np.ones(part.size), rate), click)[:n]
    return sound
