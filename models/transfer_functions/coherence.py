"""The band in which a measured transfer function can be trusted, by its coherence."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError

if TYPE_CHECKING:
    from models.transfer_functions.transfer_function import TransferFunction

LEAST_COHERENCE = 0.5
"""Below it less than half of the output's power comes from the input [-]."""

_SMOOTHING = 1.06
"""Half width of the band over which the median of the coherence is taken: 1/6 octave in all."""


def trusted_band(transfer: TransferFunction, least: float = LEAST_COHERENCE) -> tuple[float, float]:
    """Lowest and highest frequency between which the response can be used [Hz].

    Without coherence these are its ends, but for a line at 0 Hz, where sensors measure nothing.
    With it, a line counts where the median coherence within 1/6 octave is at least `least`;
    single lines below it, such as at antiresonances, do no harm.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
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
        usable &= np.array(medians) >= least
    if not usable.any():
        return 0.0, 0.0
    lines = f[usable]
    return float(lines[0]), float(lines[-1])


def bands_below(transfer: TransferFunction, least: float) -> list[tuple[float, float]]:
    """Bands whose lines have a coherence below `least`, from first to last line [Hz].

    Lines nearer to each other than 6 % are told as one band. The line at 0 Hz does not count.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.arange(0.0, 101.0)
    >>> transfer = TransferFunction(f, 1j * f, np.where(f < 20, 0.1, 0.99))
    >>> bands_below(transfer, 0.8)
    [(1.0, 19.0)]
    """
    if transfer.coherence is None:
        return []
    lines = transfer.frequencies[(transfer.coherence < least) & (transfer.frequencies > 0.0)]
    gaps = np.flatnonzero(
        (lines[1:] > _SMOOTHING * lines[:-1]) & (np.diff(lines) > 1.5 * transfer.spacing)
    )
    parts = np.split(lines, gaps + 1) if lines.size else []
    return [(float(part[0]), float(part[-1])) for part in parts]


def check_band(transfer: TransferFunction, low: float, high: float) -> None:
    """Refuse a response that does not span a band with usable lines.

    Raises
    ------
    ParameterError
        It starts above `low` or stops below `high` [Hz].

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
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
