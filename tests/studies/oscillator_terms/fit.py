"""Parameters and coefficients of a term, fitted together to a free-run simulation.

A term must be refitted with the parameters, or they keep what they had absorbed of it. They stay
within physical bounds about the nominal model: a fit that needs more is no recalibration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import csd

from models.errors import ParameterError
from tests.studies.oscillator_terms.oscillator import DrivenRecord, Oscillator, Span, predicted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from tests.studies.oscillator_terms.registry import Term

__all__ = ["Model", "fit_model", "linear_guess"]

_FREQUENCY = 1.2
_DAMPING = 4.0
_GAIN = 1.4
_OFFSET = 0.3
"""Bounds: factors of frequency, damping and gain, and rms values of the signals."""

_STARTS = (0.0, 0.1)
"""Where the coefficients start, as shares of their upper bounds; the better end is gone on with."""

_FEW = 3000
"""Samples that tell the better start."""

_WIDTHS = np.array([0.02, 0.1, 0.05, 0.1, 0.1])
"""Usual size of a step of the scaled parameters."""


@dataclass(frozen=True, eq=False)
class Model:
    """A fitted oscillator, perhaps with a term.

    Parameters
    ----------
    oscillator : Oscillator
        Its parameters.
    term : Term, optional
        What it has beside them.
    coefficients : ndarray, shape (n_coefficients,)
        Of the term.
    reference : Oscillator
        The nominal model that velocities are counted by.
    """

    oscillator: Oscillator
    term: Term | None
    coefficients: NDArray[np.float64]
    reference: Oscillator

    def error(self, record: DrivenRecord, span: Span) -> NDArray[np.float64]:
        """Return simulated less measured response in a stretch of a record."""
        simulated = predicted(
            record,
            self.oscillator.array,
            self.term,
            self.coefficients,
            self.reference,
            span,
        )
        error = simulated - record.response[span[0] : span[1]]
        # A model that runs away is as wrong as can be, and must stay comparable.
        worst = 1e3 * record.units[1]
        return np.clip(np.nan_to_num(error, nan=worst), -worst, worst)


def linear_guess(record: DrivenRecord, spans: Sequence[Span]) -> Oscillator:
    """Oscillator nearest to the measured transfer function, among a grid of them.

    Noise in the response leaves the transfer function (H1) unbiased, where it would bias a
    difference equation.

    Raises
    ------
    ParameterError
        If no oscillator explains half of the response that is coherent with the drive.
    """
    size = min(512, min(stop - start for start, stop in spans) // 2)
    cross, power = np.zeros(size // 2 + 1, complex), np.zeros(size // 2 + 1)
    for start, stop in spans:
        u, y = record.drive[start:stop], record.response[start:stop]
        frequencies, one = csd(u, y, record.rate, nperseg=size)
        cross += one
        power += csd(u, u, record.rate, nperseg=size)[1].real
    used = slice(2, None)
    w, h, weight = frequencies[used], cross[used] / power[used], power[used]
    best, found = np.inf, None
    for f in np.geomspace(4.0 * frequencies[1], 0.45 * record.rate, 240):
        for ratio in np.geomspace(0.003, 0.5, 16):
            shape = 1.0 / (1.0 - (w / f) ** 2 + 2j * ratio * w / f)
            norm = float(np.sum(weight * np.abs(shape) ** 2))
            gain = float(np.sum(weight * (np.conj(shape) * h).real)) / norm
            left = float(np.sum(weight * np.abs(h - gain * shape) ** 2))
            if left < best:
                best, found = left, Oscillator(float(f), float(ratio), gain)
    if found is None or best > 0.5 * float(np.sum(weight * np.abs(h) ** 2)):
        raise ParameterError(
            "the response to the drive in the quiet spans is not that of an oscillator; give the "
            "nominal model, or spans in which the response rises above its noise"
        )
    return found


def fit_model(
    record: DrivenRecord,
    spans: Sequence[Span],
    nominal: Oscillator,
    start: Oscillator,
    term: Term | None = None,
) -> Model:
    """Fit parameters, and a term's coefficients, to stretches of a record.

    Parameters
    ----------
    record : DrivenRecord
        The measurement.
    spans : sequence of tuple
        What may be used of it.
    nominal : Oscillator
        The bounds are about its values.
    start : Oscillator
        Where the search starts.
    term : Term, optional
        What is fitted beside the five parameters.

    Returns
    -------
    Model
        The best end of the searches.
    """
    drive_unit, unit = record.units
    scale = np.array(
        [
            nominal.frequency,
            nominal.damping,
            nominal.gain,
            _OFFSET * drive_unit,
            _OFFSET * unit,
        ]
    )
    centre = np.array([1.0, 1.0, 1.0, *(nominal.array / scale)[3:]])
    lowest = np.array([1 / _FREQUENCY, 1 / _DAMPING, 1 / _GAIN, centre[3] - 1, centre[4] - 1])
    highest = np.array([_FREQUENCY, _DAMPING, _GAIN, centre[3] + 1, centre[4] + 1])
    widths = _WIDTHS
    if term is not None:
        lowest = np.concatenate((lowest, term.lowest))
        highest = np.concatenate((highest, term.highest))
        widths = np.concatenate((widths, 0.1 * np.asarray(term.highest)))

    def search(
        first: NDArray[np.float64], used: Sequence[Span]
    ) -> tuple[float, NDArray[np.float64]]:
        measured = np.concatenate([record.response[a:b] for a, b in used])
        size = unit * math.sqrt(len(measured))

        def misfit(values: NDArray[np.float64]) -> NDArray[np.float64]:
            simulated = [
                predicted(record, values[:5] * scale, term, values[5:], nominal, span)
                for span in used
            ]
            away = np.nan_to_num((np.concatenate(simulated) - measured) / size, nan=1e3)
            # In a linear model the two zeros do the same: a faint pull to the nominal decides.
            return np.concatenate((np.clip(away, -1e3, 1e3), 1e-5 * (values[3:5] - centre[3:])))

        margin = 1e-6 * (highest - lowest)
        found = least_squares(
            misfit,
            np.clip(first, lowest + margin, highest - margin),
            bounds=(lowest, highest),
            x_scale=widths,
            xtol=1e-6,
            ftol=1e-6,
            max_nfev=40,
        )
        return float(found.cost), found.x

    first = start.array / scale
    if term is not None:
        few = [(a, min(b, a + _FEW)) for a, b in spans[:1]]
        ends = [
            search(np.concatenate((first, share * np.asarray(term.highest))), few)
            for share in _STARTS
        ]
        first = min(ends, key=lambda end: end[0])[1]
    values = search(first, spans)[1]
    fitted = Oscillator(*(float(value) for value in values[:5] * scale))
    return Model(fitted, term, np.ascontiguousarray(values[5:]), nominal)
