"""What else may sound where recordings are made: a car or a rig has no animals, no keyboards.

What cannot sound there does not decide how sure a name has to be, at the price of noises that are
missed.
"""

from __future__ import annotations

import re

from models.errors import ParameterError
from noise.base.labels import SURROUNDINGS
from noise.training.classifier.background_sounds import BACKGROUND_SOUNDS


def may_sound(kind: str, surroundings: str) -> bool:
    """Whether a kind of sound may be heard in a place.

    Parameters
    ----------
    kind : str
        Of a made-up sound, or a file's name with a kind in it.
    surroundings : str
        One of `noise.base.labels.SURROUNDINGS`.

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
    kind = kind.lower()
    if surroundings == "any":
        return True
    if kind in BACKGROUND_SOUNDS:
        return surroundings in BACKGROUND_SOUNDS[kind]["heard"]
    words = [kind, *re.split(r"[^a-z]+", kind)]
    elsewhere = tuple(
        word
        for name, row in BACKGROUND_SOUNDS.items()
        if surroundings not in row["heard"]
        for word in (name.partition("_")[0], *row.get("also", ()))
    )
    return not any(word.startswith(elsewhere) for word in words)
