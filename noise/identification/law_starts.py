"""Where a search for a law's numbers begins."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.identification.law_model import LawModel
from noise.identification.law_priors import SHARE_ASSUMED, share_error

if TYPE_CHECKING:
    from noise.identification.law_candidates import Candidate


_STUCK, _ELASTIC = (0.95, 1.0, 1.05), (0.85, 1.1, 1.5)
"""Factors on stiffness that are tried; an elastic contact hides some of the elastomer's [-];
assumed."""

_DAMPED = (0.55, 1.1)
"""And on damping [-]; assumed."""

_SHARED = (1.0, 0.45)
"""And on the elastomer's share of it, where that is not known [-]; assumed."""


def starts(model: LawModel) -> Iterator[tuple[NDArray[np.float64], list[NDArray[np.float64]]]]:
    """Give places to begin at.

    Parameters
    ----------
    model : LawModel

    Yields
    ------
    law : ndarray, shape (n_law,)
        The law's own parameters [-].
    local : list of ndarray, shape (n_recordings, 7)
        Numbers of the recordings that go with it; each recording may take another [-].
    """
    own = np.stack([one.start for one in model.subjects])
    sticks = model.candidate.sticks
    grid = list(itertools.product(
        np.log(model.candidate.drops), np.log(_STUCK if sticks else _ELASTIC), np.log(_DAMPED),
        np.log(_SHARED if share_error(model) > SHARE_ASSUMED else (1.0,)),
    ))  # fmt: skip
    for chosen in itertools.product(*(some for _, _, some in model.candidate.free.values())):
        begun = _begun(model.candidate, own, chosen)
        yield (
            np.log(chosen),
            [
                begun + np.array([stiffer, 0.0, drop, damped, 0.0, 0.0, share])
                for drop, stiffer, damped, share in grid
            ],
        )


def _begun(
    candidate: Candidate, local: NDArray[np.float64], chosen: tuple[float, ...]
) -> NDArray[np.float64]:
    """Let a torque that fades with speed take the place of the step between two torques."""
    if "share" not in candidate.free:
        return local
    share = chosen[list(candidate.free).index("share")]
    begun = local.copy()
    begun[:, 1] -= math.log(1.0 - share)
    return begun
