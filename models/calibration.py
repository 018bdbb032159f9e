"""Calibration of a sensor: from what a measurement chain reads to the quantity itself.

A table of readings is a curve, straight from row to row. Beyond its ends nothing was calibrated:
readings that lie out by up to a twentieth of its span are carried on straight, which is for noise
and for a last step of the load, and any further are refused. A line, of a sensitivity and an
offset, has no ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.show import short_repr

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["READING_UNITS", "Calibration"]

READING_UNITS = {"V": ("voltage", 1.0), "mV": ("voltage", 1e-3), "counts": ("counts", 1.0)}
"""What a chain reads in, before it is calibrated: dimension, and size of the unit in it."""

_MARGIN = 0.05
"""Of a table's span, by which readings may lie outside of it."""


@short_repr
@dataclass(frozen=True)
class Calibration:
    """A curve from readings to values.

    Parameters
    ----------
    readings : tuple of float
        Rising [`unit`].
    values : tuple of float
        One a reading [unit of the channel].
    unit : str
        Of the readings, one of `READING_UNITS`; empty where they are what a file holds.
    bounded : bool
        Whether it ends with its readings: a table does, a line does not.
    source : str
        What messages call it.

    Examples
    --------
    >>> import numpy as np
    >>> cell = Calibration.line(12.19, 0.4222, "mV")
    >>> cell.of(np.array([0.4222, 122.3222])).round(9)
    array([ 0., 10.])
    """

    readings: tuple[float, ...]
    values: tuple[float, ...]
    unit: str = ""
    bounded: bool = True
    source: str = "its calibration"

    @classmethod
    def line(cls, sensitivity: float, offset: float = 0.0, unit: str = "") -> Calibration:
        """Return the line ``reading = offset + sensitivity * value``.

        Parameters
        ----------
        sensitivity : float
            Not 0 [`unit` per unit of the channel].
        offset : float
            Reading at a value of 0 [`unit`].
        unit : str
            Of the readings.
        """
        ends = sorted([(offset, 0.0), (offset + sensitivity, 1.0)])
        readings, values = zip(*ends, strict=True)
        return cls(readings, values, unit, bounded=False)

    @property
    def gain(self) -> float:
        """Mean slope [unit of the channel per `unit`]."""
        return (self.values[-1] - self.values[0]) / (self.readings[-1] - self.readings[0])

    def in_units_of(self, size: float) -> Calibration:
        """Return it for readings that are told in units of another size [`unit`]."""
        ends = sorted(zip((x / size for x in self.readings), self.values, strict=True))
        readings, values = zip(*ends, strict=True)
        return replace(self, readings=readings, values=values, unit="")

    def beyond(self, readings: NDArray[np.float64]) -> float:
        """How far readings lie outside of the curve, as a share of its span [-].

        Parameters
        ----------
        readings : ndarray, shape (n,)
            [`unit`]
        """
        if not self.bounded or not readings.size:
            return 0.0
        low, high = self.readings[0], self.readings[-1]
        out = max(low - float(readings.min()), float(readings.max()) - high)
        return max(0.0, out / (high - low))

    def of(self, readings: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values of readings.

        Parameters
        ----------
        readings : ndarray, shape (n,)
            [`unit`]

        Returns
        -------
        ndarray, shape (n,)
            [unit of the channel]

        Raises
        ------
        ParameterError
            Readings lie further outside than a twentieth of a table's span.
        """
        import numpy as np  # rig files are read for help as well, which does without

        if self.beyond(readings) > _MARGIN:
            low, high = self.readings[0], self.readings[-1]
            worst = readings[np.argmax(np.maximum(low - readings, readings - high))]
            raise ParameterError(
                f"reads {worst:g}, outside of {self.source} ({low:g} to {high:g}) by "
                f"more than {_MARGIN:.0%} of its span; calibrate over the range that is recorded"
            )
        x, y = np.array(self.readings), np.array(self.values)
        slope = np.diff(y) / np.diff(x)
        piece = np.clip(np.searchsorted(x, readings) - 1, 0, slope.size - 1)
        return np.asarray(y[piece] + slope[piece] * (readings - x[piece]))
