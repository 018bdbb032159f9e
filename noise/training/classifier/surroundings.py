"""What else may sound where recordings are made: a car or a rig has no animals, no keyboards.

What cannot sound there is not learned, neither of made-up sounds nor of real ones; so it cannot be
taken for a noise less often at the price of noises that are missed.
"""

from __future__ import annotations

import re

from models.errors import ParameterError

_ANIMALS = ("cat", "cow", "crow", "dog", "frog", "hen", "pig", "rooster", "sheep", "birds",
            "cicada", "crickets", "fly")  # fmt: skip
_HOUSE = ("baby", "snoring", "sipping", "flush", "pouring", "drops", "can", "glass", "keyboard",
          "vacuum", "washing", "brushing", "fireworks", "fire", "sea", "chainsaw",
          "clapping")  # fmt: skip

SURROUNDINGS = {
    "any": (),
    "car": (*_ANIMALS, *_HOUSE, "hand_saw", "saw"),
    "rig": (*_ANIMALS, *_HOUSE, "rain", "thunder", "wind", "airplane", "helicopter", "train",
            "siren", "horn", "bells", "laughing"),
}  # fmt: skip
"""First words of what does not sound there, by the name of a place."""


def may_sound(kind: str, surroundings: str) -> bool:
    """Whether a kind of sound may be heard in a place.

    Parameters
    ----------
    kind : str
        Of a made-up sound, or a file's name with a kind in it.
    surroundings : str
        One of `SURROUNDINGS`.

    Raises
    ------
    ParameterError
        If there is no such place.

    Examples
    --------
    >>> may_sound("dog", "car"), may_sound("001_Dogbark_1-59513", "rig"), may_sound("horn", "car")
    (False, False, True)
    """
    if surroundings not in SURROUNDINGS:
        raise ParameterError(
            f"surroundings {surroundings!r} are unknown; there are {', '.join(SURROUNDINGS)}"
        )
    words = [kind.lower(), *re.split(r"[^a-z]+", kind.lower())]
    return not any(word.startswith(SURROUNDINGS[surroundings]) for word in words)
