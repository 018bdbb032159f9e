"""Cross-validation: what a candidate predicts at each cell that it was not fitted to.

Closed is (before - after) / (before - floor), each the root mean square over the cells: before is
the constant-torque model, after the candidate fitted to the five other cells, floor what reading
the speeds alone makes. Its interval is a bootstrap over the cells (B. Efron, 1979, Ann. Statist.
7, 1). With six cells it is coarse: it says how much hangs on single cells, not more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.gap.distance import closed_fraction
from noise.training.calibrate.thesis_table import CELLS
from tests.studies.thesis_gap.candidates import Candidate
from tests.studies.thesis_gap.fit import Trials, fitted_point
from tests.studies.thesis_gap.slips import slip_errors
from tests.studies.thesis_gap.speeds import cell_error, errors, other_fits_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from tests.studies.thesis_gap.fit import Effort

__all__ = ["Closed", "Errors", "Finding", "closed", "errors_of", "examine"]

_DRAWS = 4000


@dataclass(frozen=True)
class Closed:
    """Share of the closable gap, with its 90 % interval; negative where the gap grew."""

    share: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.share:.2f} ({self.low:.2f} to {self.high:.2f})"


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of one rig, as logarithms of simulated over measured.

    Parameters
    ----------
    speeds : ndarray, shape (6,)
        Critical speeds at 0.279 mm.
    other_fits : ndarray, shape (9,)
        Critical speeds at 0.178 and 0.381 mm.
    slips : ndarray, shape (n_slip_cells,)
        Slip frequencies.
    """

    speeds: NDArray[np.float64]
    other_fits: NDArray[np.float64]
    slips: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Finding:
    """What a candidate comes to.

    Parameters
    ----------
    candidate : Candidate
    point : tuple of float
        Fitted to all six cells.
    fitted : Errors
        There; of the six cells in sample, of all else unseen.
    left_out : ndarray, shape (6,)
        Error at each cell by the fit to the five others.
    """

    candidate: Candidate
    point: tuple[float, ...]
    fitted: Errors
    left_out: NDArray[np.float64]


def errors_of(rig: Rig) -> Errors:
    """Return all errors of a rig."""
    return Errors(errors(rig), other_fits_errors(rig), slip_errors(rig))


def examine(
    candidate: Candidate, effort: Effort, known: dict[str, Trials] | None = None
) -> Finding:
    """Fit a candidate to all cells, and to all but each.

    A pair also starts from each of its effects alone, fitted to the same cells.

    Parameters
    ----------
    candidate : Candidate
    effort : Effort
    known : dict of str to Trials
        Of other candidates, by name; added to.

    Returns
    -------
    Finding
    """
    known = {} if known is None else known
    trials = known.setdefault(candidate.name, Trials(candidate))

    def fitted(training: Sequence[int]) -> tuple[float, ...]:
        starts = []
        if len(candidate.effects) > 1:
            for position, name in enumerate(candidate.effects):
                alone = known.setdefault(name, Trials(Candidate((name,))))
                starts.append(candidate.nested(position, fitted_point(alone, training, effort)))
        return fitted_point(trials, training, effort, starts)

    cells = range(len(CELLS))
    left_out = []
    for cell in cells:
        point = fitted([other for other in cells if other != cell])
        left_out.append(cell_error(candidate.rig(point), cell))
    point = fitted(cells)
    return Finding(candidate, point, errors_of(candidate.rig(point)), np.array(left_out))


def closed(
    before: NDArray[np.float64], after: NDArray[np.float64], floor: NDArray[np.float64]
) -> Closed:
    """Share of the gap that is closed.

    Parameters
    ----------
    before, after, floor : ndarray, shape (n_cells,)
        Errors without and with the candidate, and those that reading alone makes.

    Examples
    --------
    >>> floor = np.full(4, 0.1)
    >>> closed(np.full(4, 0.7), np.full(4, -0.4), floor)
    Closed(share=0.5, low=0.5, high=0.5)
    """
    n = before.size
    drawn = np.random.default_rng(0).integers(0, n, (_DRAWS, n))
    low, high = np.quantile(_shares(before, after, floor, drawn), [0.05, 0.95])
    whole = _shares(before, after, floor, np.arange(n)[None, :])[0]
    return Closed(*(round(float(v), 12) for v in (whole, low, high)))


def _shares(
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    floor: NDArray[np.float64],
    chosen: NDArray[np.intp],
) -> NDArray[np.float64]:
    """Return the closed share by row of chosen cells; nil where no gap is above the floor."""
    b, a, f = (
        np.sqrt(np.mean(np.square(values)[chosen], axis=1)) for values in (before, after, floor)
    )
    return np.where(b > f, closed_fraction(b, a, np.where(b > f, f, b - 1.0)), 0.0)
