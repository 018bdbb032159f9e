"""Transfer function: output per unit of input of a linear system, as a table over frequency.

Modelled functions, hammer measurements and estimates from recordings share this type. A measured
one can be trusted where its coherence is high.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.show import short_repr


@short_repr
@dataclass(frozen=True, eq=False)
class TransferFunction:
    """Transfer function as a table over frequency.

    Parameters
    ----------
    frequencies : ndarray, shape (n,)
        [Hz], rising, evenly spaced or not.
    response : ndarray, shape (n,), complex
        Output per input [`output_unit` / `input_unit`] with the convention exp(+i omega t): a delay
        has a negative phase.
    coherence : ndarray, shape (n,), optional
        Between 0 and 1 [-]; None if unknown.
    input_unit, output_unit : str
        Such as ``"N m"`` and ``"Pa"``; empty for a ratio [-].
    name : str
        Name in messages, usually the file's.

    Examples
    --------
    >>> f = np.array([1.0, 2.0])
    >>> TransferFunction(f, 1j * f, None, "N", "m/s^2").spacing
    1.0
    """

    frequencies: NDArray[np.float64]
    response: NDArray[np.complex128]
    coherence: NDArray[np.float64] | None = None
    input_unit: str = ""
    output_unit: str = ""
    name: str = "response"

    @property
    def spacing(self) -> float:
        """Mean spacing of the lines [Hz]."""
        return float((self.frequencies[-1] - self.frequencies[0]) / (self.frequencies.size - 1))

    def at(
        self, frequencies: NDArray[np.float64], *, falls_below: bool = False
    ) -> NDArray[np.complex128]:
        """Evaluate at other frequencies, by linear interpolation; 0 above the last line.

        Parameters
        ----------
        frequencies : ndarray, shape (m,)
            [Hz]
        falls_below : bool
            Whether it falls as the square of frequency below the first line, like acceleration and
            sound of a supported structure; otherwise it is constant there.

        Returns
        -------
        ndarray, shape (m,), complex
            [`output_unit` / `input_unit`]

        Examples
        --------
        >>> measured = TransferFunction(np.array([2.0, 4.0]), np.array([8.0 + 0j, 8.0 + 0j]))
        >>> measured.at(np.array([1.0, 3.0, 5.0]), falls_below=True)
        array([2.+0.j, 8.+0.j, 0.+0.j])
        """
        real = np.interp(frequencies, self.frequencies, self.response.real, right=0.0)
        imaginary = np.interp(frequencies, self.frequencies, self.response.imag, right=0.0)
        response = real + 1j * imaginary
        if falls_below:
            first = self.frequencies[0]
            response = response * np.minimum(frequencies / max(first, 1e-9), 1.0) ** 2
        return np.asarray(response)


LEAST_COHERENCE = 0.5
"""Coherence below which less than half of the output's power comes from the input [-]."""

_SMOOTHING = 1.06
"""Half width, as a ratio, of the band of 1/6 octave for the median of the coherence."""


def trusted_band(transfer: TransferFunction) -> tuple[float, float]:
    """Return the lowest and highest frequency of the usable part of a response [Hz].

    Without coherence these are its ends, except for a line at 0 Hz, where sensors measure nothing.
    With coherence, a line is usable if the median coherence within 1/6 octave is at least a half;
    single lines below, such as antiresonances, are allowed.

    Examples
    --------
    >>> f = np.arange(0.0, 101.0)
    >>> transfer = TransferFunction(f, 1j * f, np.where(f < 20, 0.1, 0.99))
    >>> trusted_band(transfer)
    (20.0, 100.0)
    """
    f = transfer.frequencies
    usable = f > 0.0
    if transfer.coherence is not None:
        low = np.searchsorted(f, f / _SMOOTHING)
        high = np.searchsorted(f, f * _SMOOTHING, side="right")
        medians = [np.median(transfer.coherence[a:b]) for a, b in zip(low, high, strict=True)]
        usable &= np.array(medians) >= LEAST_COHERENCE
    if not usable.any():
        return 0.0, 0.0
    lines = f[usable]
    return float(lines[0]), float(lines[-1])


def check_band(transfer: TransferFunction, low: float, high: float) -> None:
    """Raise if a response does not span a band with usable lines.

    Raises
    ------
    ParameterError
        The response starts above `low` or stops below `high` [Hz].

    Examples
    --------
    >>> f = np.arange(9.0)
    >>> check_band(TransferFunction(f, 1j * f, name="hit.csv"), 1.0, 5e3)
    Traceback (most recent call last):
    models.errors.ParameterError: hit.csv: stops at 8 Hz; it must reach from 1 to 5000 Hz
    """
    f = transfer.frequencies
    first, last = trusted_band(transfer)
    cause = ""
    if first > f[f > 0.0][0] or last < f[-1]:
        cause = f" with a coherence of {LEAST_COHERENCE:g} or more"
    wanted = f"it must reach from {low:g} to {high:g} Hz{cause}"
    if last < high:
        raise ParameterError(f"{transfer.name}: stops at {last:g} Hz; {wanted}")
    if first > low:
        raise ParameterError(f"{transfer.name}: starts at {first:g} Hz; {wanted}")
