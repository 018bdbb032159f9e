"""The library: many drawn cases, each summarised as a user's case would be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from joblib import Parallel, delayed

from models.errors import ParameterError
from noise.diagnosis.library.draw import draw_case
from noise.diagnosis.summary import case_table
from noise.diagnosis.training import Known

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["known_case", "known_cases"]


def known_case(seed: int) -> Known | None:
    """Draw a case and summarise it; None where what was drawn cannot be simulated.

    Examples
    --------
    >>> case = known_case(400_001)
    >>> case is None or case.table.measured.shape == case.table.nominal.shape
    True
    """
    try:
        case = draw_case(seed)
        return Known(case_table(case.recordings, case.rig), case.truth)
    except ParameterError:
        return None


def known_cases(first: int, count: int, workers: int = 1) -> Iterator[Known]:
    """Draw cases one after the other, those that cannot be simulated left out."""
    drawn = Parallel(n_jobs=workers, return_as="generator")(
        delayed(known_case)(seed) for seed in range(first, first + count)
    )
    return (case for case in drawn if case is not None)
