"""Audible sound of a recording: resampled pressure without offset, with fades.

Sound is resampled by a polyphase filter whose stop band begins where the lower of both rates folds
back: images and alias, which an ear would take for a squeal of the bushing, lie 100 dB down, and
the filter's phase is linear, so that a slip stays a click.
"""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording, RecordingBlocks

RATE = 48_000
"""Sampling rate of rendered sound [Hz]."""

FADE = 0.010
"""Half a Hann window at either end [s]."""

GAP = 0.5
"""Silence between two recordings in one file [s]."""

LOWEST_AUDIBLE_RATE = 40.0
"""Minimum sampling rate of audible sound [Hz]."""

_STOP_BAND = 100.0  # dB
_PASS_BAND = 0.95  # of the lower Nyquist frequency
_LARGEST_TERM = 20_000  # of that ratio: the filter is 300 times as long
_FINEST_RATIO = 1000  # terms of the ratio of the rates; the pitch is right within 1e-6
_ORDER = 4  # of a band's ends, once


def audible(recording: Recording) -> NDArray[np.float64]:
    """Return the first pressure channel of a recording, prepared for listening.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    ndarray, shape (n_samples,)
        At `RATE`: sound pressure [Pa], or in fractions of full scale where the recording is not
        calibrated; without its mean.

    Raises
    ------
    RecordingError
        The recording has no pressure channel, or nothing to be heard.

    Examples
    --------
    >>> run = Recording(np.ones((1, 3000)), 30e3, (Channel("pressure"),))
    >>> audible(run).shape
    (4800,)
    """
    return playable(recording[pressure_channel(recording).name], recording.rate)


def playable(signal: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return a signal at `RATE` without its mean, with fades.

    Parameters
    ----------
    signal : ndarray, shape (n_samples,)
        In any [unit].
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n_new_samples,)
        In the unit of the signal, such as [Pa].

    Examples
    --------
    >>> playable(np.ones(3000), 30e3).shape
    (4800,)
    """
    sound = resampled(signal - signal.mean(), rate, RATE)
    n = min(round(FADE * RATE), sound.size // 2)
    flank = np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / max(n, 1)) ** 2
    sound[:n] *= flank
    sound[sound.size - n :] *= flank[::-1]
    return sound


def pressure_channel(recording: Recording | RecordingBlocks) -> Channel:
    """Return the first channel of sound pressure.

    Raises
    ------
    RecordingError
        There is none, or what it is sampled at leaves nothing to be heard.

    Examples
    --------
    >>> run = Recording(np.ones((2, 16)), 30e3, (Channel("torque"), Channel("pressure_2")))
    >>> pressure_channel(run).name
    'pressure_2'
    """
    if recording.rate < LOWEST_AUDIBLE_RATE:
        raise RecordingError(
            f"recording {recording.name!r} is sampled at {recording.rate:g} Hz, so nothing in it "
            f"can be heard; {LOWEST_AUDIBLE_RATE:g} Hz at least"
        )
    for channel in recording.channels:
        if channel.kind == "pressure":
            return channel
    have = ", ".join(channel.name for channel in recording.channels)
    raise RecordingError(
        f"recording {recording.name!r} has no pressure channel to be heard; it has {have}"
    )


def resampled(signal: NDArray[np.float64], rate: float, new_rate: float) -> NDArray[np.float64]:
    """Return a signal at another sampling rate [Hz].

    Examples
    --------
    >>> resampled(np.zeros(441), 44100.0, 48000.0).shape
    (480,)
    """
    from scipy.signal import resample_poly

    up, down, taps = _resampling(rate, new_rate)
    if up == down:
        return np.array(signal, dtype=float)
    return np.asarray(resample_poly(signal, up, down, window=taps))


@lru_cache(maxsize=4)
def _resampling(rate: float, new_rate: float) -> tuple[int, int, NDArray[np.float64]]:
    """Return up and down factors of two sampling rates [Hz] and the filter taps."""
    from scipy.signal import firwin, kaiser_beta

    terms = max(1, min(_FINEST_RATIO, int(_LARGEST_TERM * rate / new_rate)))
    ratio = Fraction(new_rate / rate).limit_denominator(terms)
    if ratio == 1:
        return 1, 1, np.empty(0)
    up, down = ratio.numerator, ratio.denominator
    # Frequencies relative to the Nyquist frequency of the rate that both are divisors of.
    stop = 1.0 / max(up, down)
    n_taps = math.ceil((_STOP_BAND - 7.95) / (2.285 * math.pi * (1.0 - _PASS_BAND) * stop)) | 1
    window = ("kaiser", kaiser_beta(_STOP_BAND))
    return up, down, np.asarray(firwin(n_taps, 0.5 * (1.0 + _PASS_BAND) * stop, window=window))


def in_band(
    signal: NDArray[np.float64], rate: float, band: tuple[float, float]
) -> NDArray[np.float64]:
    """Return a band-pass filtered signal without delay.

    Butterworth's filter runs forwards and backwards, so that a slip stays where it was: at the ends
    of the band it is 6 dB down, and falls by 48 dB an octave beyond.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    rate : float
        Sampling rate [Hz].
    band : tuple of float
        Lowest and highest frequency [Hz].

    Returns
    -------
    ndarray, shape (n,)
        In the same [unit], without its mean.

    Raises
    ------
    ParameterError
        A frequency is not below half the sampling rate.

    Examples
    --------
    >>> tones = np.sin(2 * np.pi * np.array([[100.0], [1000.0]]) * np.arange(48000) / 48e3).sum(0)
    >>> round(float(in_band(tones, 48e3, (500.0, 2000.0)).var()), 2)
    0.5
    """
    from scipy.signal import butter, sosfiltfilt

    low, high = band
    if high >= 0.5 * rate:
        raise ParameterError(
            f"a filter at {high:g} Hz needs more than the {rate:g} Hz it is sampled at; "
            f"stay below {0.5 * rate:g} Hz"
        )
    sections = butter(_ORDER, band, "bandpass", fs=rate, output="sos")
    # Long enough for it to die out in; at its ends the sound is turned about them.
    padding = min(signal.size - 1, round(4.0 * rate / low))
    return np.asarray(sosfiltfilt(sections, signal - signal.mean(), padlen=padding))


def pressure_recording(
    recording: Recording | RecordingBlocks, band: tuple[float, float] | None = None
) -> Recording:
    """Return the first pressure channel as a recording, filtered to a band [Hz].

    Raises
    ------
    RecordingError
        There is no pressure channel, or nothing to be heard.
    ParameterError
        A frequency is not below half the sampling rate.

    Examples
    --------
    >>> from models.recording import Channel
    >>> tones = np.sin(2 * np.pi * np.array([[100.0], [1000.0]]) * np.arange(48000) / 48e3).sum(0)
    >>> both = Recording(tones[None], 48e3, (Channel("pressure"),))
    >>> pressure_recording(both, (500.0, 2000.0)).notes
    ('filtered: 500 to 2000 Hz, zero-phase; 3.0 dB below the whole sound',)
    """
    blocks = RecordingBlocks.of(recording)
    channel = pressure_channel(blocks)
    samples = blocks.track(blocks.channels.index(channel)).read(0, blocks.n_samples)
    notes = getattr(recording, "notes", ())
    if band is not None:
        try:
            filtered = in_band(samples[0], blocks.rate, band)
        except ParameterError as error:
            raise ParameterError(f"{blocks.name}: {error}") from None
        before, after = float(samples.std()), float(filtered.std())
        change = "silent"
        if before > 0.0 and after > 0.0:
            change = f"{20.0 * math.log10(before / after):.1f} dB below the whole sound"
        low, high = band
        notes = (*notes, f"filtered: {low:g} to {high:g} Hz, zero-phase; {change}")
        samples = filtered[np.newaxis]
    return Recording(
        samples, blocks.rate, (channel,), blocks.condition, blocks.calibrated, blocks.name, notes
    )


def joined(
    recordings: Sequence[Recording], *, gap: float = GAP
) -> tuple[NDArray[np.float64], list[tuple[float, float]]]:
    """Concatenate the sounds of recordings at one gain.

    Parameters
    ----------
    recordings : sequence of Recording
    gap : float
        Silence between two of them [s].

    Returns
    -------
    samples : ndarray, shape (n_samples,)
        As `audible` gives them, at `RATE`.
    times : list of tuple of float
        Where each begins and ends [s].

    Raises
    ------
    ParameterError
        Some are calibrated and others are not.

    Examples
    --------
    >>> from models.recording import Channel
    >>> run = Recording(np.ones((1, 48)), 48e3, (Channel("pressure"),), name="A")
    >>> samples, times = joined([run, run], gap=0.001)
    >>> samples.size, times
    (144, [(0.0, 0.001), (0.002, 0.003)])
    """
    refuse_mixed({one.calibrated: one.name for one in recordings}, "give its calibration")
    pieces: list[NDArray[np.float64]] = []
    times: list[tuple[float, float]] = []
    start = 0
    for recording in recordings:
        sound = audible(recording)
        times.append((start / RATE, (start + sound.size) / RATE))
        pieces += [sound, np.zeros(round(gap * RATE))]
        start += sound.size + pieces[-1].size
    return np.concatenate(pieces[:-1]), times


def refuse_mixed(known: Mapping[bool, str], remedy: str) -> None:
    """Refuse a common gain for calibrated and uncalibrated sounds."""
    if len(known) > 1:
        raise ParameterError(
            f"{known[True]} is calibrated and {known[False]} is not, so one gain cannot keep how "
            f"loud they are to each other; {remedy}"
        )
