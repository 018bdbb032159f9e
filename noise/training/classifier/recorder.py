"""Recording chain of the augmentation: microphone, noise, rate, gain, codec and cut.

Vorbis and MP3 are coded and decoded by libsndfile, if available, and otherwise replaced by their
steep low-pass.
"""

from __future__ import annotations

import io
import math

import numpy as np
import soundfile
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.signal import firwin, lfilter, oaconvolve, resample_poly

from models.recording import Channel, Recording
from noise.base.arrays import Array, Rng
from noise.training.classifier.places import (
    TABLE,
    a_weighted,
    background,
    in_a_place,
    in_a_room,
    place,
)
from noise.training.draws import Span, coloured_noise, log_uniform, low_pass, picked, wandering


def through_a_microphone(sound: Array, rate: float, rng: Rng, *, kind: str = "free") -> Array:
    """Return a sound through the frequency response of a random microphone.

    The response has slopes at both ends of the band and a gentle ripple. A phone has a narrower
    band, about 100 Hz to 8 kHz, steeper slopes and more ripple. In a pocket, the band ends near 2
    kHz and cloth rubs; a stethoscope has a similar band with resonances.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]
    rng : numpy.random.Generator
    kind : {"free", "phone", "pocket", "stethoscope"}

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> through_a_microphone(np.ones(480), 48e3, np.random.default_rng(0)).shape
    (480,)
    """
    m = next_fast_len(sound.size, real=True)
    frequency = rfftfreq(m, 1.0 / rate)
    row = TABLE["microphones"][kind]
    low, high = (log_uniform(ends[0], ends[1], rng) for ends in (row["low"], row["high"]))
    order = row["order"]
    gain = 1.0 / np.sqrt(
        (1.0 + (low / np.maximum(frequency, 1.0)) ** order) * (1.0 + (frequency / high) ** order)
    )
    octaves = np.log2(np.maximum(frequency, 20.0) / 1e3)
    ripple = np.sin(rng.uniform(1.0, 4.0) * octaves + rng.uniform(0.0, 6.3))
    gain *= 10.0 ** (rng.uniform(0.0, row["ripple"]) / 20.0 * ripple)
    coloured = irfft(rfft(sound, m) * gain, m)[: sound.size]
    return coloured + _rubbing(coloured, rate, rng) if kind == "pocket" else np.asarray(coloured)


def _rubbing(sound: Array, rate: float, rng: Rng) -> Array:
    """Return the noise of cloth that rubs against the microphone."""
    n = sound.size
    noise = low_pass(coloured_noise(n, rng.uniform(0.5, 1.5), rng), rng.uniform(500, 4000), rate)
    strokes = np.maximum(wandering(n, rate, log_uniform(0.5, 6.0, rng), rng), 0.0) ** 2
    return np.asarray(10.0 ** rng.uniform(-2.0, -0.5) * sound.std() * strokes * noise / noise.std())


def with_sensor_noise(torque: Array, acceleration: Array, rng: Rng) -> tuple[Array, Array]:
    """Return torque and acceleration with random sensor noise.

    Parameters
    ----------
    torque, acceleration : ndarray, shape (n,)
        Without noise [Nm], [m/s^2].
    rng : numpy.random.Generator

    Returns
    -------
    torque, acceleration : ndarray, shape (n,)
        With noise, of 0.03 to 3 % of the mean magnitude of the torque [Nm], [m/s^2].
    """
    size = 10.0 ** rng.uniform(-3.5, -1.5) * np.abs(torque).mean()
    torque = torque + size * rng.standard_normal(torque.size)
    size = 10.0 ** rng.uniform(-3.0, 0.5)
    return torque, acceleration + size * rng.standard_normal(acceleration.size)


def levelled(sound: Array, rate: float, rng: Rng) -> Array:
    """Return a sound after automatic gain control with a random compression ratio.

    The output level rises by 1 dB for 1.3 to 4 dB of the smoothed input level.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> quiet_then_loud = np.repeat([0.01, 1.0], 48_000) * np.sin(np.arange(96_000))
    >>> even = levelled(quiet_then_loud, 48e3, np.random.default_rng(0))
    >>> bool(np.std(even[60_000:]) < 60.0 * np.std(even[:40_000]))
    True
    """
    time = rng.uniform(0.02, 0.4)
    pole = math.exp(-1.0 / (time * rate))
    power = lfilter([1.0 - pole], [1.0, -pole], sound**2)
    floor = 1e-4 * float(np.mean(sound**2)) + 1e-300
    exponent = 0.5 * (1.0 - 1.0 / rng.uniform(1.3, 4.0))
    return np.asarray(sound * (power + floor) ** -exponent)


def clipped(sound: Array, rng: Rng) -> Array:
    """Return a sound clipped at 30-90 % of its peak, hard or soft.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> wave = np.sin(np.arange(100.0))
    >>> bool(np.abs(clipped(wave, np.random.default_rng(0))).max() < 0.95)
    True
    """
    limit = rng.uniform(0.3, 0.9) * float(np.abs(sound).max())
    if not limit > 0.0:
        return sound
    if rng.random() < 0.5:
        return np.clip(sound, -limit, limit)
    return np.asarray(limit * np.tanh(sound / limit))


_AT_ONCE = 4096
"""Frames per call of an encoder; the Vorbis encoder of libsndfile overflows its stack on many."""


def coded(sound: Array, rate: int, rng: Rng) -> Array:
    """Return a sound of the same length after a random lossy codec.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Sound within -1 to 1 [full scale].
    rate : int
        [Hz]
    rng : numpy.random.Generator

    Examples
    --------
    >>> tone = 0.5 * np.sin(2 * np.pi * 1e3 * np.arange(24_000) / 48e3)
    >>> decoded = coded(tone, 48_000, np.random.default_rng(0))
    >>> decoded.shape, bool(np.corrcoef(tone, decoded)[0, 1] > 0.9)
    ((24000,), True)
    """
    kind, quality = rng.random(), float(rng.uniform(0.1, 0.8))
    cutoff = min(rng.uniform(10e3, 17e3), 0.45 * rate)
    if kind < 0.45:
        decoded = _round_trip(sound, rate, "OGG", "VORBIS", quality)
    elif kind < 0.75 and rate in (16_000, 22_050, 24_000, 32_000, 44_100, 48_000):
        decoded = _round_trip(sound, rate, "MP3", "MPEG_LAYER_III", quality)
    else:
        decoded = None
    if decoded is None:
        return np.asarray(oaconvolve(sound, firwin(101, cutoff, fs=rate), mode="same"))
    return decoded


def quantised(sound: Array, bits: int, rng: Rng) -> Array:
    """Return a sound quantised to a number of bits, with or without dither, and clipped.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [full scale]
    bits : int
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [full scale]

    Examples
    --------
    >>> quantised(np.array([0.3, 2.0]), 2, np.random.default_rng(1)).tolist()
    [0.5, 0.5]
    """
    steps = 2.0 ** (bits - 1)
    dither = rng.uniform(-0.5, 0.5, sound.size) if rng.random() < 0.3 else 0.0
    return np.asarray(np.clip(np.round(sound * steps + dither), -steps, steps - 1.0) / steps)


def _round_trip(
    sound: Array, rate: int, container: str, subtype: str, quality: float
) -> Array | None:
    """Return a sound after encoding and decoding; ``None`` if libsndfile cannot."""
    if container not in soundfile.available_formats():
        return None
    memory = io.BytesIO()
    try:
        with soundfile.SoundFile(
            memory, "w", rate, 1, subtype, format=container, compression_level=1.0 - quality
        ) as file:
            for first in range(0, sound.size, _AT_ONCE):
                file.write(sound[first : first + _AT_ONCE])
        memory.seek(0)
        decoded, _ = soundfile.read(memory)
    except (soundfile.LibsndfileError, TypeError):  # an older soundfile without quality settings
        return None
    if decoded.size < sound.size:
        decoded = np.pad(decoded, (0, sound.size - decoded.size))
    return np.asarray(decoded[: sound.size])


RATES = (16_000, 22_050, 30_000, 32_000, 44_100, 48_000, 96_000)
"""Sampling rates of recordings [Hz]."""


def sound_recording(samples: Array, rate: float) -> Recording:
    """Return an uncalibrated recording of a sound, shape (n,)."""
    return Recording(samples[None, :], float(rate), (Channel("pressure"),), calibrated=False)


def resampled(signal: Array, rate: float, wanted: float) -> Array:
    """Return a signal at another sampling rate; rates are rounded to whole hertz.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [any unit]
    rate, wanted : float
        Present and new sampling rate [Hz].

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
    sound: Array,
    rate: float,
    rng: Rng,
    *,
    kind: str = "free",
    span: Span | None = None,
) -> tuple[Array, Span]:
    """Return a sound recorded in a random room or place by a random microphone.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Pressure close to the source [Pa].
    rate : float
        Sampling rate [Hz].
    rng : numpy.random.Generator
    kind : str
        Kind of microphone, as in `through_a_microphone`.
    span : tuple of float, optional
        Start and end of the sound; by default all of it [s].

    Returns
    -------
    samples : ndarray, shape (n,)
        Samples of unit standard deviation [-]; only noise if the sound is zero.
    span : tuple of float
        Start and end of the audible part [s].
    """
    lasts = span or (0.0, sound.size / rate)
    span = lasts
    signal = in_a_room(sound, rate, rng) if rng.random() < 0.7 else sound
    if rng.random() < 0.5:  # in a place of engineers, by so many dB(A) above it
        around = place(sound.size, rate, rng)
        signal, span = in_a_place(signal, around, rate, rng.uniform(-15.0, 30.0))
        span = (max(span[0], lasts[0]), min(span[1], lasts[1]))
        span = span if span[1] > span[0] else lasts
    signal = through_a_microphone(signal, rate, rng, kind=kind)
    level = float(signal.std())
    snr = rng.uniform(6.0, 50.0) if rng.random() < 0.6 else 60.0
    noise_level = level * 10.0 ** (-snr / 20.0) if level > 0.0 else 1.0
    signal = signal + noise_level * background(signal.size, rate, rng)
    return np.asarray(signal / signal.std()), span


def augmented(
    sound: Array, rate: float, rng: Rng, *, span: Span | None = None
) -> tuple[Recording, Span]:
    """Return a sound recorded with a random microphone, rate, gain, codec and cut.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        Pressure close to the source [Pa].
    rate : float
        Sampling rate [Hz].
    rng : numpy.random.Generator
    span : tuple of float, optional
        Start and end of the sound; by default all of it [s].

    Returns
    -------
    recording : Recording
        One uncalibrated channel of pressure.
    span : tuple of float
        Start and end of the sound in the clip [s]; the rest is silence or background.

    Examples
    --------
    >>> clip, span = augmented(np.sin(np.arange(24_000.0)), 48e3, np.random.default_rng(0))
    >>> clip.rate in RATES, bool(np.abs(clip.samples).max() <= 1.0)
    (True, True)
    """
    wanted = int(rng.choice(RATES))
    # Telephones and small files, if half of the A-weighted power remains.
    low = int(rng.choice((8_000, 11_025, 12_000))) if rng.random() < 0.24 else wanted
    if low < wanted:
        left = float(a_weighted(resampled(sound, rate, low), low).std()) ** 2
        if left < 0.5 * float(a_weighted(sound, rate).std()) ** 2:
            low = wanted
    kind = picked({name: row["share"] for name, row in TABLE["microphones"].items()}, rng)
    signal, lasts = recorded(sound, rate, rng, kind=kind, span=span)
    signal = resampled(signal, rate, wanted)
    if low < wanted and rng.random() < 0.5:
        signal, wanted = resampled(signal, wanted, low), low
    elif low < wanted or rng.random() < 0.15:  # it was stored at a lower rate in between
        lower = min(wanted, low, int(rng.choice((16_000, 22_050, 32_000))))
        signal = resampled(resampled(signal, wanted, lower), lower, wanted)
    if rng.random() < (0.6 if kind in ("phone", "pocket") else 0.1):
        signal = levelled(signal, wanted, rng)
    if rng.random() < 0.08:
        signal = clipped(signal, rng)
    # Normalised to the peak, like by editors, or to a random level.
    peak = 10.0 ** (rng.uniform(-50.0, -1.0) / 20.0) if rng.random() < 0.7 else 0.98
    signal = signal * (peak / float(np.abs(signal).max()))
    samples, before = _cut(signal, wanted, rng)
    lasts = (lasts[0] + before, lasts[1] + before)
    if rng.random() < 0.3:
        samples = np.clip(coded(samples, wanted, rng), -1.0, 1.0)
    if rng.random() < 0.5:
        samples = quantised(samples, 8 if rng.random() < 0.06 and peak > 0.3 else 16, rng)
    return sound_recording(samples, wanted), lasts


def _cut(sound: Array, rate: int, rng: Rng) -> tuple[Array, float]:
    """Return a sound with random digital silence before and after, and the silence before [s]."""
    duration = sound.size / rate
    if rng.random() < 0.3:  # a shift of the windows
        before = int(rng.uniform(0.0, 0.25) * rate)
        return np.pad(sound, (before, 0)), before / rate
    if rng.random() < 0.65:
        return sound, 0.0
    spare = min(5.0 - duration, duration) * rng.uniform(0.1, 1.0)
    before = int(spare * rate * (rng.random() if rng.random() < 0.4 else 0.0))
    after = max(int(spare * rate) - before, 0)
    return np.pad(sound, (before, after)), before / rate
