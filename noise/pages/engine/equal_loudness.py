"""Equal loudness, for whoever compares characters: one factor a sound, switched on by the listener.

The page keeps its sounds at one gain, because how loud a design is matters first. A factor only
changes how they are played. Sounds that would have to be raised by more than sixteen bits bear
stay as they are: made as loud as a squeal, the noise of a microphone says nothing.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from noise.audio.gain import LOUDNESS_BLOCK, TARGET_LOUDNESS, loudness
from noise.pages.engine.entry import RATE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["MOST_RAISED", "equal_factors"]

MOST_RAISED = 36.0
"""A sound that would have to be raised by more is left as it is [dB]."""

_CEILING = -3.0
"""Largest sample [dB re full scale]: peaks between two samples are seldom 3 dB higher."""


def equal_factors(sounds: Mapping[str, NDArray[np.float64]]) -> tuple[dict[str, float], float]:
    """Return by what each sound is multiplied to be as loud as the others.

    Parameters
    ----------
    sounds : mapping of str to ndarray, shape (n_samples,)
        In fractions of full scale [-], at the rate of the page.

    Returns
    -------
    factors : dict of str to float
        For those that have a loudness and can be raised to that of the others [-].
    target : float
        The loudness that they then have [LUFS].

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 997 * np.arange(RATE) / RATE)
    >>> factors, target = equal_factors({"loud": 0.5 * tone, "soft": 0.05 * tone})
    >>> round(factors["soft"] / factors["loud"], 3), target
    (10.0, -23.0)
    """
    known = {}
    for name, fractions in sounds.items():
        peak = float(np.abs(fractions).max(initial=0.0))
        if peak > 0.0 and fractions.size >= LOUDNESS_BLOCK * RATE:
            known[name] = loudness(fractions, RATE), 20.0 * math.log10(peak)
    audible = {name: pair for name, pair in known.items() if math.isfinite(pair[0])}
    while audible:
        target = min(
            [TARGET_LOUDNESS, *(reached - peak + _CEILING for reached, peak in audible.values())]
        )
        softest = min(audible, key=lambda name: audible[name][0])
        if target - audible[softest][0] <= MOST_RAISED:
            return {
                name: 10.0 ** ((target - reached) / 20.0) for name, (reached, _) in audible.items()
            }, target
        del audible[softest]
    return {}, TARGET_LOUDNESS
