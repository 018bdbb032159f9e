"""Friction torque and sliding speed, which no sensor measures, reconstructed from the torque cell.

The torque cell reads T = k_E (theta1 - theta2) + c (theta1' - theta2'), the elastomer's torque on
the clamp. The clamp's angle follows from it by the clamp's own equation (Figure 4.1),
J_C theta2'' + c_B theta2' + k_B theta2 = T, the elastomer's twist by the first one, and with the
surface's acceleration the torque in the contact is T_F = T + J_E theta1''. So drive, contact and
elastomer can be compared sample by sample, without a simulation whose phase drifts. Differentiation
amplifies noise of the cell, so everything is band-limited to `LIMIT`. The clamp's free decay from
before the recording is unknown, so `LEAD` is left out.

The speed of the shaft, and its unevenness, follow from the angle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from noise.base.arrays import Array
from sim.bushing import LumpedBushing

_SPEED_LIMIT = 60.0
"""Pass band of the shaft's speed; it fades out up to twice this frequency [Hz]."""


def angle_summary(angle: Array, speed: float, rate: float) -> dict[str, float]:
    """Summarise the speed of the shaft and its unevenness.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad], rising.
    speed : float
        Set speed [rad/s].
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of speeds over `speed` [-]; ``unevenness`` is that of an angle in radian,
        ``speed_line_at`` that of a frequency in hertz.

    Examples
    --------
    >>> time = np.arange(30_000) / 30e3
    >>> shaking = 2.0 * time + 0.001 * np.sin(2 * np.pi * 10.0 * time)
    >>> round(np.exp(angle_summary(shaking, 2.0, 30e3)["speed_line_at"]))
    10
    """
    n = angle.size
    mean_speed, left = _about_line(angle, rate)
    block = max(1, int(2.5e-3 * rate))
    means = left[: n // block * block].reshape(-1, block).mean(axis=1)
    v = np.diff(means) * rate / block / abs(speed)
    v -= v.mean()
    spread = float(v.std()) + 1e-9
    power = np.abs(rfft(v * np.hanning(v.size))) ** 2
    power[0] = 0.0
    best = int(np.argmax(power))
    return {
        "speed": math.log(max(abs(mean_speed), 1e-3) / abs(speed)),
        "unevenness": math.log(float(left.std()) + 1e-6),
        "speed_spread": math.log(spread),
        "speed_most": math.log(float(np.abs(v).max()) + 1e-6),
        "speed_kurtosis": float(np.mean(v**4)) / spread**4,
        "speed_skewness": float(np.mean(v**3)) / spread**3,
        "speed_line": float(power[best] / (power.sum() + 1e-30)),
        "speed_line_at": math.log(max(best, 1) * rate / block / v.size),
    }


def shaft_speed(angle: Array, rate: float) -> Array:
    """Return the speed of the shaft from its angle, below 60 Hz.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [rad/s]

    Examples
    --------
    >>> time = np.arange(3000) / 10e3
    >>> turning = 2.0 * time + 0.01 * np.sin(2 * np.pi * 10.0 * time)
    >>> round(float(shaft_speed(turning, 10e3)[1000]), 2)  # 2 + 0.2 pi
    2.63
    """
    n = angle.size
    mean_speed, left = _about_line(angle, rate)
    # Odd extension at both ends, so that neither value nor slope jumps there.
    m = min(round(0.05 * rate), n - 1)
    before, after = 2.0 * left[0] - left[m:0:-1], 2.0 * left[-1] - left[-2 : -m - 2 : -1]
    extended = np.concatenate([before, left, after])
    length = next_fast_len(extended.size, real=True)
    filtered = rfft(extended, length)
    derivative = _slow_derivative(length, rate)
    filtered[: derivative.size] *= derivative
    filtered[derivative.size :] = 0.0
    return np.asarray(mean_speed + irfft(filtered, length)[m : m + n])


@lru_cache(maxsize=8)
def _slow_derivative(length: int, rate: float) -> NDArray[np.complex128]:
    """Transfer function of a derivative that fades out above `_SPEED_LIMIT`, up to its end."""
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    frequency = frequency[frequency < 2.0 * _SPEED_LIMIT]
    x = np.clip((frequency - _SPEED_LIMIT) / _SPEED_LIMIT, 0.0, 1.0)
    response = 2j * np.pi * frequency * (0.5 + 0.5 * np.cos(np.pi * x))
    response.setflags(write=False)
    return np.asarray(response)


def _about_line(angle: Array, rate: float) -> tuple[float, Array]:
    """Return the mean speed [rad/s], and the angle less the fitted line [rad]."""
    time = (np.arange(angle.size, dtype=np.float64) - 0.5 * (angle.size - 1)) / rate
    left = angle - angle.mean()
    speed = float(time @ left) / float(time @ time)
    left -= speed * time
    return speed, left


LIMIT = 8000.0
"""Upper edge of the pass band [Hz], at most a third of the rate; its flank ends a third above;
assumed."""

LEAD = 0.06
"""Left out at the start, where earlier vibration of the clamp still decays [s]; assumed."""

TAIL = 0.01
"""Left out at the end, where the band limit lacks later samples [s]; assumed."""

_LEAST_RATE = 24e3
"""Least sampling rate of a reconstruction, above twice the end of the band limit [Hz]."""

_WAY_BACK = 0.25
"""Length over which a signal returns to its first value, for a periodic transform [s]."""


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """Motion of the rig over time.

    Parameters
    ----------
    rate : float
        Sampling rate: that of the recording, or a half or quarter of it [Hz].
    start : float
        Time of the first sample within the recording [s].
    torque, friction_torque : ndarray, shape (n,)
        In the torque cell, and in the contact [Nm].
    torque_rate : ndarray, shape (n,)
        [Nm/s]
    shaft_speed, sliding_speed : ndarray, shape (n,)
        [rad/s]
    clamp_speed : ndarray, shape (n,)
        [rad/s]
    by_stiffness, by_damping, by_clamp : ndarray, shape (n,)
        Change of the sliding speed per relative change of the elastomer's stiffness, of all damping
        and of the clamp's inertia [rad/s].
    """

    rate: float
    start: float
    torque: Array
    friction_torque: Array
    torque_rate: Array
    shaft_speed: Array
    sliding_speed: Array
    clamp_speed: Array
    by_stiffness: Array
    by_damping: Array
    by_clamp: Array


def reconstruct(
    torque: Array,
    shaft_speed: Array,
    rate: float,
    bushing: LumpedBushing,
    spectrum: NDArray[np.complex128] | None = None,
) -> Reconstruction:
    """Reconstruct friction torque and sliding speed from the measured torque.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm], at least 0.1 s of it.
    shaft_speed : ndarray, shape (n,)
        [rad/s]
    rate : float
        [Hz]
    bushing : LumpedBushing
    spectrum : ndarray of complex, optional
        Spectrum of the torque, if it is known already, as `closed_spectrum` returns it [Nm].

    Returns
    -------
    Reconstruction
        Shorter by `LEAD` and `TAIL`.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.bushing import lumped_bushing
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> run = simulate(rig, 1.0, interference=0.279e-3, support_stiffness=3745.0, seconds=0.3)
    >>> torque, speed = run.recording["torque"], np.full(9000, 1.0)
    >>> motion = reconstruct(torque, speed, 30e3, lumped_bushing(rig, 0.279e-3, 3745.0))
    >>> abs(float(np.median(motion.sliding_speed))) < 0.05  # it sticks most of the time
    True
    """
    n = torque.size
    mean = float(np.mean(torque))
    if spectrum is None:
        spectrum = closed_spectrum(torque, rate)
    length = closed_length(n, rate)
    # the band limit permits a lower sampling rate
    every = next(k for k in (4, 2, 1) if k == 1 or (rate >= k * _LEAST_RATE and length % k == 0))
    rate /= every
    inside = slice(round(LEAD * rate), n // every - round(TAIL * rate))
    filters = _filters(length, rate * every, bushing)
    bins = spectrum[: filters.shape[1]] / every
    bins[0] -= mean * (length // every)
    spectra = np.zeros((len(filters), length // every // 2 + 1), np.complex128)
    np.multiply(filters, bins, out=spectra[:, : bins.size])
    rows = irfft(spectra, length // every, axis=1, overwrite_x=True)[:, inside]
    torques, inertial, torque_rate, creep, by_stiffness, by_damping, *of_clamp = rows
    clamp_speed, by_clamp = of_clamp or np.zeros((2, torques.size))
    speed = shaft_speed[::every][inside]
    smooth = torques + mean
    return Reconstruction(
        rate=rate,
        start=inside.start / rate,
        torque=smooth,
        friction_torque=smooth + inertial,
        torque_rate=torque_rate,
        shaft_speed=speed,
        sliding_speed=speed - creep,
        clamp_speed=clamp_speed,
        by_stiffness=by_stiffness,
        by_damping=by_damping,
        by_clamp=by_clamp,
    )


@lru_cache(maxsize=6)
def _filters(length: int, rate: float, bushing: LumpedBushing) -> NDArray[np.complex128]:
    """Return the transfer functions from torque to each reconstructed signal.

    They end with the low-pass. Those of a clamp that moves come last.
    """
    frequency = np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64)
    low_pass = _low_pass(frequency, rate)
    n = int(np.flatnonzero(low_pass)[-1]) + 1
    s, low_pass = 2j * np.pi * frequency[:n], low_pass[:n]
    of_elastomer = bushing.elastomer_stiffness + bushing.elastomer_damping * s
    twist = low_pass / of_elastomer
    by_stiffness = bushing.elastomer_stiffness * s * twist / of_elastomer
    by_damping = bushing.elastomer_damping * s * s * twist / of_elastomer
    surface, of_clamp = twist, []
    if not bushing.clamp_is_fixed:
        yields = (
            bushing.support_stiffness + bushing.support_damping * s + bushing.clamp_inertia * s * s
        )
        clamp = low_pass / yields
        surface = twist + clamp
        by_damping = by_damping + bushing.support_damping * s * s * clamp / yields
        of_clamp = [clamp * s, bushing.clamp_inertia * s**3 * clamp / yields]
    inertial = bushing.elastomer_inertia * surface * s * s
    transfer = np.stack([
        low_pass, inertial, low_pass * s, surface * s, by_stiffness, by_damping, *of_clamp,
    ])  # fmt: skip
    transfer.setflags(write=False)
    return transfer


def closed_spectrum(signal: Array, rate: float) -> NDArray[np.complex128]:
    """Return the transform of a signal that `closed_loop` has extended.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [any unit]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray of complex, shape (`closed_length` // 2 + 1,)
        [unit of the signal]

    Examples
    --------
    >>> closed_spectrum(np.array([0.0, 2.0]), 8.0).real.round(1)
    array([ 4., -2.,  0.])
    """
    return np.asarray(rfft(closed_loop(signal, rate)))


def closed_length(n: int, rate: float) -> int:
    """Return the length of the signal that `closed_loop` returns, at a sampling rate [Hz].

    Examples
    --------
    >>> closed_length(2, 8.0)
    4
    """
    return int(next_fast_len(n + round(_WAY_BACK * rate), real=True))


def closed_loop(signal: Array, rate: float) -> Array:
    """Extend a signal by half a cosine back to its first value, so that it has no step.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        [any unit]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n_closed,)
        A quarter of a second longer, or more for a fast transform [unit of the signal].

    Examples
    --------
    >>> closed_loop(np.array([0.0, 2.0]), 8.0).round(1)
    array([0., 2., 2., 0.])
    """
    n = signal.size
    turn = 0.5 + 0.5 * np.cos(np.linspace(0.0, np.pi, closed_length(n, rate) - n))
    return np.concatenate([signal, signal[0] + turn * (signal[-1] - signal[0])])


def _low_pass(frequency: Array, rate: float) -> Array:
    low = min(LIMIT, rate / 3.0)
    x = np.clip((frequency - low) / (low / 3.0), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * x))
