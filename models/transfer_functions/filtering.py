"""Signals sent through something linear, by its impulse response or by its transfer function.

A table ends at its highest line, and a response cut off there rings before the impulse as well as
after it. So for its impulse response the table is continued: what has no delay by its last value,
as of a mass, what comes late by a fading pulse of that delay. What still comes before the impulse
is put into its first two samples, such that low frequencies, of which a torque is full, are what
they were. This is quick, takes what the table says between its lines, and is enough where output
and table are compared with each other; `models.transfer_functions.measured` weighs measured lines
by their coherence.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

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


FINER = 8
"""By how much lines are refined before straight lines join them [-]."""

_LAST = (0.8, 0.98)
"""Part of a table that tells how it goes on, as shares of its highest frequency."""

_PROMPT = 3e-4
"""What comes later than this is a delay [s]; sooner, a mass."""

_BEFORE = 5e-4
"""What comes before the impulse by more than this is noise of the measurement [s]."""

_FEWEST_LINES = 16
_UNEVEN = 1e-3

_RINGS, _SILENT, _EARLY = 0.6, 0.75, 0.05
"""Up to where a measured impulse response counts, where it has faded, and how much of what comes
before the impulse counts, as shares of one over the spacing of lines."""


def impulse_response(transfer: TransferFunction, rate: float, n: int) -> NDArray[np.float64]:
    """Return the impulse response of a transfer function.

    Below its first line the transfer function is taken to fall as the square of frequency.

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
    """Fill in a measured transfer function between its lines, for as long as it can ring.

    Straight lines would have it echo after one over their spacing, and so would errors of the
    lines; so its impulse response is gated, and transformed again with `FINER` lines.

    Parameters
    ----------
    transfer : TransferFunction

    Returns
    -------
    TransferFunction
        From 0 Hz, without coherence; the one given where its lines are not equally spaced.

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
    """Return the share of a transfer function, by its rms, that comes before its cause [-].

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
    """Response at frequencies that go beyond the table."""
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
