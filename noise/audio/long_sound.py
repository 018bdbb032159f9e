"""Sound of which parts can be had: resampled, faded and put together while it is read.

Whatever it goes through, a part is the same however it is read: what is computed comes in chunks
that lie on a fixed grid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from features.long.parts import in_pieces, n_samples_of, reader_of
from features.long.sums import Moments
from models.recording import Recording
from noise.audio.sound import fade_flank, pressure_channel, resampling

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from features.long.parts import Parts, Read

__all__ = ["CHUNK", "AudibleSound", "LongSound", "in_chunks"]

CHUNK = 1 << 19
"""Samples that are computed at once."""


@dataclass(frozen=True, eq=False)
class LongSound:
    """Sound on one channel.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    n_samples : int
    read : callable
        From first and last sample to the samples between them, shape (n,) [unit of the sound].

    Examples
    --------
    >>> tone = LongSound.of(np.ones(3000), 30e3)
    >>> tone.playable(48000, fade=0.01).n_samples, tone.mean
    (4800, 1.0)
    """

    rate: float
    n_samples: int
    read: Read

    @classmethod
    def of(cls, samples: NDArray[Any] | LongSound, rate: float) -> LongSound:
        """Return sound in memory as sound of which parts can be had.

        Parameters
        ----------
        samples : ndarray, shape (n_samples,), or LongSound
            In any [unit].
        rate : float
            Sampling rate [Hz].

        Returns
        -------
        LongSound
        """
        if isinstance(samples, LongSound):
            return samples
        return cls(rate, samples.size, lambda first, last: samples[first:last])

    def pieces(self) -> Iterator[NDArray[np.float64]]:
        """Go through it; pieces have shape (n,)."""
        return in_pieces(self.read, self.n_samples, CHUNK)()

    def whole(self) -> NDArray[np.float64]:
        """Return all of it, shape (n_samples,)."""
        return np.asarray(self.read(0, self.n_samples))

    @cached_property
    def moments(self) -> Moments:
        """Mean, deviation and extremes [unit of the sound]."""
        found = Moments()
        for piece in self.pieces():
            found.add(piece)
        return found

    @property
    def mean(self) -> float:
        """Mean [unit of the sound]."""
        return self.moments.mean

    @property
    def peak(self) -> float:
        """Largest magnitude of a sample [unit of the sound]."""
        if not self.n_samples:
            return 0.0
        return max(abs(self.moments.lowest), abs(self.moments.highest))

    def without_mean(self) -> LongSound:
        """Return it about its mean."""
        mean = self.mean
        return replace(self, read=lambda first, last: self.read(first, last) - mean)

    def resampled(self, rate: float) -> LongSound:
        """Return it at another sampling rate [Hz], as `noise.audio.sound.resampled` does."""
        from scipy.signal import resample_poly

        up, down, taps = resampling(self.rate, rate)
        if up == down:
            return self
        n = -(-self.n_samples * up // down)
        reach = taps.size // (2 * down) + 2

        def make(first: int, last: int) -> NDArray[np.float64]:
            block = max(0, first - reach) // up
            start, end = block * down, math.ceil((last + reach) * down / up) + 1
            there = self.read(start, min(end, self.n_samples))
            made = np.asarray(resample_poly(there, up, down, window=taps))
            return made[first - block * up : last - block * up]

        return LongSound(rate, n, in_chunks(make, n))

    def playable(self, rate: float, *, fade: float) -> LongSound:
        """Return it as `noise.audio.sound.playable` does.

        Parameters
        ----------
        rate : float
            Sampling rate of the result [Hz].
        fade : float
            Length of the fades in and out [s].

        Returns
        -------
        LongSound
        """
        sound = self.without_mean().resampled(rate)
        n, flank = sound.n_samples, fade_flank(sound.n_samples, rate, fade)

        def read(first: int, last: int) -> NDArray[np.float64]:
            part = sound.read(first, last)
            if first >= flank.size and last <= n - flank.size:
                return part
            part = part.copy()
            rising = flank[first:last]
            part[: rising.size] *= rising
            falling = flank[::-1][max(0, first - n + flank.size) : max(0, last - n + flank.size)]
            part[part.size - falling.size :] *= falling
            return part

        return replace(sound, read=read)

    @classmethod
    def joined(cls, sounds: Sequence[LongSound], starts: Sequence[int]) -> LongSound:
        """Put sounds of one rate behind one another.

        Parameters
        ----------
        sounds : sequence of LongSound
        starts : sequence of int
            First sample of each, in their order; between them it is silent.

        Returns
        -------
        LongSound
        """
        n = starts[-1] + sounds[-1].n_samples

        def read(first: int, last: int) -> NDArray[np.float64]:
            last = min(last, n)
            whole = np.zeros(max(0, last - first))
            for sound, start in zip(sounds, starts, strict=True):
                begin, end = max(first, start), min(last, start + sound.n_samples)
                if begin < end:
                    whole[begin - first : end - first] = sound.read(begin - start, end - start)
            return whole

        return cls(sounds[0].rate, n, read)


@dataclass(frozen=True, eq=False)
class AudibleSound:
    """What is heard of a recording: its first channel of sound pressure.

    Parameters
    ----------
    sound : LongSound
        [Pa], or in fractions of full scale where the recording is not calibrated.
    about : Recording
        What is known of it, without samples.
    """

    sound: LongSound
    about: Recording

    @classmethod
    def of(cls, recording: Recording | Parts | AudibleSound) -> AudibleSound:
        """Return what is heard of a recording.

        Raises
        ------
        RecordingError
            There is no pressure channel, or nothing to be heard.
        """
        if isinstance(recording, AudibleSound):
            return recording
        about = Recording(
            np.empty((len(recording.channels), 0)), recording.rate, recording.channels,
            recording.condition, recording.calibrated, recording.name,
            recording.notes if isinstance(recording, Recording) else (),
        )  # fmt: skip
        row = about.channels.index(pressure_channel(about))
        sound = LongSound(recording.rate, n_samples_of(recording), reader_of(recording, row))
        return cls(sound, replace(about, samples=np.empty((1, 0)), channels=(about.channels[row],)))


def in_chunks(
    make: Callable[[int, int], NDArray[np.float64]], n_samples: int, length: int = CHUNK
) -> Read:
    """Return what gives parts of something that is computed chunk by chunk.

    Parameters
    ----------
    make : callable
        From first and last sample to the samples between them, shape (n,).
    n_samples : int
        That there are.
    length : int
        Samples of a chunk.

    Returns
    -------
    callable
        As `make`, for any first and last sample [unit of what is made].

    Examples
    --------
    >>> read = in_chunks(lambda first, last: np.arange(float(first), last), 10, 4)
    >>> read(3, 6).tolist()
    [3.0, 4.0, 5.0]
    """

    @lru_cache(maxsize=2)
    def chunk(number: int) -> NDArray[np.float64]:
        return make(number * length, min((number + 1) * length, n_samples))

    def read(first: int, last: int) -> NDArray[np.float64]:
        last = min(last, n_samples)
        parts = [
            chunk(number)[max(0, first - number * length) : last - number * length]
            for number in range(first // length, math.ceil(last / length))
        ]
        return parts[0] if len(parts) == 1 else np.concatenate([np.empty(0), *parts])

    return read
