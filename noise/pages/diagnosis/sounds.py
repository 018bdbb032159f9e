"""The sounds of a diagnosis: measured, before and after, at one gain for the whole page.

What a missing effect does to loudness is part of what it does; so nothing is matched, and the one
full scale is what the loudest of all sounds needs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.recording import REFERENCE_PRESSURE
from noise.audio.gain import full_scale_without_clipping, true_peak
from noise.audio.sound import audible
from noise.audio.wav import wav_bytes
from noise.pages.templating import as_base64

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from noise.diagnosis.outcome import Illustration

__all__ = ["LONGEST", "PlayedSounds", "played_sounds"]

LONGEST = 4.0
"""Of a sound on the page [s]; what is longer is played from its beginning."""

_RATE = 48000
_ROLES = ("measured", "before", "after")


@dataclass(frozen=True)
class PlayedSounds:
    """Sounds by illustration and role.

    Parameters
    ----------
    uris : tuple of dict of str to str
        One an illustration; keys are ``measured``, ``before`` and ``after``, where there is a
        sound.
    words : str
        What full scale is worth; empty where there is no sound at all.
    full_scale : float
        The same as a number [Pa].
    """

    uris: tuple[dict[str, str], ...]
    words: str
    full_scale: float = 1.0


def played_sounds(illustrations: Sequence[Illustration]) -> PlayedSounds:
    """Encode the sound pressure of illustrations, all at the same gain.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.diagnosis.outcome import Illustration
    >>> hiss = Recording(np.random.default_rng(1).normal(size=(1, 480)), 48e3,
    ...                  (Channel("pressure"),))
    >>> sounds = played_sounds([Illustration("hiss", hiss, hiss, None)])
    >>> [sorted(uris) for uris in sounds.uris], sounds.words[:19]
    ([['before', 'measured']], 'All sounds have one')
    """
    heard = [_heard(illustration) for illustration in illustrations]
    peaks = [true_peak(sound, _RATE) for sounds in heard for sound in sounds.values()]
    if not peaks:
        return PlayedSounds(tuple({} for _ in heard), "")
    full_scale = full_scale_without_clipping(max(peaks)) or 1.0
    uris = tuple(
        {role: _uri(sound / full_scale) for role, sound in sounds.items()} for sounds in heard
    )
    level = 20.0 * math.log10(full_scale / REFERENCE_PRESSURE)
    words = f"{full_scale:.3g} Pa ({level:.0f} dB peak re 20 µPa)"
    return PlayedSounds(
        uris, f"All sounds have one gain and may be compared: full scale = {words}.", full_scale
    )


def _heard(illustration: Illustration) -> dict[str, NDArray[np.float64]]:
    sounds = {}
    for role in _ROLES:
        recording = getattr(illustration, role)
        if recording is not None and recording.first("pressure") is not None:
            sounds[role] = audible(recording, _RATE)[: round(LONGEST * _RATE)]
    return sounds


def _uri(fractions: NDArray[np.float64]) -> str:
    return f"data:audio/wav;base64,{as_base64(wav_bytes(fractions, _RATE, 16))}"
