"""When the blocks of a sound are due: evenly, with a shift that the listener asks for."""

from __future__ import annotations

__all__ = ["Pace"]

_BEHIND = 0.2
"""By more than which nobody catches up: the rest comes later [s]."""


class Pace:
    """One block after another, as they are played.

    Parameters
    ----------
    step : float
        From one block to the next [s].

    Examples
    --------
    >>> pace = Pace(0.02)
    >>> pace.early(0, 100.0), pace.early(1, 101.0)
    (0.0, 0.0)
    >>> round(pace.early(2, 101.005), 3)
    0.015
    >>> pace.sooner(0.01)
    >>> round(pace.early(2, 101.005), 3)
    0.005
    """

    def __init__(self, step: float) -> None:
        self._step = step
        self._begun: float | None = None

    def early(self, sequence: int, now: float) -> float:
        """Return how long to wait for a block, 0 where it is due [s].

        The clock runs once the first is made, which may take longer than all others.
        """
        if sequence == 0:
            return 0.0
        since = sequence * self._step
        if self._begun is None or now - self._begun - since > _BEHIND:
            self._begun = now - since
        return max(0.0, self._begun + since - now)

    def sooner(self, seconds: float) -> None:
        """Let all that follow come sooner by so much, later where it is negative [s]."""
        if self._begun is not None:
            self._begun -= seconds
