"""Filters to listen through: a band, and notches that take single tones out.

They are zero-phase, Butterworth's run forwards and backwards, so that a slip stays where it was and
a level is that of the band alone: at the ends of a band it is 6 dB down, and falls by 48 dB an
octave beyond. A notch is as wide as a squeal drifts, 3 % to either side, and 60 dB deep or more
over a third of that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.audio.long_sound import CHUNK, AudibleSound, LongSound, in_chunks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.recording import Recording

__all__ = ["SoundFilter", "filtered"]

_ORDER = 4
"""Of a band's ends, once."""

_MARGIN = 6
"""What a chunk is filtered with on either side, over the time in which a filter dies out [-]."""

_NOTCH_ORDER = 3
_NOTCH_WIDTH = 0.03
"""To either side, over the frequency [-]."""


@dataclass(frozen=True)
class SoundFilter:
    """What is kept of a sound.

    Parameters
    ----------
    band : tuple of float, optional
        Lowest and highest frequency that are kept [Hz].
    notches : tuple of float
        Frequencies that are taken out [Hz].

    Examples
    --------
    >>> SoundFilter((200.0, 2000.0), (974.0,)).words
    '200 to 2000 Hz without 974 Hz, zero-phase'
    """

    band: tuple[float, float] | None = None
    notches: tuple[float, ...] = ()

    def __bool__(self) -> bool:
        return self.band is not None or bool(self.notches)

    @property
    def words(self) -> str:
        """What it keeps."""
        kept = "all" if self.band is None else f"{self.band[0]:g} to {self.band[1]:g} Hz"
        out = " and ".join(f"{one:g}" for one in self.notches)
        return f"{kept}{f' without {out} Hz' if out else ''}, zero-phase"

    def of(self, signal: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
        """Return a signal through the filter, in its own unit.

        Parameters
        ----------
        signal : ndarray, shape (n,)
            In any [unit].
        rate : float
            Sampling rate [Hz].

        Returns
        -------
        ndarray, shape (n,)
            In the same [unit], without its mean.

        Raises
        ------
        ParameterError
            A frequency is not below half the sampling rate.
        """
        return self.through(LongSound.of(signal, rate)).whole()

    def through(self, sound: LongSound) -> LongSound:
        """Return a sound through the filter.

        Parameters
        ----------
        sound : LongSound

        Returns
        -------
        LongSound
            Without its mean.

        Raises
        ------
        ParameterError
            A frequency is not below half the sampling rate.
        """
        from scipy.signal import butter, sosfiltfilt

        rate = sound.rate
        highest = max((*(self.band or ()), *((1.0 + _NOTCH_WIDTH) * f for f in self.notches)))
        if highest >= 0.5 * rate:
            raise ParameterError(
                f"a filter at {highest:g} Hz needs more than the {rate:g} Hz it is sampled at; "
                f"stay below {0.5 * rate:g} Hz"
            )
        sections = []
        if self.band is not None:
            sections.append(butter(_ORDER, self.band, "bandpass", fs=rate, output="sos"))
        for frequency in self.notches:
            ends = (frequency * (1.0 - _NOTCH_WIDTH), frequency * (1.0 + _NOTCH_WIDTH))
            sections.append(butter(_NOTCH_ORDER, ends, "bandstop", fs=rate, output="sos"))
        # Long enough for the narrowest to die out in; at its ends a sound is turned about them.
        widest = min(
            [2.0 * _NOTCH_WIDTH * f for f in self.notches]
            + ([self.band[0]] if self.band is not None else [])
        )
        padding = round(4.0 * rate / widest)
        margin = _MARGIN * padding
        every, x, n = np.concatenate(sections), sound.without_mean(), sound.n_samples

        def make(first: int, last: int) -> NDArray[np.float64]:
            start, end = max(0, first - margin), min(n, last + margin)
            part = x.read(start, end)
            kept = sosfiltfilt(every, part, padlen=min(part.size - 1, padding))
            return np.asarray(kept[first - start : last - start])

        return LongSound(rate, n, in_chunks(make, n, max(CHUNK, 2 * margin)))


def filtered(recording: Recording | AudibleSound, through: SoundFilter) -> AudibleSound:
    """Return a recording whose sound goes through a filter, with a note that says so.

    Parameters
    ----------
    recording : Recording or AudibleSound
        Its first pressure channel is what is heard.
    through : SoundFilter

    Returns
    -------
    AudibleSound
        The note has the level that the filter leaves over that of the
        whole sound [dB].

    Raises
    ------
    ParameterError
        There is no pressure channel, or a frequency is not below half the sampling rate.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> tones = np.sin(2 * np.pi * np.array([[100.0], [1000.0]]) * np.arange(48000) / 48e3).sum(0)
    >>> both = Recording(tones[None], 48e3, (Channel("pressure"),))
    >>> filtered(both, SoundFilter((500.0, 2000.0))).about.notes
    ('filtered: 500 to 2000 Hz, zero-phase; 3.0 dB below the whole sound',)
    """
    take = AudibleSound.of(recording)
    try:
        kept = through.through(take.sound)
    except ParameterError as error:
        raise ParameterError(f"{take.about.name}: {error}") from None
    before, after = (math.sqrt(sound.moments.variance) for sound in (take.sound, kept))
    change = "silent"
    if before > 0.0 and after > 0.0:
        change = f"{20.0 * math.log10(before / after):.1f} dB below the whole sound"
    notes = (*take.about.notes, f"filtered: {through.words}; {change}")
    return AudibleSound(kept, replace(take.about, notes=notes))
