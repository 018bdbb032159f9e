"""Measured responses of a rig, which replace those of the modelled structure and plate.

The responses that a rig file names for a support replace the modelled ones from the torque on clamp
and beams to the acceleration, to the sound, or both. Other responses, and those to the anchors'
pulses, stay modelled.

The inverse transform of a measured spectrum rings before and after the impulse where the band ends
abruptly. So the spectrum is first continued beyond its band: below, it falls as the square of
frequency; above, without a delay by its last value, as for a mass, and with a delay by a fading
pulse of that delay. What remains before the impulse is added to the first two samples such that low
frequencies, which dominate a torque, do not change. The measured phase is used; a minimum phase
would lose the delay of the sound.
"""

import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from models.bench import HIGHEST_PLATE_FREQUENCY
from models.condition import CONDITION, same_support, support_name
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses
from models.schema import ReadBy
from models.transfer_functions.files import read_transfer_function
from models.transfer_functions.transfer_function import TransferFunction, check_band, trusted_band

BAND = 0.45
"""Share of the sampling rate up to which lines are used, as for modes."""

LARGEST_BEFORE = 0.5
"""Largest acausal share of a response; more indicates a wrong sign of the phase."""

LOWEST, HIGHEST = 100.0, 5000.0
"""Band that a measured response must span [Hz]: slips that sound tonal repeat above 100 Hz, the
clamp on its beams resonates from 140 Hz on, and the torque of a slip has almost nothing above 5
kHz."""


def _response(path: Path, key: str, where: str, unit: str) -> TransferFunction:
    try:
        transfer = read_transfer_function(path, input_unit="N m", output_unit=unit)
        check_band(transfer, LOWEST, HIGHEST)
    except ParameterError as error:
        raise ParameterError(f"{where}: {key}: {error}") from None
    return transfer


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """Responses measured with one support.

    Parameters
    ----------
    support_stiffness : float
        [Nm/rad], or `models.condition.FIXED`.
    torque_to_acceleration, torque_to_pressure : TransferFunction, optional
        [m/s2 and Pa per Nm]; None if not measured.

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
    """Return the responses measured with a support, or None.

    Parameters
    ----------
    measured : iterable of MeasuredResponse
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`.

    Examples
    --------
    >>> entries = (MeasuredResponse(2214.0), MeasuredResponse(3745.0))
    >>> measured_with(entries, 3745.1) is entries[1], measured_with(entries, 9999.0)
    (True, None)
    """
    with_it = (
        entry for entry in measured if same_support(entry.support_stiffness, support_stiffness)
    )
    return next(with_it, None)


def with_measured(
    modelled: ImpulseResponses, measured: tuple[MeasuredResponse, ...], support_stiffness: float
) -> ImpulseResponses:
    """Replace the modelled responses of a support by the measured ones.

    Parameters
    ----------
    modelled : ImpulseResponses
    measured : tuple of MeasuredResponse
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`; without responses for it, `modelled` is returned.

    Raises
    ------
    ParameterError
        A response is not causal.

    Warns
    -----
    UserWarning
        A response ends within the band of the model; or responses were measured with other supports
        only.

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
        others = ", ".join(support_name(entry.support_stiffness) for entry in measured)
        warnings.warn(
            f"no response was measured with the support {support_name(support_stiffness)}, only "
            f"with {others} (Nm/rad); it is modelled",
            stacklevel=2,
        )
    return modelled


@lru_cache(maxsize=16)
def measured_impulse_response(
    transfer: TransferFunction, rate: float, n_samples: int
) -> NDArray[np.float64]:
    """Return the causal impulse response of a measured transfer function.

    Parameters
    ----------
    transfer : TransferFunction
        Lines outside its usable band are left out.
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
        More than half of the response is acausal.

    Warns
    -----
    UserWarning
        The response ends below 16 kHz, the end of the plate's model, and below 0.45 of the rate.

    Examples
    --------
    >>> import numpy as np
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.arange(10.0, 5001.0, 10.0)
    >>> pure_delay = TransferFunction(f, np.exp(-2j * np.pi * f * 1e-3), None, "N m", "Pa")
    >>> h = measured_impulse_response(pure_delay, 10e3, 500)
    >>> int(np.argmax(h)), round(float(h.max()), 1)
    (10, 1.0)
    """
    first, last = trusted_band(transfer)
    top = min(last, BAND * rate)
    inside = (transfer.frequencies >= first) & (transfer.frequencies <= top)
    wanted = min(BAND * rate, HIGHEST_PLATE_FREQUENCY)
    if last < wanted:
        warnings.warn(
            f"{transfer.name}: measured from {first:.5g} to {last:.5g} Hz; above, up to "
            f"{wanted:.5g} Hz, the simulated "
            f"{'sound' if transfer.output_unit == 'Pa' else 'acceleration'} has no resonances",
            stacklevel=2,
        )
    trusted = fill_between_lines(
        replace(
            transfer,
            frequencies=transfer.frequencies[inside],
            response=transfer.response[inside],
            coherence=None,
        )
    )
    lines = np.arange(0.0, float(trusted.frequencies[-1]), trusted.spacing)
    power = np.square(irfft(trusted.at(lines, falls_below=True)))
    before = float(np.sqrt(power[power.size // 2 :].sum() / power.sum()))  # by rms
    if before > LARGEST_BEFORE:
        raise ParameterError(
            f"{transfer.name}: {100 * before:.0f} % of the response comes before its cause; the "
            "phase must be that of exp(+i omega t), and both signals must start at the same time"
        )
    response = impulse_response(trusted, rate, n_samples)
    response.flags.writeable = False  # shared by the cache
    return response


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
    """Return the impulse response of a transfer function, without regard to its coherence.

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
