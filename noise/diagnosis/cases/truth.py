"""Known cause of a simulated case."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["KINDS", "Truth"]

KINDS = {
    "none": 0.12,
    "parameters": 0.12,
    "one": 0.38,
    "pair": 0.20,
    "triple": 0.06,
    "unknown": 0.12,
}
"""Classes of cases, and the share of each."""


@dataclass(frozen=True)
class Truth:
    """What a case is about.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    effects : tuple of str
        Names of what is missing in the model; of an unknown effect the name it has here.
    forms : tuple of str
    strengths : tuple of float
        From 0.01, which cannot be seen, to 1, which is strong [-].
    offsets : tuple of (str, float)
        Parameters that are off in all recordings, and by what factor.
    """

    kind: str
    effects: tuple[str, ...] = ()
    forms: tuple[str, ...] = ()
    strengths: tuple[float, ...] = ()
    offsets: tuple[tuple[str, float], ...] = ()
