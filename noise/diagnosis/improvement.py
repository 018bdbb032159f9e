"""The improved rig of a diagnosis: parameters recalibrated, effects put in, how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.show import short_repr

if TYPE_CHECKING:
    from models.rig import LawSpec, Rig


@short_repr
@dataclass(frozen=True, eq=False)
class Improvement:
    """What closes a gap, as a rig file can say it.

    Parameters
    ----------
    rig : Rig
        The improved one.
    factors : mapping of str to float
        On parameters of the rig that was diagnosed [-].
    effects : tuple of LawSpec
        That it gets besides those it has.
    in_responses : tuple of str
        Effects that are in its measured responses.
    spread : mapping of str to float
        Relative standard deviation of each fitted number, by the names that ``[tolerances]`` has
        [-].
    undetermined : tuple of str
        Fitted numbers of which the recordings say next to nothing.
    fitted_to, held_out : tuple of str
        Recordings.
    gap_before, gap_after : float
        On those held out, in floors [-].
    """

    rig: Rig
    factors: Mapping[str, float]
    effects: tuple[LawSpec, ...]
    in_responses: tuple[str, ...]
    spread: Mapping[str, float]
    undetermined: tuple[str, ...]
    fitted_to: tuple[str, ...]
    held_out: tuple[str, ...]
    gap_before: float
    gap_after: float
