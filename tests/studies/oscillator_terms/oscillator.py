"""A driven record, the linear oscillator, and what a model predicts in a stretch of record."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import resample

from models.errors import ParameterError
from tests.studies.oscillator_terms.motion import move, no_force

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tests.studies.oscillator_terms.registry import Term

__all__ = ["DrivenRecord", "Oscillator", "Span", "predicted"]

Span = tuple[int, int]
"""First sample, and the one after the last."""

_LONGEST_STEP = 0.35  # rad: Runge-Kutta's own error stays below 1e-4 of the response


@dataclass(frozen=True)
class Oscillator:
    """Linear model of one degree of freedom, drive to response.

    Parameters
    ----------
    frequency : float
        Natural frequency [Hz].
    damping : float
        Damping ratio.
    gain : float
        Static response a drive.
    drive_offset, response_offset : float
        Zero errors of the two signals, in their own units.

    Examples
    --------
    >>> Oscillator.of_mass(2.0, 4.0, 800.0).damping
    0.05
    """

    frequency: float
    damping: float
    gain: float
    drive_offset: float = 0.0
    response_offset: float = 0.0

    @classmethod
    def of_mass(cls, mass: float, resistance: float, stiffness: float) -> Oscillator:
        """Oscillator of a mass [kg], a dashpot [N s/m] and a spring [N/m]; its drive is a force."""
        omega = math.sqrt(stiffness / mass)
        ratio = resistance / (2.0 * math.sqrt(stiffness * mass))
        return cls(omega / (2.0 * math.pi), ratio, 1.0 / stiffness)

    @property
    def array(self) -> NDArray[np.float64]:
        """The five parameters in the order of the fields."""
        return np.array(
            [self.frequency, self.damping, self.gain, self.drive_offset, self.response_offset]
        )


@dataclass(frozen=True, eq=False)
class DrivenRecord:
    """Drive and response of a system, sampled together.

    The drive is taken to be band-limited between its samples, as an anti-aliasing filter leaves it.

    Parameters
    ----------
    drive, response : ndarray, shape (n_samples,)
        In any units.
    rate : float
        Sampling rate [Hz].

    Raises
    ------
    ParameterError
        If the two differ in length, are constant or not finite, or the rate is not positive.
    """

    drive: NDArray[np.float64]
    response: NDArray[np.float64]
    rate: float

    def __post_init__(self) -> None:
        if self.drive.ndim != 1 or self.drive.shape != self.response.shape:
            raise ParameterError(
                f"drive of shape {self.drive.shape} and response of shape {self.response.shape} "
                f"must be two series of one length"
            )
        if not (np.all(np.isfinite(self.drive)) and np.all(np.isfinite(self.response))):
            raise ParameterError("drive and response must be finite; remove gaps first")
        if not (np.ptp(self.drive) > 0.0 and np.ptp(self.response) > 0.0):
            raise ParameterError("drive and response must vary; one of them is constant")
        if not 0.0 < self.rate < math.inf:
            raise ParameterError(f"rate = {self.rate!r} Hz must be a positive number")

    @cached_property
    def units(self) -> tuple[float, float]:
        """Rms values of drive and response about their means: the scales that terms count in."""
        return float(np.std(self.drive)), float(np.std(self.response))

    def oversampled(self, steps: int) -> NDArray[np.float64]:
        """Drive at ``2 * steps`` instants a sample, shape (n_samples * 2 * steps,)."""
        kept = self._kept
        if steps not in kept:
            n = len(self.drive)
            folded = np.concatenate((self.drive, self.drive[::-1]))  # no jump where it wraps
            kept[steps] = np.ascontiguousarray(
                resample(folded, 4 * n * steps)[: 2 * n * steps], dtype=np.float64
            )
        return kept[steps]

    @cached_property
    def _kept(self) -> dict[int, NDArray[np.float64]]:
        return {}


def predicted(
    record: DrivenRecord,
    parameters: NDArray[np.float64],
    term: Term | None,
    coefficients: NDArray[np.float64],
    reference: Oscillator,
    span: Span,
) -> NDArray[np.float64]:
    """Response that a model predicts in a stretch of the record, by free-run simulation.

    Parameters
    ----------
    record : DrivenRecord
        The measurement; of its response nothing but the rms value is used.
    parameters : ndarray, shape (5,)
        `Oscillator.array`.
    term : Term, optional
        What is added to the linear model.
    coefficients : ndarray, shape (n_coefficients,)
        Of the term.
    reference : Oscillator
        Its frequency counts velocities and angles, its damping the run-in before the span.
    span : tuple of int
        First sample, and the one after the last.

    Returns
    -------
    ndarray, shape (stop - start,)
        In the unit of the response.
    """
    drive_unit, unit = record.units
    frequency, damping, gain, drive_zero, zero = parameters
    turn = 2.0 * math.pi * reference.frequency
    steps = max(1, math.ceil(1.3 * turn / record.rate / _LONGEST_STEP))
    first = max(0, span[0] - _run_in(record.rate, reference))
    drive = record.oversampled(steps)[2 * steps * first : 2 * steps * span[1]] - drive_zero
    drive = drive / drive_unit
    if term is not None and term.driven is not None:
        drive = term.driven(drive, coefficients)
    x = move(
        drive,
        steps,
        record.rate,
        2.0 * math.pi * frequency,
        damping,
        gain * drive_unit / unit,
        turn,
        first / len(record.drive) - 0.5,
        1.0 / len(record.drive),
        no_force if term is None else term.force,
        coefficients,
    )
    if term is not None and term.sensed is not None:
        x = term.sensed(x, coefficients, turn / record.rate)
    response: NDArray[np.float64] = x[span[0] - first :] * unit + zero
    return response


def _run_in(rate: float, reference: Oscillator) -> int:
    """Count the samples after which a wrong start has decayed by 87 dB (e to the tenth)."""
    decay = 2.0 * math.pi * reference.frequency * max(reference.damping, 0.005)
    return math.ceil(10.0 / decay * rate)
