"""What a request asks of a jury: which sounds, how many comparisons, how they are played."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.app.jury.order import Design
from noise.app.jury.playing import GAINS

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["MOST", "JurySetup", "read_design", "read_setup", "read_sounds"]

MOST = 40
"""Sounds that are compared."""

_LONGEST = 200
"""Of a question or a name [characters]."""

_MOST_REPEATED = 50
"""Share of pairs that may come again [%]."""


@dataclass(frozen=True)
class JurySetup:
    """A jury that is to begin.

    Parameters
    ----------
    sounds : tuple of int
        Their numbers among what was opened.
    design : Design
    listener, question, played : str
        As of `noise.app.jury.store.Jury`.
    """

    sounds: tuple[int, ...]
    design: Design
    listener: str
    question: str
    played: str


def read_setup(said: object) -> JurySetup:
    """Read how a jury is to begin.

    Raises
    ------
    ParameterError
        It is not understood.

    Examples
    --------
    >>> read_setup({"sounds": [0, 2], "question": "Which annoys more?"}).design.pairs
    1
    """
    sounds = read_sounds(said)
    asked = said if isinstance(said, dict) else {}
    question, listener = (_text(asked, key) for key in ("question", "listener"))
    if not question:
        raise ParameterError("question: must say what is asked of two sounds")
    played = asked.get("played", GAINS[0])
    if played not in GAINS:
        raise ParameterError(f"played: must be one of {', '.join(GAINS)}")
    return JurySetup(
        sounds, read_design({**asked, "sounds": len(sounds)}), listener, question, played
    )


def read_sounds(said: object) -> tuple[int, ...]:
    """Read which sounds are to be compared.

    Raises
    ------
    ParameterError
        They are not understood, or too many or too few.

    Examples
    --------
    >>> read_sounds({"sounds": [4, 2]})
    (2, 4)
    """
    sounds = said.get("sounds") if isinstance(said, dict) else None
    if not isinstance(sounds, list) or not all(type(one) is int for one in sounds):
        raise ParameterError("sounds: must be a list of numbers of recordings")
    found = tuple(sorted(set(sounds)))
    if not 2 <= len(found) <= MOST:
        raise ParameterError(f"{len(found)} sounds: 2 to {MOST} can be compared")
    return found


def read_design(said: Mapping[str, object]) -> Design:
    """Read how many comparisons there are to be.

    Raises
    ------
    ParameterError
        It is not understood.

    Examples
    --------
    >>> read_design({"sounds": "20", "each": "6", "repeats": "10"}).pairs
    60
    """
    n = _whole(said, "sounds", 2, MOST)
    each = _whole(said, "each", 2, MOST, missing=MOST)
    return Design(n, each, _whole(said, "repeats", 0, _MOST_REPEATED, missing=0) / 100)


def _whole(
    said: Mapping[str, object], key: str, low: int, high: int, missing: int | None = None
) -> int:
    value = said.get(key, missing)
    text = str(value) if type(value) in (int, str) else ""
    if not (text.isascii() and text.isdecimal() and len(text) < 4 and low <= int(text) <= high):
        raise ParameterError(f"{key} {text[:40]!r}: must be a whole number from {low} to {high}")
    return int(text)


def _text(said: Mapping[str, object], key: str) -> str:
    value = said.get(key, "")
    if not isinstance(value, str) or len(value) > _LONGEST:
        raise ParameterError(f"{key}: must be a text of at most {_LONGEST} characters")
    return " ".join(value.split())
