"""Filtering of signals by impulse responses, and impulse responses of transfer functions.

A response that is cut off at its highest line rings before and after the impulse. So for the
impulse response the table is continued: without a delay by its last value, as for a mass; with a
delay by a fading pulse of that delay. The remaining part before the impulse is added to the first
two samples such that low frequencies, which dominate a torque, do not change. This is fast and
sufficient where output and table are compared with each other; `models.transfer_functions.measured`
weights measured lines by their coherence.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from models.transfer_functions.transfer_function import TransferFunction

BLOCK = 2**18
"""Samples per block of a convolution, which bounds the memory for long signals."""


def convolve(
    signal: NDArray[np.float64],
    impulse_response: NDArray[np.float64],
    spectrum: NDArray[np.complex128] | None = None,
) -> NDArray[np.float64]:
    """Convolve a signal causally by overlap-add in blocks, which bounds the memory.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    impulse_response : ndarray, shape (m,)
        [unit of the output / unit of the signal]
    spectrum : ndarray, shape (`transform_size` // 2 + 1,), complex, optional
        Its transform, if cached for a signal of the same length.

    Returns
    -------
    ndarray, shape (n,)
        In the output's [unit], as long as the signal.

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
    """Return the length of the transforms of `convolve` for these numbers of samples.

    Examples
    --------
    >>> transform_size(1000, 25)
    1024
    """
    size: int = next_fast_len(min(signal, BLOCK) + impulse_response - 1, real=True)
    return size


FINER = 8
"""Refinement of the lines before linear interpolation [-]."""

_LAST = (0.8, 0.98)
"""Part of a table from which it is continued, as shares of its highest frequency."""

_PROMPT = 3e-4
"""Shortest delay [s]; a shorter one counts as a mass."""

_BEFORE = 5e-4
"""Time before the impulse beyond which a response is measurement noise [s]."""

_FEWEST_LINES = 16
_UNEVEN = 1e-3

_RINGS, _SILENT, _EARLY = 0.6, 0.75, 0.05
"""End of the full gate of a measured impulse response, end of its fade-out, and the gate before the
impulse, as shares of one over the spacing of lines."""


def impulse_response(transfer: TransferFunction, rate: float, n: int) -> NDArray[np.float64]:
    """Return the impulse response of a transfer function.

    Below its first line the transfer function falls as the square of frequency.

    Parameters
    ----------
    transfer : TransferFunction
    rate : float
        Sampling rate [Hz].
    n : int
        Number of samples, at least 2.

    Returns
    -------
    ndarray, shape (n,)
        For convolution with samples [output unit / input unit].

    Examples
    --------
    >>> lines = np.arange(0.0, 1e4 + 1.0, 10.0)
    >>> mass = TransferFunction(lines, np.full(lines.size, 2.0 + 0j))
    >>> abs(impulse_response(mass, 48e3, 2400)[:3]).round()
    array([2., 0., 0.])
    """
    frequencies = np.asarray(np.fft.rfftfreq(2 * n, 1.0 / rate), np.float64)
    impulse = irfft(_continued(transfer, frequencies), 2 * n)
    m = min(n, round(_BEFORE * rate))
    before = impulse[-m:]
    moment = float(np.arange(-m, 0) @ before)
    causal = np.asarray(impulse[:n])
    causal[0] += float(before.sum()) - moment
    causal[1] += moment
    return causal


def fill_between_lines(transfer: TransferFunction) -> TransferFunction:
    """Refine a measured transfer function between its lines.

    Linear interpolation and errors of the lines would cause echoes after one over the spacing; so
    the impulse response is gated, and transformed again with `FINER` times as many lines.

    Parameters
    ----------
    transfer : TransferFunction

    Returns
    -------
    TransferFunction
        From 0 Hz, without coherence; unchanged if the lines are not equally spaced.

    Examples
    --------
    >>> f = np.arange(10.0, 1001.0, 10.0)
    >>> fill_between_lines(TransferFunction(f, 1j * f)).spacing
    1.25
    """
    frequencies = transfer.frequencies
    steps = np.diff(frequencies)
    step = float(steps.mean())
    if frequencies.size < _FEWEST_LINES or np.ptp(steps) > _UNEVEN * step:
        return transfer
    lines = step * np.arange(1 + round(frequencies[-1] / step))
    spectrum = transfer.at(lines, falls_below=True)
    spectrum[0] = 0.0
    n = 2 * (lines.size - 1)
    impulse = irfft(spectrum, n)
    late = np.arange(n) / n
    out = np.clip((late - _RINGS) / (_SILENT - _RINGS), 0.0, 1.0)
    back = np.clip((1.0 - late) / _EARLY, 0.0, 1.0)
    gate = 0.5 + 0.5 * np.cos(np.pi * out)
    gate = np.maximum(gate, 0.5 + 0.5 * np.cos(np.pi * back))
    fine = np.zeros(FINER * n)
    fine[: n - n // 4] = (impulse * gate)[: n - n // 4]
    fine[-(n // 4) :] = (impulse * gate)[-(n // 4) :]
    table = np.asarray(step / FINER * np.arange(fine.size // 2 + 1), np.float64)
    return replace(transfer, frequencies=table, response=rfft(fine), coherence=None)


def share_before_cause(transfer: TransferFunction) -> float:
    """Return the acausal share of a transfer function by rms [-].

    Examples
    --------
    >>> f = np.arange(0.0, 1001.0)
    >>> delay = np.exp(-2j * np.pi * f * 0.01)
    >>> shares = [share_before_cause(TransferFunction(f, h)) for h in (delay, delay.conj())]
    >>> [round(share) for share in shares]
    [0, 1]
    """
    lines = np.arange(0.0, float(transfer.frequencies[-1]), transfer.spacing)
    impulse = irfft(transfer.at(lines, falls_below=True))
    power = np.square(impulse)
    return float(np.sqrt(power[impulse.size // 2 :].sum() / power.sum()))


def _continued(
    transfer: TransferFunction, frequencies: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Return the response at frequencies that may lie beyond the table."""
    response, end = transfer.at(frequencies, falls_below=True), float(transfer.frequencies[-1])
    first, last = (share * end for share in _LAST)
    top = (frequencies > first) & (frequencies <= last)
    if np.count_nonzero(top) < 3 or frequencies[-1] <= last:
        return response
    f, h = frequencies[top], response[top]
    delay = -float(np.angle(np.sum(h[1:] * np.conj(h[:-1])))) / (2.0 * np.pi * (f[1] - f[0]))
    if delay > _PROMPT:
        turning = np.exp(-2j * np.pi * frequencies * delay)
        size = np.mean(h * np.exp(2j * np.pi * f * delay))
        fading = 0.5 + 0.5 * np.cos(np.pi * np.clip((frequencies - end) / end, 0.0, 1.0))
        beyond = size * turning * fading
    else:
        beyond = np.full(frequencies.size, complex(np.mean(h.real)))
    mixed = np.clip((frequencies - 0.5 * (first + last)) / (0.5 * (last - first)), 0.0, 1.0)
    return np.asarray(response * (1.0 - mixed) + beyond * mixed)
