"""Responses measured on the user's own rig, in place of those of modelled structure and plate.

What a rig file names with a support stands in for the response from the torque that the bushing
puts into clamp and beams to the acceleration, to the sound, or both. What is not given stays
modelled, as does all that the pulses of the anchors excite.

Transforming a measured spectrum back gives an output before its cause: the band ends abruptly, an
accelerance does not fall off towards it, lines scatter, and cutting off what comes before time
zero changes what was measured (by a quarter for an accelerance). So the impulse response is sought
the other way round: of all that are nil before time zero, the one whose spectrum comes nearest to
the measured lines, by least squares with each line weighted as far as it can be trusted. Phase is
kept as measured; nothing is taken to be minimum-phase, since a sound needs its delay. Lines that
are doubtful are thereby filled by what causality says of them. Outside the band nothing was
measured; there the spectrum is kept as small as the band allows, about a constant that is free,
which is how an accelerance goes on; below it rises with the square of frequency.

A response spans many orders of magnitude, and slips excite most where it is smallest. So errors
count relative to its envelope: the response is divided by a filter of that magnitude which begins
at time zero, as does its inverse, and multiplied by it again. The normal equations are those of two
transforms, solved by conjugate gradients in some twenty steps.
"""

import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft
from scipy.interpolate import CubicSpline
from scipy.sparse.linalg import LinearOperator, cg

from models.bench import HIGHEST_PLATE_FREQUENCY
from models.condition import CONDITION, same_support
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses
from models.schema import ReadBy
from models.show import short_repr
from models.transfer_functions.files import read_transfer_function
from models.transfer_functions.transfer_function import (
    TransferFunction,
    check_band,
    trusted_band,
)

OUTSIDE = 1e-3
"""Weight of smallness outside the band, relative to the measured lines."""

EXTRAPOLATED = 1e-2
"""Weight of what is extrapolated below the band."""

MEMORY = 0.8
"""Longest impulse response as a share of 1 / spacing; the rest is time before zero."""

_FLOOR, _DEEPEST = 1e-6, 1e-3  # of the envelope, which keep its logarithm finite
_TOLERANCE = 1e-6
_MOST_STEPS = 100
_EVEN = 1e-2  # of a line's distance from the grid, in spacings
_LARGEST_GRID = 2**22
_ONSET_SPAN = 1.5
_FEWEST_ONSET_LINES = 6


def causal_impulse_response(
    transfer: TransferFunction, rate: float, n_samples: int
) -> tuple[NDArray[np.float64], float]:
    """Impulse response that is nil before time zero, of a spectrum known in a band.

    Below the band the response is taken to rise with the square of frequency from nothing at 0 Hz,
    as acceleration and sound of a structure that is held do.

    Parameters
    ----------
    transfer : TransferFunction
        Its lines lie above 0 Hz; each is trusted as far as its coherence goes.
    rate : float
        Sampling rate wanted [Hz]; more than twice the highest frequency.
    n_samples : int
        Length wanted; what the spacing of the lines cannot tell is zero.

    Returns
    -------
    impulse_response : ndarray, shape (n_samples,)
        For convolution with samples [output unit / input unit].
    misfit : float
        Share of the lines' amplitude (weighted rms, relative to the envelope) that no causal
        response explains: what is noise, or truly before time zero.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.arange(10.0, 5001.0, 10.0)
    >>> late = TransferFunction(f, 2 * f**2 * np.exp(-2j * np.pi * f * 1e-3))
    >>> h, misfit = causal_impulse_response(late, 16e3, 800)
    >>> int(np.argmax(np.abs(h))), misfit < 0.1
    (16, True)
    """
    finest = rate * MEMORY / n_samples
    n_grid, lines, target, weights = _on_grid(transfer, rate, finest)
    n = max(1, min(n_samples, int(MEMORY * n_grid)))
    inside = np.zeros(n_grid // 2 + 1)
    wanted = np.zeros(n_grid // 2 + 1, dtype=np.complex128)
    first, last = int(lines[0]), int(lines[-1])
    inside[lines], wanted[lines] = weights, target
    inside[:first] = EXTRAPOLATED
    wanted[:first] = _onset(lines, target, weights, np.arange(first))
    outside = np.where(np.arange(inside.size) > last, OUTSIDE, 0.0)
    shape = _minimum_phase(_envelope(lines, target, weights, inside.size), n_grid)
    wanted /= shape

    def normal(h: NDArray[np.float64]) -> NDArray[np.float64]:
        spectrum = rfft(h, n_grid)
        result = irfft(inside * spectrum, n_grid)[:n]
        tail = irfft(outside * (spectrum - h[0]), n_grid)[:n]
        result[1:] += tail[1:]  # the first sample, a constant spectrum, is free
        return np.asarray(result)

    right = irfft(inside * wanted, n_grid)[:n]
    operator = LinearOperator((n, n), matvec=normal, dtype=np.float64)
    h, _ = cg(operator, right, rtol=_TOLERANCE, maxiter=_MOST_STEPS)
    whitened = rfft(h, n_grid)
    error = (whitened - wanted)[lines]
    power = float(weights @ np.abs(wanted[lines]) ** 2)
    misfit = float(np.sqrt(weights @ np.abs(error) ** 2 / power)) if power > 0.0 else 0.0
    result = np.zeros(n_samples)
    result[:n] = irfft(whitened * shape, n_grid)[:n]
    return result, misfit


def _on_grid(
    transfer: TransferFunction, rate: float, finest: float
) -> tuple[int, NDArray[np.intp], NDArray[np.complex128], NDArray[np.float64]]:
    """Lines on the grid of a transform: themselves where they fit it, else by cubic splines.

    `finest` is the spacing [Hz] beyond which interpolation gains nothing.
    """
    frequency, response, weight = transfer.frequencies, transfer.response, transfer.coherence
    if weight is None:
        weight = np.ones(frequency.size)
    spacing = float(np.min(np.diff(frequency)))
    n_grid = round(rate / spacing)
    if n_grid <= _LARGEST_GRID:
        position = frequency * n_grid / rate
        lines = np.rint(position).astype(np.intp)
        if np.abs(position - lines).max() < _EVEN and (np.diff(lines) > 0).all():
            return n_grid, lines, response, weight
    n_grid = round(rate / max(spacing, finest))
    step = rate / n_grid
    lines = np.arange(int(np.ceil(frequency[0] / step)), int(frequency[-1] / step) + 1)
    grid = lines * step
    return (
        n_grid,
        lines,
        CubicSpline(frequency, response)(grid),
        np.interp(grid, frequency, weight),
    )


def _envelope(
    lines: NDArray[np.intp],
    target: NDArray[np.complex128],
    weights: NDArray[np.float64],
    size: int,
) -> NDArray[np.float64]:
    """Magnitude averaged over an octave, on all bins; square of frequency below, held above."""
    trust = weights + np.finfo(np.float64).eps
    power = np.concatenate([[0.0], np.cumsum(trust * np.abs(target) ** 2)])
    total = np.concatenate([[0.0], np.cumsum(trust)])
    low = np.searchsorted(lines, lines / np.sqrt(2.0))
    high = np.searchsorted(lines, lines * np.sqrt(2.0), side="right")
    mean = np.sqrt((power[high] - power[low]) / (total[high] - total[low]))
    mean = np.maximum(mean, _FLOOR * mean.max())
    bins = np.arange(size)
    rise = np.minimum(bins / lines[0], 1.0) ** 2
    return np.asarray(np.interp(bins, lines, mean) * np.maximum(rise, _DEEPEST))


def _minimum_phase(magnitude: NDArray[np.float64], n_grid: int) -> NDArray[np.complex128]:
    """Spectrum of this magnitude whose impulse response, and its inverse's, begin at zero."""
    cepstrum = irfft(np.log(magnitude), n_grid)
    cepstrum[1 : (n_grid + 1) // 2] *= 2.0
    cepstrum[n_grid // 2 + 1 :] = 0.0
    return np.asarray(np.exp(rfft(cepstrum)))


def _onset(
    lines: NDArray[np.intp],
    target: NDArray[np.complex128],
    weights: NDArray[np.float64],
    below: NDArray[np.intp],
) -> NDArray[np.complex128]:
    """Continue below the band: (a + i b f) f^2 through its first half octave."""
    span = lines <= max(_ONSET_SPAN * lines[0], lines[min(_FEWEST_ONSET_LINES, lines.size) - 1])
    f, scale = lines[span], float(lines[0])
    x = f / scale
    trust = weights[span] + np.finfo(np.float64).eps
    part = target[span] / x**2
    a = float(np.average(part.real, weights=trust))
    b = float(np.average(part.imag / x, weights=trust))
    y = below / scale
    onset = np.empty(below.size, dtype=np.complex128)
    onset.real, onset.imag = a * y**2, b * y**3
    return onset


BAND = 0.45
"""Share of the sampling rate up to which lines are used, as modes are."""

LARGEST_MISFIT = 0.5
"""Share of a response that may come before its cause; more is no noise but an error of sign."""


LOWEST, HIGHEST = 100.0, 5000.0
"""Band that a measured response must span [Hz]: slips repeat above 100 Hz where they sound as a
tone, the clamp on its beams resonates at 140 Hz and above, and a torque that breaks loose has
nothing left to say at 5 kHz."""


def _response(path: Path, key: str, where: str, unit: str) -> TransferFunction:
    try:
        transfer = read_transfer_function(path, input_unit="N m", output_unit=unit)
        check_band(transfer, LOWEST, HIGHEST)
    except ParameterError as error:
        raise ParameterError(f"{where}: {key}: {error}") from None
    return transfer


@short_repr
@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """What was measured with one support.

    Parameters
    ----------
    support_stiffness : float
        [Nm/rad], or `models.condition.FIXED`.
    torque_to_acceleration, torque_to_pressure : TransferFunction, optional
        [m/s2 and Pa per Nm]; None where it was not measured.

    Examples
    --------
    >>> MeasuredResponse(2214.0).torque_to_pressure is None
    True
    """

    support_stiffness: Annotated[float, CONDITION["support_stiffness"]]
    torque_to_acceleration: Annotated[
        TransferFunction | None, ReadBy("torque_to_acceleration", partial(_response, unit="m/s^2"))
    ] = None
    torque_to_pressure: Annotated[
        TransferFunction | None, ReadBy("torque_to_pressure", partial(_response, unit="Pa"))
    ] = None


def measured_with(
    measured: Iterable[MeasuredResponse], support_stiffness: float
) -> MeasuredResponse | None:
    """Return what was measured with a support; None where nothing was.

    Parameters
    ----------
    measured : iterable of MeasuredResponse
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`.

    Examples
    --------
    >>> entries = (MeasuredResponse(2214.0), MeasuredResponse(3745.0))
    >>> measured_with(entries, 3745.1) is entries[1], measured_with(entries, math.inf)
    (True, None)
    """
    with_it = (
        entry for entry in measured if same_support(entry.support_stiffness, support_stiffness)
    )
    return next(with_it, None)


def with_measured(
    modelled: ImpulseResponses, measured: tuple[MeasuredResponse, ...], support_stiffness: float
) -> ImpulseResponses:
    """Put the measured responses of a support in place of the modelled ones.

    Parameters
    ----------
    modelled : ImpulseResponses
    measured : tuple of MeasuredResponse
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`; where nothing was measured with it, `modelled` is
        returned as it is.

    Raises
    ------
    ParameterError
        A response cannot be made causal.

    Warns
    -----
    UserWarning
        A response that ends within the band that the model fills, with the band it has; or
        nothing was measured with this support, but with others.

    Examples
    --------
    >>> import numpy as np
    >>> chain = ImpulseResponses(48e3, np.ones(9), np.ones(9), np.ones(9), np.ones(9))
    >>> with_measured(chain, (), 2214.0) is chain
    True
    """
    entry = measured_with(measured, support_stiffness)
    if entry is not None:
        rate = modelled.rate
        acceleration, pressure = modelled.torque_to_acceleration, modelled.torque_to_pressure
        if (transfer := entry.torque_to_acceleration) is not None:
            acceleration = measured_impulse_response(transfer, rate, acceleration.size)
        if (transfer := entry.torque_to_pressure) is not None:
            pressure = measured_impulse_response(transfer, rate, pressure.size)
        return replace(modelled, torque_to_acceleration=acceleration, torque_to_pressure=pressure)
    if measured:
        known = ", ".join(_named(entry.support_stiffness) for entry in measured)
        warnings.warn(
            f"no response was measured with the support {_named(support_stiffness)}, only with "
            f"{known}; it is modelled",
            stacklevel=2,
        )
    return modelled


@lru_cache(maxsize=16)
def measured_impulse_response(
    transfer: TransferFunction, rate: float, n_samples: int
) -> NDArray[np.float64]:
    """Impulse response of a measured response, nil before time zero.

    Parameters
    ----------
    transfer : TransferFunction
        Lines count as far as their coherence goes; those outside its trusted band are left out.
    rate : float
        Sampling rate [Hz].
    n_samples : int

    Returns
    -------
    ndarray, shape (n_samples,)
        For convolution with samples; read-only.

    Raises
    ------
    ParameterError
        More than half of the response comes before its cause.

    Warns
    -----
    UserWarning
        The response ends below 16 kHz, up to which plates are modelled, and what the rate carries.

    Examples
    --------
    >>> import numpy as np
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.arange(10.0, 5001.0, 10.0)
    >>> pure_delay = TransferFunction(f, np.exp(-2j * np.pi * f * 1e-3), None, "N m", "Pa")
    >>> h = measured_impulse_response(pure_delay, 10e3, 500)
    >>> int(np.argmax(h)), round(float(h.max()), 1)
    (10, 0.9)
    """
    first, last = trusted_band(transfer)
    top = min(last, BAND * rate)
    inside = (transfer.frequencies >= first) & (transfer.frequencies <= top)
    wanted = min(BAND * rate, HIGHEST_PLATE_FREQUENCY)
    if last < wanted:
        warnings.warn(
            f"{transfer.name}: measured from {first:.5g} to {last:.5g} Hz; what lies above, up to "
            f"{wanted:.5g} Hz, is missing from the simulated "
            f"{'sound' if transfer.output_unit == 'Pa' else 'acceleration'}",
            stacklevel=2,
        )
    trusted = replace(
        transfer,
        frequencies=transfer.frequencies[inside],
        response=transfer.response[inside],
        coherence=None if transfer.coherence is None else transfer.coherence[inside],
    )
    response, misfit = causal_impulse_response(trusted, rate, n_samples)
    if misfit > LARGEST_MISFIT:
        raise ParameterError(
            f"{transfer.name}: {100 * misfit:.0f} % of the response comes before its cause; the "
            "phase must be that of exp(+i omega t), and both signals must start at the same time"
        )
    response.flags.writeable = False  # shared by all that ask for the same response
    return response


def _named(support_stiffness: float) -> str:
    return "fixed" if math.isinf(support_stiffness) else f"{support_stiffness:g} Nm/rad"
