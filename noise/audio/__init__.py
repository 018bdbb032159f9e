"""Recordings as audible sound: for listening, and with a level that can be checked.

`sound` makes it, `gain` decides how loud, `sequence` puts sounds behind one another, `wav` and
`files` write it, `assessment` says what its levels are.
"""

from noise.audio.assessment import Assessment, assess
from noise.audio.files import write_audio
from noise.audio.gain import (
    QUIETEST_FULL_SCALE,
    common_full_scale,
    least_full_scale,
    true_peak,
)
from noise.audio.sequence import JoinedSound, Part, back_to_back
from noise.audio.sound import audible
from noise.audio.wav import BITS

__all__ = [
    "BITS",
    "QUIETEST_FULL_SCALE",
    "Assessment",
    "JoinedSound",
    "Part",
    "assess",
    "audible",
    "back_to_back",
    "common_full_scale",
    "least_full_scale",
    "true_peak",
    "write_audio",
]
