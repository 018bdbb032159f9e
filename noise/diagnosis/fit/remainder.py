"""What is left once the likeliest hypothesis is fitted: how much, in which channel and band."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.diagnosis.findings import Remainder
from noise.diagnosis.fit.closing import rms
from noise.diagnosis.gap.by_channel import worst_places

if TYPE_CHECKING:
    from noise.diagnosis.fit.case_comparison import CaseComparison
    from noise.diagnosis.simulated.model_runs import Model


_LEFT = 2.0
"""Floors from which on a gap after a fit is one to explain; assumed. Of simulated repeats 5 % are
farther off (`noise.diagnosis.text.agreement_sentences.AGREES`)."""


def remainder_of(comparison: CaseComparison, model: Model, held: Sequence[int]) -> Remainder | None:
    """Tell what a fitted model leaves on recordings that no fit has seen.

    Parameters
    ----------
    comparison : CaseComparison
    model : Model
    held : sequence of int
        These recordings.

    Returns
    -------
    Remainder or None
        None where it leaves no more than repeats differ by, or cannot be simulated there.
    """
    try:
        deviations = np.array(comparison.deviations(model, held))
    except ParameterError:
        return None
    gap = rms(comparison.squared(model, held))
    return None if gap < _LEFT else Remainder(gap, *worst_places(deviations))
