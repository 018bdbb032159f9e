"""A law's parameters, and the bushing's with them, by statistics that have no phase.

Stick-slip is chaotic: two runs of one rig agree in no waveform. So what is fitted is what repeats
agree in, levels in bands and the distribution of torque and slope, by damped least squares
(Levenberg 1944, Marquardt 1963) with slopes from finite steps that are wide against the roughness
of such statistics, begun at several places.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.identification.law_model import simulated_torque, torque_statistics

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.identification.law_model import LawModel
    from noise.identification.measured import Measured

__all__ = ["LawFit", "fit_law"]

_STEP = 0.03
"""Of the logarithms, for slopes."""

_BEND = 3.0
_HOPELESS = 30.0
_GROUPS = 30.0
"""Statistics hang together: so many count as one observation."""

_ITERATIONS = {True: 8, False: 4}
"""By whether a law truly sticks, which is solved exactly and fast."""

_ELASTIC_DAMPING = 0.8
"""Width for a damping that was read off an elastic contact as if it stuck."""

_WIDTH = {"stiffness": 0.15, "kinetic": 0.08, "drop": 0.5, "damping": 0.3, "law": 1.0}
"""Relative standard deviation of the start [-]."""


@dataclass(frozen=True, eq=False)
class LawFit:
    """A law fitted to recordings.

    Parameters
    ----------
    model : LawModel
    vector : ndarray, shape (n,)
        Logarithms.
    cost : float
        Root mean square deviation, in standard deviations of repeats [-].
    spread : ndarray, shape (n,)
        Standard error of the vector by the curvature [-].
    """

    model: LawModel
    vector: NDArray[np.float64]
    cost: float
    spread: NDArray[np.float64]


def fit_law(
    model: LawModel,
    recordings: Sequence[Measured],
    targets: Sequence[NDArray[np.float64]],
    *,
    iterations: int | None = None,
    bushing: NDArray[np.float64] | None = None,
    begin: NDArray[np.float64] | None = None,
) -> LawFit:
    """Fit a law to recordings.

    Parameters
    ----------
    model : LawModel
    recordings : sequence of Measured
    targets : sequence of ndarray, shape (n_statistics,)
        Their statistics, as `torque_statistics` gives them [-].
    iterations : int, optional
    bushing : ndarray, shape (n_bushing,), optional
        Numbers of the bushing that a simpler law had, logarithms [-].
    begin : ndarray, shape (n,), optional
        Where to begin, logarithms [-]; by default at the best of the law's starts.

    Returns
    -------
    LawFit
    """
    low, high = model.limits()
    prior = model.starts()[0]
    n, s = len(model.base.fits), len(model.supports)
    if iterations is None:
        iterations = _ITERATIONS[model.candidate.sticks]
    of_damping = _WIDTH["damping"] if model.candidate.sticks else _ELASTIC_DAMPING
    width = np.array([
        *[_WIDTH["stiffness"]] * n, *[_WIDTH["kinetic"]] * n, *[_WIDTH["drop"]] * n,
        *[of_damping] * s, *[_WIDTH["law"]] * model.candidate.n_parameters,
    ])  # fmt: skip
    prior[model.n_bushing :] = np.mean(
        [start[model.n_bushing :] for start in model.starts()], axis=0
    )

    def residuals(vector: NDArray[np.float64]) -> NDArray[np.float64]:
        rig = model.rig(np.clip(vector, low, high))
        parts = []
        for like, target in zip(recordings, targets, strict=True):
            try:
                torque, _ = simulated_torque(rig, like)
                away = torque_statistics(torque, like.rate) - target
            except ParameterError:
                away = np.full(target.size, _HOPELESS)
            size = np.abs(away)
            bent = np.sign(away) * np.sqrt(_BEND * np.maximum(2.0 * size - _BEND, 0.0))
            parts.append(np.where(size <= _BEND, away, bent) / np.sqrt(_GROUPS))
        return np.concatenate([*parts, (vector - prior) / width])

    starts = [begin] if begin is not None else model.starts(bushing)
    tried = [residuals(start) for start in starts]
    best = int(np.argmin([r @ r for r in tried]))
    x, r = starts[best].copy(), tried[best]
    damping, jacobian = 0.1, np.eye(r.size, x.size)
    for _ in range(iterations):
        columns = []
        for i in range(x.size):
            moved = x.copy()
            step = _STEP if i < model.n_bushing else 3.0 * _STEP
            step = -step if x[i] + step > high[i] else step
            moved[i] += step
            columns.append((residuals(moved) - r) / step)
        jacobian = np.stack(columns, axis=1)
        normal, slope = jacobian.T @ jacobian, jacobian.T @ r
        before = float(r @ r)
        for _ in range(3):
            change = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), -slope)
            candidate = np.clip(x + np.clip(change, -0.7, 0.7), low, high)
            tried_r = residuals(candidate)
            if tried_r @ tried_r < before:
                x, r, damping = candidate, tried_r, damping / 5.0
                break
            damping *= 6.0
        if float(r @ r) > 0.98 * before:
            break
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    data = r[: -x.size]
    cost = float(np.sqrt(data @ data * _GROUPS / data.size))
    return LawFit(model, x, cost, np.sqrt(np.maximum(np.diag(covariance), 0.0)))
