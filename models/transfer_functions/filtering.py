"""Signals sent through something linear: by its impulse response, or by its transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.transfer_functions.transfer_function import TransferFunction

BLOCK = 2**18
"""Samples convolved at a time, which bounds the memory for long signals."""


def convolve(
    signal: NDArray[np.float64],
    impulse_response: NDArray[np.float64],
    spectrum: NDArray[np.complex128] | None = None,
) -> NDArray[np.float64]:
    """Causal convolution by overlap-add, in blocks, so that long signals need little memory.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    impulse_response : ndarray, shape (m,)
        [unit of the output / unit of the signal]
    spectrum : ndarray, shape (`transform_size` // 2 + 1,), complex, optional
        Its transform, if kept from a signal of the same length.

    Returns
    -------
    ndarray, shape (n,)
        In the output's own [unit], as long as the signal; what rings on after its end is dropped.

    Examples
    --------
    >>> convolve(np.array([1.0, 0.0, 2.0]), np.array([3.0, 1.0])).round(9)
    array([3., 1., 6.])
    """
    n, overlap = signal.size, impulse_response.size - 1
    size = transform_size(n, impulse_response.size)
    step = size - overlap
    if spectrum is None:
        spectrum = rfft(impulse_response, size)
    result = np.zeros(n)
    for start in range(0, n, step):
        block = irfft(rfft(signal[start : start + step], size) * spectrum, size)
        end = min(start + size, n)
        result[start:end] += block[: end - start]
    return result


def transform_size(signal: int, impulse_response: int) -> int:
    """Length of the transforms by which `convolve` works, for these numbers of samples.

    Examples
    --------
    >>> transform_size(1000, 25)
    1024
    """
    size: int = next_fast_len(min(signal, BLOCK) + impulse_response - 1, real=True)
    return size


def filter_period(
    period: NDArray[np.float64],
    rate: float,
    transfer: TransferFunction,
    *,
    falls_below: bool = False,
) -> NDArray[np.float64]:
    """Send a signal that repeats for ever through a transfer function.

    Parameters
    ----------
    period : ndarray, shape (n,)
        One period, in the transfer function's input [unit]. A signal that does not repeat is to be
        led back to its start, else it has a step there.
    rate : float
        Sampling rate [Hz].
    transfer : TransferFunction
    falls_below : bool
        As `TransferFunction.at` takes it.

    Returns
    -------
    ndarray, shape (n,)
        One period of the output, in the output [unit].

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> double = TransferFunction(np.array([0.0, 4e3]), np.array([2.0 + 0j, 2.0 + 0j]))
    >>> filter_period(np.array([1.0, 0.0, 0.0, -1.0]), 8e3, double).round(9)
    array([ 2.,  0.,  0., -2.])
    """
    n = period.size
    frequencies = np.asarray(np.fft.rfftfreq(n, 1.0 / rate), np.float64)
    spectrum = rfft(period) * transfer.at(frequencies, falls_below=falls_below)
    return np.asarray(irfft(spectrum, n))


def filter_signal(
    signal: NDArray[np.float64], rate: float, transfer: TransferFunction
) -> NDArray[np.float64]:
    """Send a signal through a transfer function, as if its ends went on.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In the transfer function's input [unit].
    rate : float
        Sampling rate [Hz].
    transfer : TransferFunction

    Returns
    -------
    ndarray, shape (n,)
        In the output [unit].

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> double = TransferFunction(np.array([0.0, 4e3]), np.array([2.0 + 0j, 2.0 + 0j]))
    >>> bool(np.allclose(filter_signal(np.ones(100), 8e3, double), 2.0))
    True
    """
    n = next_fast_len(2 * signal.size, real=True)
    bridge = np.linspace(signal[-1], signal[0], n - signal.size + 2)[1:-1]
    return filter_period(np.concatenate([signal, bridge]), rate, transfer)[: signal.size]
