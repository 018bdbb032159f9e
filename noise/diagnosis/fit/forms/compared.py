"""Recordings beside what their own torque should have made of them: what forms are estimated from.

A torque that was measured is sent through the transfer functions of the rig file, so that nothing
that the contact does stands between; the shaft's own modulation is taken from its angle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import known_condition
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.evidence.angle_summary import shaft_speed
from noise.diagnosis.simulated.transfer_functions import predict

if TYPE_CHECKING:
    from noise.diagnosis.fit.case_comparison import CaseComparison


@dataclass(frozen=True, eq=False)
class Compared:
    """A recording.

    Parameters
    ----------
    rate : float
        [Hz]
    free : bool
        Whether the clamp stands on beams, rather than on the baseplate itself.
    measured : dict of str to ndarray, shape (n,)
        By kind of channel; those that were recorded [unit of the channel].
    expected : dict of str to ndarray, shape (n,)
        Of acceleration and pressure, by the measured torque [unit of the channel].
    transfer_functions : mapping of str to TransferFunction
        That it was sent through.
    modulation : ndarray, shape (n,), optional
        Shaft speed over its mean, less 1 [-].
    signature, nominal, scale : ndarray, shape (n_values,)
        Of the recording; middle of the simulated repeats, and what they scatter by As of
        `noise.diagnosis.gap.signature`.
    """

    rate: float
    free: bool
    measured: dict[str, NDArray[np.float64]]
    expected: dict[str, NDArray[np.float64]]
    transfer_functions: Mapping[str, TransferFunction]
    modulation: NDArray[np.float64] | None
    signature: NDArray[np.float64]
    nominal: NDArray[np.float64]
    scale: NDArray[np.float64]


def compared(comparison: CaseComparison, chosen: Sequence[int]) -> list[Compared]:
    """Compare recordings of a comparison.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int

    Returns
    -------
    list of Compared
        One a recording.
    """
    return [_one(comparison, i) for i in chosen]


def _one(comparison: CaseComparison, i: int) -> Compared:
    recording = comparison.recordings[i]
    c, rate = known_condition(recording.condition), recording.rate
    measured = {
        kind: recording.samples[row].astype(np.float64)
        for kind in ("torque", "acceleration", "pressure", "angle")
        if (row := recording.first(kind)) is not None
    }
    expected: dict[str, NDArray[np.float64]] = {}
    transfers: Mapping[str, TransferFunction] = {}
    if "torque" in measured:
        transfers = comparison.runs.transfer_functions.whole(recording)
        expected = {
            kind: predict(measured["torque"], rate, transfers[kind])
            for kind in ("acceleration", "pressure")
            if kind in measured
        }
    modulation = None
    if "angle" in measured:
        speed = shaft_speed(measured.pop("angle"), rate)
        modulation = np.asarray(speed / (speed.mean() or 1.0) - 1.0)
    reference = comparison.references[i]
    return Compared(
        rate, not math.isinf(c.support_stiffness), measured, expected, transfers, modulation,
        comparison.signatures[i], reference.mean, reference.scale,
    )  # fmt: skip
