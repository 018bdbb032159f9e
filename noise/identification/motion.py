"""Contact and shaft as the torque of the cell shows them, for one guess of stiffness and damping.

The equations are those of `noise.diagnosis.evidence.reconstruction`; here a fit asks for them some
hundred times, so the spectrum of the torque is kept and little else is computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, rfft, rfftfreq

from noise.diagnosis.evidence.reconstruction import LEAD, TAIL, closed_loop

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from noise.identification.measured import Measured
    from sim.bushing import LumpedBushing

__all__ = ["LIMIT", "Contact", "TorqueSpectrum", "torque_spectrum"]

LIMIT = 8000.0
"""Highest frequency kept [Hz], at most 0.3 of the rate; the flank ends a third above."""


@dataclass(frozen=True, eq=False)
class Contact:
    """Contact over time; arrays of shape (n,).

    Parameters
    ----------
    torque : ndarray, shape (n,)
        In the contact [Nm].
    sliding_speed : ndarray, shape (n,)
        [rad/s]
    """

    torque: NDArray[np.float64]
    sliding_speed: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TorqueSpectrum:
    """A torque ready for reconstruction.

    Parameters
    ----------
    spectrum : ndarray of complex, shape (n_lines,)
        Of the torque without its mean, band-limited [Nm].
    s : ndarray of complex, shape (n_lines,)
        i omega [rad/s]
    n : int
        Samples of the transform.
    kept : slice
        Samples that count.
    torque : ndarray, shape (n_kept,)
        Band-limited [Nm].
    shaft_speed : ndarray, shape (n_kept,)
        [rad/s]
    rate : float
        [Hz]
    """

    spectrum: NDArray[np.complex128]
    s: NDArray[np.complex128]
    n: int
    kept: slice
    torque: NDArray[np.float64]
    shaft_speed: NDArray[np.float64]
    rate: float

    def contact(self, bushing: LumpedBushing) -> Contact:
        """Rebuild the contact for a guess of the bushing."""
        s = self.s
        surface = self.spectrum / (bushing.elastomer_stiffness + bushing.elastomer_damping * s)
        if not bushing.clamp_is_fixed:
            surface += self.spectrum / (
                bushing.support_stiffness
                + bushing.support_damping * s
                + bushing.clamp_inertia * s * s
            )
        turning = surface * s
        speed = irfft(turning, self.n)[self.kept]
        acceleration = irfft(turning * s, self.n)[self.kept]
        return Contact(
            self.torque + bushing.elastomer_inertia * acceleration, self.shaft_speed - speed
        )


def torque_spectrum(measured: Measured, seconds: float | None = None) -> TorqueSpectrum:
    """Prepare a recording.

    Parameters
    ----------
    measured : Measured
    seconds : float, optional
        How much of it is looked at [s]; by default all.

    Returns
    -------
    TorqueSpectrum
        Shorter than the recording by `LEAD` and `TAIL`.
    """
    rate, n = measured.rate, measured.torque.size
    if seconds is not None:
        n = min(n, round(seconds * rate))
    torque = measured.torque[:n]
    mean = float(np.mean(torque))
    closed = closed_loop(torque, rate) - mean
    frequency = rfftfreq(closed.size, 1.0 / rate)
    low = min(LIMIT, 0.3 * rate)
    x = np.clip((frequency - low) / (low / 3.0), 0.0, 1.0)
    spectrum = rfft(closed) * (0.5 + 0.5 * np.cos(np.pi * x))
    kept = slice(round(LEAD * rate), n - round(TAIL * rate))
    return TorqueSpectrum(
        spectrum, 2j * np.pi * frequency, closed.size, kept,
        np.asarray(irfft(spectrum, closed.size)[kept]) + mean, measured.shaft_speed[kept], rate,
    )  # fmt: skip
