"""Training cases: drawn, simulated, and each summarised as a user's case would be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from joblib import Parallel, delayed

from models.errors import ParameterError
from noise.diagnosis.cases.draw import SHARED, draw_case
from noise.diagnosis.evidence.summary import NominalNumbers, case_table
from noise.training.causes.fit import Known, with_rows

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray


__all__ = ["known_cases", "known_cases_of_a_rig"]


def known_cases_of_a_rig(seeds: Sequence[int]) -> list[Known]:
    """Draw cases of one rig and summarise them; those that cannot be simulated are left out.

    Examples
    --------
    >>> cases = known_cases_of_a_rig([400_000, 400_001])
    >>> all(case.table.measured.shape == case.table.nominal.shape for case in cases)
    True
    """
    nominal, known = None, []
    for seed in seeds:
        try:
            case = draw_case(seed)
            nominal = nominal or NominalNumbers(case.rig)
            table = with_rows(case_table(case.recordings, case.rig, nominal=nominal), _single)
            known.append(Known(table, case.truth, seed // SHARED))
        except ParameterError:
            continue
    return known


def known_cases(seeds: range, workers: int = 1) -> Iterator[Known]:
    """Draw cases of one rig after the other; the first seed begins a rig."""
    rigs = [seeds[i : i + SHARED] for i in range(0, len(seeds), SHARED)]
    drawn = Parallel(n_jobs=workers, return_as="generator")(
        delayed(known_cases_of_a_rig)(rig) for rig in rigs
    )
    return (case for cases in drawn for case in cases)


def _single(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to single precision: cases stored in half the space are still the same ones."""
    return x.astype(np.float32).astype(np.float64)
