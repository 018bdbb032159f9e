"""Friction regimes of a motion (Section 5.1), and slips: falls of the torque that are sudden.

They are defined by the torque, which a rig measures, and not by the solver's stick:

- *steady sliding*: its standard deviation is no more than a hundredth of its mean;
- *stick-slip*: it rises with time, and then suddenly drops, faster than a sticking contact could
  load it;
- *quasi-harmonic*: any other oscillation, harmonic, triangular or with several frequencies, with
  grazing contact or without.

The limits are not critical: over the cells of Tables 5.1 and 5.2, twice or half of either shifts no
critical speed by more than 0.25 rad/s, the spacing of the speeds.

Section 5.1.1 of the thesis defines stick-slip by a torque "which increased with time, and then
suddenly dropped", and (5.1) gives the scale of "suddenly": a sticking contact loads the elastomer
at k_E times the shaft's speed, and nothing on the rig loads it faster while the clamp is at rest.
So a fall is *sudden* where torque over k_E, the elastomer's twist, falls faster than the shaft
turns,

    -dT/dt / k_E > omega,

and the measure of stick-slip is the *sudden share* of the falls, the integral of
max(0, -dT/dt - k_E omega) over that of max(0, -dT/dt). Its limits are known:

- Harmonic or triangular oscillation without stick: the surface never moves back faster than the
  shaft moves forward, however often it grazes the shaft's speed, and the share is zero.
- Stick-slip of one undamped degree of freedom, with x = (T_crit - T_kin) omega_n / (k_E omega): a
  slip of duration 2 (pi - atan x) / omega_n after a stick of 2 x / omega_n; the share is
  (x - atan x) / sqrt(1 + x^2), from x^3 / 3 where stick vanishes to 1 for a sawtooth; the measured
  share is lower by up to 0.1, since the torque is smoothed to 2 kHz.
- A sawtooth that falls in the share q of its period: (1 - 2 q) / (1 - q), zero where it falls as
  slowly as it rises.

A *slip* is a sudden fall. A fall much weaker than the others is a swing of clamp or elastomer after
a slip. A fall within one natural period 2 pi / omega_n of the elastomer is a swing of the same
slip: with a stick between them, slips are 2 (x - atan x) / omega_n further apart than that. With
true stick, slips are those of the solver. The definition is independent of the solver's stick,
`Motion.stuck`, which no sensor measures: a surface that grazes the shaft's speed at every swing is
in stick for a few percent of the time, and neither sticks nor slips.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from sim.motion import Motion

LEAST_OSCILLATION = 0.01
"""Standard deviation of the torque over its mean above which it oscillates [-]."""


class Regime(StrEnum):
    """Friction regimes observed in the thesis."""

    STICK_SLIP = "stick-slip"
    QUASI_HARMONIC = "quasi-harmonic"
    STEADY_SLIDING = "steady sliding"


def friction_regime(motion: Motion) -> Regime:
    """Return the regime of the last half of a motion at constant speed.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Regime

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> friction_regime(simulate(load_material_rig("PDMS"), 5.0, seconds=0.1).motion).value
    'steady sliding'
    """
    last = motion.part(motion.torque.size // 2)
    deviation, mean = float(np.std(last.torque)), abs(float(np.mean(last.torque)))
    if deviation <= LEAST_OSCILLATION * mean:
        return Regime.STEADY_SLIDING
    sudden = motion_slips(last).sudden_share > LEAST_SUDDEN
    return Regime.STICK_SLIP if sudden else Regime.QUASI_HARMONIC


_CARRIED_ALONG = 0.2
"""Share of the shaft's highest speed below which a sliding contact has not broken loose.

A contact with an inner state, or with creep, yields by up to 0.16 while it is loaded, and exceeds
the shaft's speed when it breaks loose (shipped materials, rotation and oscillation).
"""

_START = 5e-3
"""Time in which a contact at rest takes up the motion of the shaft [s]."""


def never_slips(motion: Motion) -> bool:
    """Return whether the contact carries the bushing's surface along all the time.

    Parameters
    ----------
    motion : Motion

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> never_slips(simulate(rig, 5.0, seconds=0.1).motion)
    False
    >>> never_slips(simulate(rig.changed(critical_torque="x1000"), 5.0, seconds=0.1).motion)
    True
    """
    later = motion.sliding_speed[math.ceil(_START * motion.rate) :]
    fastest = float(np.abs(motion.shaft_speed).max())
    turned = fastest > 0.0 and later.size > 0
    return turned and float(np.abs(later).max()) <= _CARRIED_ALONG * fastest


LEAST_SUDDEN = 0.06
"""Sudden share of the torque's falls above which there is stick-slip [-]. Over the cells of Tables
5.1 and 5.2 few speeds lie near: most stick-slip lies above 0.2, all grazing below 0.025."""

_SMOOTHING = math.sqrt(math.log(2.0) / 2.0) / math.pi / 2_000.0
"""Standard deviation of a Gaussian that halves 2 kHz [s]; the torque has little above (5.2.3)."""

_LEAST_STRENGTH = 1.0 / 3.0
"""Least strength of a slip over their self-weighted mean; from 0.25 on the counts are the same."""

_SWING = 1.2
"""Least interval of slips, in natural periods of the elastomer. Without stick, swings are 1.03 to
1.15 apart, since the contact yields; with true stick, slips are seldom nearer than 1.25."""

_ALIKE = 0.02
"""Relative difference of strengths and intervals below which slips repeat."""

_LONGEST_PATTERN = 4


@dataclass(frozen=True, eq=False)
class Slips:
    """Times and strengths of the slips in a torque.

    Parameters
    ----------
    times : ndarray, shape (n_slips,)
        Time at which each fall of the torque begins, from the start of the signal [s]; empty if
        `sudden_share` does not exceed `LEAST_SUDDEN`.
    strengths : ndarray, shape (n_slips,)
        Largest excess of the twist's falling speed over the shaft's speed [rad/s].
    sudden_share : float
        Share of the torque's falls that is faster than the shaft could load it [-].
    """

    times: NDArray[np.float64]
    strengths: NDArray[np.float64]
    sudden_share: float

    @property
    def rate(self) -> float:
        """Mean rate of the slips [Hz]; NaN for fewer than two."""
        if self.times.size < 2:
            return math.nan
        return float((self.times.size - 1) / (self.times[-1] - self.times[0]))

    @property
    def pattern(self) -> int:
        """Number of slips after which they repeat: 1 to 4 (2 is period doubling); 0 for none."""
        described = self.strengths[1:], np.diff(self.times)
        for lag in range(1, _LONGEST_PATTERN + 1):
            if self.times.size <= 2 * lag + 1:
                return 0
            changes = [float(np.std(one[lag:] - one[:-lag]) / one.mean()) for one in described]
            if max(changes) < _ALIKE:
                return lag
        return 0


def find_slips(
    twist: ArrayLike, shaft_speed: ArrayLike, rate: float, *, own_period: float
) -> Slips:
    """Find the slips in a torque.

    Parameters
    ----------
    twist : array_like, shape (n,)
        Twist of the elastomer [rad]: the torque over its stiffness k_E.
    shaft_speed : array_like, shape (n,) or a number
        [rad/s], signed.
    rate : float
        Sampling rate [Hz].
    own_period : float
        Natural period of the elastomer on the clamp at rest, 2 pi sqrt(J_E / k_E) [s].

    Returns
    -------
    Slips

    Examples
    --------
    >>> time = np.arange(30000) / 30e3
    >>> sawtooth = 5.0 / 150.0 * ((150.0 * time) % 1.0)
    >>> slips = find_slips(sawtooth, 5.0, 30e3, own_period=1e-3)
    >>> round(slips.rate), slips.pattern, slips.sudden_share > 0.9
    (150, 1, True)
    >>> find_slips(4.9 / 943 * np.sin(943 * time), 5.0, 30e3, own_period=1e-3).times.size
    0
    """
    smooth = _smooth(np.asarray(twist, dtype=np.float64), rate)
    speed = np.broadcast_to(np.asarray(shaft_speed, dtype=np.float64), smooth.shape)[:-1]
    falling = -np.sign(speed) * np.diff(smooth) * rate
    total = float(falling[falling > 0.0].sum())
    excess = falling - np.abs(speed)
    share = float(excess[(excess > 0.0) & (speed != 0.0)].sum()) / total if total > 0.0 else 0.0
    if share <= LEAST_SUDDEN:
        return Slips(np.empty(0), np.empty(0), share)
    first, last = np.flatnonzero(np.diff(np.pad(falling > 0.0, 1))).reshape(-1, 2).T
    fastest = np.array(
        [i + int(excess[i:j].argmax()) for i, j in zip(first, last, strict=True)], dtype=np.intp
    )
    strength = excess[fastest]
    positive = np.maximum(strength, 0.0)
    chosen = strength >= _LEAST_STRENGTH * float(positive @ positive) / float(positive.sum())
    first, fastest, strength = first[chosen], fastest[chosen], strength[chosen]
    apart = np.append(True, np.diff(fastest) >= _SWING * own_period * rate)
    if np.count_nonzero(apart) > 1:
        first, strength = first[apart], strength[apart]
    return Slips(first / rate, strength, share)


def motion_slips(motion: Motion) -> Slips:
    """Find the slips of a simulated motion.

    The twist is that of the motion. The natural period follows from J_E theta1'' = T - T_E and from
    T_E over the twist, both by least squares, within 1 % from 30 kHz on.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Slips

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.effects import constant_version
    >>> from sim.run import simulate
    >>> rig = constant_version(load_material_rig("fluorocarbon"))
    >>> slips = motion_slips(simulate(rig, 2.5).motion)
    >>> round(slips.rate), slips.pattern
    (250, 1)
    """
    twist = motion.interface_angle - motion.clamp_angle
    return find_slips(twist, motion.shaft_speed, motion.rate, own_period=_own_period(motion, twist))


def _own_period(motion: Motion, twist: NDArray[np.float64]) -> float:
    acceleration = _smooth(np.gradient(motion.interface_speed) * motion.rate, motion.rate)
    turning = _smooth(motion.friction_torque - motion.torque, motion.rate)
    bent = twist - twist.mean()
    stiffness = float(bent @ motion.torque)
    inertia = float(acceleration @ turning)
    if not (stiffness > 0.0 and inertia > 0.0):
        return 0.0
    stiffness /= float(bent @ bent)
    inertia /= float(acceleration @ acceleration)
    return 2.0 * math.pi * math.sqrt(inertia / stiffness)


def _smooth(values: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    from scipy.ndimage import gaussian_filter1d

    smoothed = gaussian_filter1d(values, _SMOOTHING * rate, mode="nearest", truncate=4.0)
    return np.asarray(smoothed, dtype=np.float64)
