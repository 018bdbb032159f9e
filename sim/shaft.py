"""Motions of the shaft: constant speed, ramp, oscillation, or a logged speed."""

import math
from dataclasses import dataclass
from numbers import Real
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.errors import ParameterError


@runtime_checkable
class ShaftMotion(Protocol):
    """Interface of a motion of the shaft: its angular speed over time, and its largest speed."""

    def speed(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angular speed [rad/s] at `time` [s], in the shape of `time`."""
        ...

    def top_speed(self, seconds: float) -> float:
        """Return the largest magnitude of the speed in the first `seconds` [rad/s]."""
        ...


@dataclass(frozen=True)
class ConstantSpeed:
    """Constant speed, as on the rig.

    Parameters
    ----------
    value : float
        Angular speed [rad/s], signed.

    Examples
    --------
    >>> ConstantSpeed(5.0).speed(np.array([0.0, 1.0]))
    array([5., 5.])
    """

    value: float

    def speed(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angular speed [rad/s] at `time` [s], in the shape of `time`."""
        return np.full(time.shape, float(self.value))

    def top_speed(self, seconds: float = math.inf) -> float:  # noqa: ARG002
        """Return the largest magnitude of the speed in the first `seconds` [rad/s]."""
        return abs(float(self.value))


@dataclass(frozen=True)
class SpeedRamp:
    """Run-up: the speed changes linearly, then stays constant.

    Parameters
    ----------
    start, end : float
        [rad/s]
    duration : float
        [s]

    Examples
    --------
    >>> SpeedRamp(0.0, 10.0, 2.0).speed(np.array([0.0, 1.0, 3.0]))
    array([ 0.,  5., 10.])
    """

    start: float
    end: float
    duration: float

    def speed(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angular speed [rad/s] at `time` [s], in the shape of `time`."""
        return self.start + (self.end - self.start) * np.clip(time / self.duration, 0.0, 1.0)

    def top_speed(self, seconds: float = math.inf) -> float:
        """Return the largest magnitude of the speed in the first `seconds` [rad/s]."""
        return float(np.abs(self.speed(np.array([0.0, seconds]))).max())


@dataclass(frozen=True)
class Oscillation:
    """Oscillation of the angle as ``amplitude * sin(2 pi frequency t)``, like a stabilizer bar's.

    Parameters
    ----------
    amplitude : float
        [rad]
    frequency : float
        [Hz]

    Raises
    ------
    ParameterError
        If an amplitude or a frequency is not finite, or the frequency not above 0.

    Examples
    --------
    >>> float(Oscillation(0.25, 2.0).speed(np.array([0.25]))[0].round(6))
    -3.141593
    """

    amplitude: float
    frequency: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.amplitude) and 0.0 < self.frequency < math.inf):
            raise ParameterError(
                f"an oscillation of {self.amplitude:g} rad at {self.frequency:g} Hz: the frequency "
                "must be above 0, both finite"
            )

    def speed(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angular speed [rad/s] at `time` [s], in the shape of `time`."""
        omega = 2.0 * math.pi * self.frequency
        return np.asarray(self.amplitude * omega * np.cos(omega * time))

    def top_speed(self, seconds: float = math.inf) -> float:  # noqa: ARG002
        """Return the largest magnitude of the speed in the first `seconds` [rad/s]."""
        return abs(self.amplitude) * 2.0 * math.pi * self.frequency


class LoggedSpeed:
    """Logged speed, linear between the samples and constant beyond them.

    Parameters
    ----------
    time : array_like, shape (n,)
        [s], rising.
    speed : array_like, shape (n,)
        [rad/s]

    Raises
    ------
    ParameterError
        If a value is not finite, the times do not rise, or there are fewer than two samples.

    Examples
    --------
    >>> LoggedSpeed([0.0, 1.0], [0.0, 4.0]).speed(np.array([0.25, 9.0]))
    array([1., 4.])
    """

    def __init__(self, time: ArrayLike, speed: ArrayLike) -> None:
        self._time = np.asarray(time, dtype=float)
        self._speed = np.asarray(speed, dtype=float)
        if self._time.ndim != 1 or self._time.shape != self._speed.shape or self._time.size < 2:
            raise ParameterError(
                "logged speed: needs two or more samples, one speed [rad/s] for each time [s]"
            )
        for name, values in (("time", self._time), ("speed", self._speed)):
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise ParameterError(
                    f"logged speed: {name} in row {bad[0] + 1} is no finite number"
                )
        falls = np.flatnonzero(np.diff(self._time) <= 0.0)
        if falls.size:
            raise ParameterError(f"logged speed: time does not rise at row {falls[0] + 2}")

    def __repr__(self) -> str:
        speed, time = self._speed, self._time
        return (
            f"LoggedSpeed({time.size} samples, {time[0]:g} to {time[-1]:g} s, "
            f"{speed.min():g} to {speed.max():g} rad/s)"
        )

    def speed(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the angular speed [rad/s] at `time` [s], in the shape of `time`."""
        return np.asarray(np.interp(time, self._time, self._speed))

    def top_speed(self, seconds: float = math.inf) -> float:
        """Return the largest magnitude of the speed in the first `seconds` [rad/s]."""
        inside = self._speed[(self._time >= 0.0) & (self._time <= seconds)]
        ends = self.speed(np.array([0.0, seconds]))
        return float(np.abs(np.concatenate([inside, ends])).max())


def shaft_motion(shaft: ShaftMotion | float) -> ShaftMotion:
    """Return a motion of the shaft; a number is a constant speed [rad/s].

    Raises
    ------
    ParameterError
        It is neither a number nor a motion.

    Examples
    --------
    >>> shaft_motion(5)
    ConstantSpeed(value=5.0)
    """
    if isinstance(shaft, Real):
        return ConstantSpeed(float(shaft))
    if not isinstance(shaft, ShaftMotion):
        raise ParameterError(f"shaft = {shaft!r}: give a speed in rad/s, or a motion of sim.shaft")
    return shaft
