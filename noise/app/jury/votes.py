"""A vote: which of two sounds, and what was said."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["EQUAL", "FIRST", "SECOND", "VOTES", "Vote"]

FIRST, SECOND, EQUAL = "first", "second", "equal"

VOTES = (FIRST, SECOND, EQUAL)
"""What is voted for: the sound that is called A, the one that is called B, no difference."""


class Vote(NamedTuple):
    """Of sounds by their numbers.

    Parameters
    ----------
    first, second : int
        What was heard as A, and as B.
    said : str
        One of `VOTES`.

    Examples
    --------
    >>> Vote(3, 5, "second").chosen, Vote(3, 5, "second").other, Vote(3, 5, "equal").chosen
    (5, 3, None)
    """

    first: int
    second: int
    said: str

    @property
    def chosen(self) -> int | None:
        """The sound that was chosen; None for no difference."""
        return {FIRST: self.first, SECOND: self.second}.get(self.said)

    @property
    def other(self) -> int | None:
        """The sound that was not chosen; None for no difference."""
        return {FIRST: self.second, SECOND: self.first}.get(self.said)

    @property
    def pair(self) -> frozenset[int]:
        """Both sounds, whichever side they were on."""
        return frozenset((self.first, self.second))
