"""Frictional heat (6.1, Appendix G): temperature of the contact between two half-spaces.

Runs of a quarter of a second heat a layer thinner than a millimetre, so shaft and bushing are
half-spaces, and the friction's power divides such that both surfaces are equally warm. The thesis
leaves out the paint between them; `interface_rise` takes a layer, which after the few hundredths of
a second that heat takes through paint is a mere resistance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from noise.thesis.row import Values


@dataclass(frozen=True)
class HalfSpace:
    """Thermal properties.

    Parameters
    ----------
    diffusivity : float
        [m2/s]
    conductivity : float
        [W/m/K]
    """

    diffusivity: float
    conductivity: float

    def resistance(self, seconds: float) -> float:
        """Return the rise of the surface per flux applied for `seconds` [K m2/W], (G3) at x = 0."""
        return 2.0 / self.conductivity * math.sqrt(self.diffusivity * seconds / math.pi)


STEEL = HalfSpace(3.95e-6, 14.9)
"""304 stainless (Table G1)."""

RUBBER = HalfSpace(6.69e-8, 0.16)
"""(Table G1)"""


def temperature_rise(body: HalfSpace, flux: float, seconds: float, depth: float = 0.0) -> float:
    """Return the temperature rise in a half-space under a constant flux, equation (G3).

    Parameters
    ----------
    body : HalfSpace
    flux : float
        Into its surface [W/m2].
    seconds : float
        Since the flux began [s].
    depth : float
        Below the surface [m].

    Returns
    -------
    float
        [K]

    Notes
    -----
    The print of (G3) has alpha t / pi without its power 1/2.

    Examples
    --------
    >>> rubber_flux = 0.0759 * 300.0 / 7.69e-4
    >>> round(temperature_rise(RUBBER, rubber_flux, 0.23), 1)
    25.9
    """
    reach = 2.0 * math.sqrt(body.diffusivity * seconds)
    surface = body.resistance(seconds) * math.exp(-((depth / reach) ** 2))
    return flux * (surface - depth / body.conductivity * math.erfc(depth / reach))


def interface_rise(power: float, area: float, seconds: float, layer: float = 0.0) -> float:
    """Return the temperature rise in the contact of bushing and shaft.

    Parameters
    ----------
    power : float
        Torque times sliding speed [W].
    area : float
        Of contact [m2].
    seconds : float
        Since sliding began [s].
    layer : float, optional
        Resistance of a thin layer on the shaft, such as paint [K m2/W].

    Returns
    -------
    float
        [K]

    Examples
    --------
    >>> round(interface_rise(300.0, 7.69e-4, 0.23))
    26
    >>> round(interface_rise(300.0, 7.69e-4, 0.23, layer=50e-6 / 0.2))
    92
    """
    a, b = STEEL.resistance(seconds) + layer, RUBBER.resistance(seconds)
    return power / area * a * b / (a + b)


_POWER = 30.0 * 10.0
"""30 Nm at 10 rad/s [W]."""

_SECONDS = 0.23
_RISE = 26.0
"""Published [K]."""

_PAINT = 50e-6 / 0.2
"""Resistance of the shaft's, assumed [K m2/W]."""


def heating() -> Iterator[Values]:
    """Yield shares of the heat, and temperatures at the surface, below it and under paint."""
    a, b = STEEL.resistance(1.0), RUBBER.resistance(1.0)
    into_steel, into_rubber = b / (a + b), a / (a + b)  # (G5)
    area = interface_rise(_POWER, 1.0, _SECONDS) / _RISE
    reach = STEEL.diffusivity * _SECONDS
    flux, steel_flux = into_rubber * _POWER / area, into_steel * _POWER / area
    yield {"exact": 100.0 * into_steel}
    yield {"exact": 100.0 * into_rubber}
    yield {}  # the thesis states a share of an area that it does not give
    yield {
        "exact": interface_rise(_POWER, 7.69e-4, _SECONDS),
        # (G3) as it is printed, without the power of 1/2.
        "as_printed": 2.0 * steel_flux / STEEL.conductivity * reach / math.pi,
    }
    yield {
        "exact": temperature_rise(RUBBER, flux, _SECONDS, 0.4e-3),
        "as_printed": temperature_rise(RUBBER, flux, _SECONDS, 0.4e-6),
    }
    yield {"exact": interface_rise(_POWER, area, _SECONDS, layer=_PAINT)}
