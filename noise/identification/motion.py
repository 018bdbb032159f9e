"""Contact and shaft as the torque of the cell shows them, for one guess of stiffness and damping.

The equations are those of `noise.diagnosis.evidence.reconstruction`; here a fit asks for them some
hundred times, so the spectrum of the torque is kept and little else is computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft, rfftfreq
from scipy.ndimage import uniform_filter1d

from models.show import short_repr
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL, closed_loop

if TYPE_CHECKING:
    from noise.identification.measured import Measured
    from sim.bushing import LumpedBushing


LIMIT = 8000.0
"""Highest frequency kept [Hz], at most 0.3 of the rate; the flank ends a third above; assumed."""

_NOISE_ALONE = 0.85
"""Share of the highest frequency from which there is nothing but the cell's noise; assumed."""

_SMOOTHED = 150.0
"""Width over which a spectrum is smoothed to be told from noise [Hz]; assumed."""


@short_repr
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


@short_repr
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
    mean : float
        Of the torque [Nm].
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
    mean: float
    torque: NDArray[np.float64]
    shaft_speed: NDArray[np.float64]
    rate: float

    def contact(self, bushing: LumpedBushing) -> Contact:
        """Rebuild the contact for a guess of the bushing."""
        twist, clamp = self._angles(bushing)
        turning = (twist + clamp) * self.s
        acceleration = self._in_time(turning * self.s)
        return Contact(
            self.torque + bushing.elastomer_inertia * acceleration,
            self.shaft_speed - self._in_time(turning),
        )

    def states(self, bushing: LumpedBushing) -> NDArray[np.float64]:
        """Rebuild the motion for a guess of the bushing.

        Returns
        -------
        ndarray, shape (4, n_kept)
            theta1 [rad], theta1' [rad/s], theta2, theta2', as of the torque's mean at rest.
        """
        twist, clamp = self._angles(bushing)
        rest = self.mean / bushing.support_stiffness
        surface = twist + clamp
        return np.stack([
            self._in_time(surface) + rest + self.mean / bushing.elastomer_stiffness,
            self._in_time(surface * self.s),
            self._in_time(clamp) + rest,
            self._in_time(clamp * self.s),
        ])  # fmt: skip

    def _angles(
        self, bushing: LumpedBushing
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Spectra of the elastomer's twist and of the clamp's angle."""
        s = self.s
        twist = self.spectrum / (bushing.elastomer_stiffness + bushing.elastomer_damping * s)
        if bushing.clamp_is_fixed:
            return twist, np.zeros_like(twist)
        clamp = self.spectrum / (
            bushing.support_stiffness + bushing.support_damping * s + bushing.clamp_inertia * s * s
        )
        return twist, clamp

    def _in_time(self, spectrum: NDArray[np.complex128]) -> NDArray[np.float64]:
        return np.asarray(irfft(spectrum, self.n)[self.kept])


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
    lines = rfft(closed)
    spectrum = lines * _above_noise(lines, frequency) * (0.5 + 0.5 * np.cos(np.pi * x))
    kept = slice(round(LEAD * rate), n - round(TAIL * rate))
    return TorqueSpectrum(
        spectrum, 2j * np.pi * frequency, closed.size, kept, mean,
        np.asarray(irfft(spectrum, closed.size)[kept]) + mean, measured.shaft_speed[kept], rate,
    )  # fmt: skip


def _above_noise(
    lines: NDArray[np.complex128], frequency: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Share of each line that is no noise of the cell (Wiener 1949), which is taken for white.

    What differentiation would make of it looks like sliding where the contact sticks.
    """
    power = np.abs(lines) ** 2
    noise = float(np.mean(power[frequency > _NOISE_ALONE * frequency[-1]]))
    width = max(3, round(_SMOOTHED / frequency[1]))
    smooth = uniform_filter1d(power, width, mode="nearest")
    return np.asarray(np.maximum(1.0 - noise / np.maximum(smooth, noise), 0.0))
