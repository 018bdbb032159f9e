"""Sensors of a rig: what stands between a quantity and the number that a recording holds.

A signal passes the anti-alias filter, gets the noise of sensor and amplifier, and is rounded to the
steps of a converter that clips at its range. What a file leaves out is ideal, but for the noise,
which is then that of `sim.acquisition`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING

from models.show import short_repr

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.calibration import Calibration

__all__ = ["Sensor", "Sensors"]


@short_repr
@dataclass(frozen=True)
class Sensor:
    """The sensor of one kind of channel, with its amplifier, filter and converter.

    Parameters
    ----------
    noise : float, optional
        Standard deviation of its white noise [unit of the channel].
    full_scale : float, optional
        Largest value of either sign, beyond which it clips [unit of the channel].
    bits : int, optional
        Of the converter: `full_scale` in both signs are ``2**bits`` steps.
    antialias : float, optional
        Corner of the anti-alias filter, at which it takes 3 dB [Hz].
    calibration : Calibration, optional
        From what is recorded to the quantity, where a recording is not calibrated otherwise.

    Examples
    --------
    >>> Sensor(full_scale=102.5, bits=12).step
    0.050048828125
    """

    noise: float | None = None
    full_scale: float | None = None
    bits: int | None = None
    antialias: float | None = None
    calibration: Calibration | None = None

    @property
    def step(self) -> float:
        """Quantisation step [unit of the channel]; 0 without a converter."""
        if self.full_scale is None or self.bits is None:
            return 0.0
        return math.ldexp(self.full_scale, 1 - self.bits)

    def over(self, other: Sensor) -> Sensor:
        """Return this sensor, with what it does not say taken from another."""
        said = {each.name: getattr(self, each.name) for each in fields(self)}
        return replace(other, **{name: x for name, x in said.items() if x is not None})


@short_repr
@dataclass(frozen=True)
class Sensors:
    """The sensors of a rig.

    Parameters
    ----------
    by_kind : mapping of str to Sensor
        By kind of channel; a kind that is missing has an ideal one.
    noise_from_recordings : bool
        Whether the noise is to be estimated where there are recordings.

    Examples
    --------
    >>> fine, coarse = Sensors({"torque": Sensor(1e-3)}), Sensors({"torque": Sensor(bits=8)})
    >>> coarse.over(fine).of("torque")
    Sensor(noise=0.001, full_scale=None, bits=8, antialias=None, calibration=None)
    """

    by_kind: Mapping[str, Sensor] = field(default_factory=dict)
    noise_from_recordings: bool = False

    def of(self, kind: str) -> Sensor:
        """Return the sensor of a kind of channel."""
        return self.by_kind.get(kind, _IDEAL)

    def unfiltered(self) -> Sensors:
        """Return these sensors for signals that have passed their filters."""
        kept = {kind: replace(sensor, antialias=None) for kind, sensor in self.by_kind.items()}
        return replace(self, by_kind=kept)

    @property
    def calibrations(self) -> dict[str, Calibration]:
        """Calibrations by kind of channel."""
        found = ((kind, sensor.calibration) for kind, sensor in self.by_kind.items())
        return {kind: calibration for kind, calibration in found if calibration is not None}

    def over(self, other: Sensors) -> Sensors:
        """Return these sensors, with what they do not say taken from others."""
        kinds = dict.fromkeys((*other.by_kind, *self.by_kind))
        return Sensors(
            {kind: self.of(kind).over(other.of(kind)) for kind in kinds},
            self.noise_from_recordings or other.noise_from_recordings,
        )


_IDEAL = Sensor()
