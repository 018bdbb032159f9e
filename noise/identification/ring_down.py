"""The ring-down after the shaft is held: frequency and decay of the clamp on beams and elastomer.

With the shaft held and the contact holding, the clamp rings on beams and elastomer together,
J_C x'' + (c_E + c_B) x' + (k_E + k_B) x = 0, and the torque of the cell with it (5.3 to 5.7).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.optimize import least_squares

from models.show import short_repr
from noise.identification.evidence import Evidence

if TYPE_CHECKING:
    from noise.identification.bushing_fit import Known


_BAND = 60.0, 2000.0
"""In which it is sought [Hz]; assumed."""

_STILL = 3e-3
"""Angle by which a held shaft may move, over the range of the recording [-]; assumed."""

_LEAST_RATE = 4e3
_LEAST, _LOOKED_AT = 0.02, 0.06
"""Of a held stretch [s]; assumed."""

_SETTLED = 1e-3
"""Left out after the shaft stops [s]; assumed."""

_CLEAR = 0.1
"""Share of the band's power that a ring-down explains; assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class RingDown:
    """Free decay of the torque.

    Parameters
    ----------
    frequency : float
        Of the undamped mode [Hz].
    decay : float
        Rate at which the amplitude falls [1/s].
    frequency_error, decay_error : float
        Relative standard errors [-].
    time, torque, fitted : ndarray, shape (n,)
        [s], and what is left of the torque without its slow part [Nm].
    """

    frequency: float
    decay: float
    frequency_error: float
    decay_error: float
    time: NDArray[np.float64]
    torque: NDArray[np.float64]
    fitted: NDArray[np.float64]


def find_ring_down(
    torque: NDArray[np.float64], angle: NDArray[np.float64], rate: float
) -> RingDown | None:
    """Find and fit the ring-down after the shaft's last motion.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        [Hz]

    Returns
    -------
    RingDown or None
        None where the shaft is not held at the end, or nothing rings.

    Examples
    --------
    >>> t = np.arange(6000) / 20e3
    >>> angle = np.minimum(t, 0.1) * 0.1
    >>> ring = np.where(t > 0.1, np.exp(-60.0 * (t - 0.1)) * np.sin(1800.0 * (t - 0.1)), 0.0)
    >>> found = find_ring_down(500.0 * angle + 0.1 * ring, angle, 20e3)
    >>> round(found.decay), round(2.0 * np.pi * found.frequency)
    (60, 1801)
    """
    if rate < _LEAST_RATE:
        return None
    rest = float(np.median(angle[-max(10, angle.size // 100) :]))
    away = np.abs(uniform_filter1d(angle - rest, max(1, round(_SETTLED * rate))))
    # an encoder's noise is less than what a shaft that still moves goes
    noise = 1.4826 * float(np.median(np.abs(np.diff(angle)))) * 4.0
    moving = np.flatnonzero(away > max(_STILL * float(np.ptp(angle)), noise))
    begin = (int(moving[-1]) + 1 if moving.size else 0) + round(_SETTLED * rate)
    stop = min(angle.size, begin + round(_LOOKED_AT * rate))
    if moving.size == 0 or stop - begin < _LEAST * rate:
        return None
    time = np.arange(stop - begin) / rate
    slow = np.polynomial.Polynomial.fit(time, torque[begin:stop], 2)
    ring = torque[begin:stop] - slow(time)
    frequency = np.fft.rfftfreq(4 * ring.size, 1.0 / rate)
    power = np.abs(np.fft.rfft(ring, 4 * ring.size)) ** 2
    band = (frequency > _BAND[0]) & (frequency < min(_BAND[1], 0.4 * rate))
    top = float(frequency[band][np.argmax(power[band])])

    def parts(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        turn, fall = 2.0 * np.pi * np.exp(x[0]) * time, np.exp(-np.exp(x[1]) * time)
        columns = np.column_stack(
            [fall * np.cos(turn), fall * np.sin(turn), np.ones_like(time), time]
        )
        amplitude, *_ = np.linalg.lstsq(columns, ring, rcond=None)
        return columns @ amplitude, ring

    def residuals(x: NDArray[np.float64]) -> NDArray[np.float64]:
        fitted, measured = parts(x)
        return np.asarray(fitted - measured)

    tried = [
        least_squares(residuals, np.log([top, decay]), method="lm") for decay in (15.0, 60.0, 200.0)
    ]
    fit = min(tried, key=lambda one: float(one.cost))
    fitted, _ = parts(fit.x)
    damped, decay = 2.0 * math.pi * math.exp(fit.x[0]), math.exp(fit.x[1])
    inside = _BAND[0] < damped / (2.0 * math.pi) < _BAND[1] and decay < 0.3 * damped
    explained = 1.0 - float(np.sum((ring - fitted) ** 2)) / max(float(ring @ ring), 1e-300)
    if not inside or decay * time[-1] < 1.0 or explained < _CLEAR:
        return None
    errors = np.sqrt(np.diag(np.linalg.pinv(fit.jac.T @ fit.jac)) * 2.0 * fit.cost / ring.size)
    return RingDown(
        math.hypot(damped, decay) / (2.0 * math.pi), decay, float(errors[0]), float(errors[1]),
        time, ring, fitted,
    )  # fmt: skip


def ring_evidence(
    ring: RingDown, name: str, interference: float, support_stiffness: float, known: Known,
    stiffness: float, error: float, *, yields: float = 1.0,
) -> tuple[Evidence, ...]:  # fmt: skip
    """Return what a ring-down says of damping and clamp.

    Parameters
    ----------
    ring : RingDown
    name : str
        Of the file.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    known : Known
        The clamp's inertia as it is known, and how the damping is shared.
    stiffness, error : float
        Of the elastomer [Nm/rad], and its relative standard error [-].
    yields : float
        Stiffness of elastomer and contact in series over that of the elastomer [-].

    Returns
    -------
    tuple of Evidence
        None with the clamp fixed, where nothing rings.
    """
    if math.isinf(support_stiffness):
        return ()
    both = support_stiffness + yields * stiffness
    by_ring = both / (2.0 * math.pi * ring.frequency) ** 2
    share = yields * stiffness / both
    error = math.hypot(2.0 * ring.frequency_error, share * error, _SUPPORT_ERROR)
    weights = error**-2, known.inertia_error**-2
    inertia = math.exp(
        (weights[0] * math.log(by_ring) + weights[1] * math.log(known.clamp_inertia)) / sum(weights)
    )
    of_inertia = math.sqrt(1.0 / sum(weights))
    # the elastomer twists by less than the clamp turns where the contact yields
    acting = 1.0 - known.damping_share + known.damping_share * yields**2
    return (
        Evidence("clamp_inertia", by_ring, error, None, None, name),
        Evidence(
            "damping", 2.0 * inertia * ring.decay / acting,
            math.hypot(ring.decay_error, of_inertia), interference, support_stiffness, name,
        ),
    )  # fmt: skip


_SUPPORT_ERROR = 0.01
"""Relative standard error of a support's stiffness as stated [-]; assumed."""
