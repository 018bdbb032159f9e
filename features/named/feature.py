"""A feature as an entry of a table: name, unit, definition, source, and how it is computed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from features.named.prepared import ACOUSTIC_KINDS
from models.show import short_repr

if TYPE_CHECKING:
    from collections.abc import Callable

    from features.named.prepared import Prepared

__all__ = ["Feature"]

THESIS_STICK_SLIP = "thesis, 5.1.1"
THESIS_SPECTRA = "thesis, 5.2.1"
THESIS_NOISES = "thesis, 5.2.3"
PEETERS = "Peeters 2004"
PITCH = "McLeod & Wyvill 2005"
THIS = "bushing-noise"


@short_repr
@dataclass(frozen=True)
class Feature:
    """One number that describes a signal.

    Parameters
    ----------
    name : str
    unit : str
        "1" for pure numbers.
    definition : str
        In one line.
    source : str
        Where the definition comes from.
    compute : callable
        Of a `Prepared` signal.
    silent : float, optional
        Value for a signal without content [unit]; None where `compute` knows itself.
    calibrated : bool
        Whether it needs a calibrated signal; all others do not depend on the gain.
    kinds : tuple of str
        Kinds of channel it applies to.
    tolerance : tuple of 2 floats
        How closely values agree that come from the same sound at different sampling rates, 16 to
        192 kHz: within this share, or within this much [unit], whichever is more. It holds for
        what the rates have in common, so for `level` and `level_a` where nothing lies above 7 kHz.

    Examples
    --------
    >>> from features.named.prepared import prepare
    >>> length = Feature("length", "s", "Duration.", "-", lambda p: p.samples.size / p.rate, None)
    >>> length(prepare([0.0] * 480, 48e3, "pressure"))
    0.01
    """

    name: str
    unit: str
    definition: str
    source: str
    compute: Callable[[Prepared], float]
    silent: float | None = math.nan
    calibrated: bool = False
    kinds: tuple[str, ...] = ACOUSTIC_KINDS
    tolerance: tuple[float, float] = (0.02, 0.01)

    def __call__(self, signal: Prepared) -> float:
        """Value for a signal; NaN where it is undefined."""
        if self.calibrated and not signal.calibrated:
            return math.nan
        if signal.silent and self.silent is not None:
            return self.silent
        return float(self.compute(signal))
