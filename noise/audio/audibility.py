"""Whether a sound in a file is heard by somebody who plays it as other sounds are played.

Somebody sets the volume so that speech at the loudness of a programme (`TARGET_LOUDNESS`) is as
loud as a talker at 1 m (ISO 9921, normal vocal effort). What is then below the background of a
quiet office is nearly inaudible, whatever it was at the rig.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.audio.gain import TARGET_LOUDNESS

if TYPE_CHECKING:
    from noise.audio.rendering import Survey

__all__ = ["LEAST_AUDIBLE", "loudest_in_file", "nearly_inaudible"]

SPEECH = 60.0
"""Of a talker at 1 m [dB(A)]."""

BACKGROUND = 35.0
"""Of a quiet office [dB(A)]."""

LEAST_AUDIBLE = TARGET_LOUDNESS - (SPEECH - BACKGROUND)
"""A-weighted level in the file of what just stands out [dB re full scale]."""


def loudest_in_file(of: Survey, full_scale: float) -> float:
    """Return the largest fast A-weighted level of a sound in its file.

    Parameters
    ----------
    of : Survey
    full_scale : float
        Value of a full-scale sample [unit of the sound].

    Returns
    -------
    float
        [dB re full scale]

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.audio.rendering import survey
    >>> tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> of = survey([Recording(tone, 48e3, (Channel("pressure"),), name="tone")])
    >>> round(loudest_in_file(of, 20.0), 1)
    -26.0
    """
    return max(one.in_file(full_scale).level_af_max for one in of.assessments)


def nearly_inaudible(of: Survey, full_scale: float) -> bool:
    """Whether a sound is drowned at a full scale [unit of the sound]; digital silence is not one.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.audio.rendering import survey
    >>> tone = 0.02 * np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> of = survey([Recording(tone, 48e3, (Channel("pressure"),), name="tone")])
    >>> nearly_inaudible(of, 20.0), nearly_inaudible(of, 0.1)
    (True, False)
    """
    level = loudest_in_file(of, full_scale)
    return math.isfinite(level) and level < LEAST_AUDIBLE
