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
from noise.audio.sound import pressure_channel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.recording import Recording

__all__ = ["SoundFilter", "filtered"]

_ORDER = 4
"""Of a band's ends, once."""

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
        from scipy.signal import butter, sosfiltfilt

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
        x = signal - signal.mean()
        # Long enough for the narrowest to die out in; at its ends a sound is turned about them.
        widest = min(
            [2.0 * _NOTCH_WIDTH * f for f in self.notches]
            + ([self.band[0]] if self.band is not None else [])
        )
        padding = min(x.size - 1, round(4.0 * rate / widest))
        return np.asarray(sosfiltfilt(np.concatenate(sections), x, padlen=padding))


def filtered(recording: Recording, through: SoundFilter) -> Recording:
    """Return a recording whose sound goes through a filter, with a note that says so.

    Parameters
    ----------
    recording : Recording
        Its first pressure channel is what is heard.
    through : SoundFilter

    Returns
    -------
    Recording
        With that channel alone; the note has the level that the filter leaves over that of the
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
    >>> filtered(both, SoundFilter((500.0, 2000.0))).notes
    ('filtered: 500 to 2000 Hz, zero-phase; 3.0 dB below the whole sound',)
    """
    channel = pressure_channel(recording)
    sound = recording[channel.name]
    try:
        kept = through.of(sound, recording.rate)
    except ParameterError as error:
        raise ParameterError(f"{recording.name}: {error}") from None
    before, after = float(sound.std()), float(kept.std())
    change = "silent"
    if before > 0.0 and after > 0.0:
        change = f"{20.0 * math.log10(before / after):.1f} dB below the whole sound"
    return replace(
        recording,
        samples=kept[np.newaxis],
        channels=(channel,),
        notes=(*recording.notes, f"filtered: {through.words}; {change}"),
    )
