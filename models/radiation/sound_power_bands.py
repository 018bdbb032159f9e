"""Sound power in one-third octaves, as a sound power measurement states it.

Bands are those of base ten (IEC 61260-1). In each one the frequencies computed lie close enough for
the narrowest resonance: half its width apart, which sums a resonance to half a percent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.radiation.sound_power import power_flow
from models.short_repr import short_repr

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from models.structure.plate import PlateModes

__all__ = ["BandPower", "third_octave_power"]

REFERENCE = 1e-12
"""Of sound power levels [W]."""

FEWEST = 8
"""Frequencies in a band."""

BAND = 10**0.1
"""Upper over lower edge of a band."""


@short_repr
@dataclass(frozen=True, eq=False)
class BandPower:
    """Power per one-third octave.

    Parameters
    ----------
    centre : ndarray, shape (n_bands,)
        Exact middle of each band [Hz].
    supplied, dissipated, radiated : ndarray, shape (n_bands,)
        By the drives, in the plate, as sound of its upper side [W].
    radiation_efficiency : ndarray, shape (n_bands,)
        Radiated power over that of plane waves of the same mean square velocity [-]; NaN where
        nothing moves.
    """

    centre: NDArray[np.float64]
    supplied: NDArray[np.float64]
    dissipated: NDArray[np.float64]
    radiated: NDArray[np.float64]
    radiation_efficiency: NDArray[np.float64]

    @property
    def level(self) -> NDArray[np.float64]:
        """Sound power level [dB re 1 pW], shape (n_bands,); minus infinity for no power."""
        with np.errstate(divide="ignore"):  # a band of no power
            return np.asarray(10 * np.log10(self.radiated / REFERENCE))


def third_octave_power(
    modes: PlateModes,
    drives: NDArray[np.float64],
    density: Callable[[NDArray[np.float64]], NDArray[np.complex128]] | None = None,
    *,
    low: float = 50.0,
    high: float = 10e3,
    baffled: bool = True,
    radiation_damping: bool = False,
) -> BandPower:
    """Powers of the plate under steady drives, band by band.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        As for `models.structure.plate.acceleration_model`.
    density : callable, optional
        Takes frequencies, shape (n,), each a fixed ratio above the last, to the complex spectra of
        all drives, shape (n_drives, n), whose squared magnitude is a power spectral density
        [N2/Hz or (Nm)2/Hz]; phases between drives count. Or to several such sets that know nothing
        of each other's phase, shape (n_sets, n_drives, n). Default: all drives in phase at 1 N2/Hz.
    low, high : float, optional
        Middles of the lowest and the highest band [Hz].
    baffled, radiation_damping : bool, optional
        As for `models.radiation.sound_power.power_flow`.

    Returns
    -------
    BandPower

    Raises
    ------
    ParameterError
        If the bands reach beyond the modes, or are none.

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 4e3)
    >>> bands = third_octave_power(modes, modes.shape([0.1], [0.05]).T, low=500.0, high=2e3)
    >>> bands.centre.round(), bands.level.round(1)
    (array([ 501.,  631.,  794., 1000., 1259., 1585., 1995.]), array([...]))
    """
    first, last = (round(10 * np.log10(middle / 1e3)) for middle in (low, high))
    centre = 1e3 * 10 ** (np.arange(first, last + 1) / 10)
    if not centre.size:
        raise ParameterError(f"bands from {low:g} to {high:g} Hz: low must not be above high")
    if centre[-1] * np.sqrt(BAND) > modes.frequencies[-1] * BAND:
        raise ParameterError(
            f"bands to {high:g} Hz reach beyond the plate's modes, which end at "
            f"{modes.frequencies[-1]:g} Hz; compute more modes or choose a lower high"
        )
    count = max(FEWEST, int(np.ceil(np.log(BAND) / modes.damping_ratios.min())))
    edges = centre[:, None] * BAND ** (np.linspace(-0.5, 0.5, count + 1))
    frequency = np.sqrt(edges[:, 1:] * edges[:, :-1]).ravel()
    spectra = np.ones((drives.shape[1], frequency.size)) if density is None else density(frequency)
    flow = power_flow(
        modes, drives, spectra, frequency, baffled=baffled, radiation_damping=radiation_damping
    )
    width = np.diff(edges, axis=1)

    def in_bands(spectrum: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.sum(spectrum.reshape(width.shape) * width, axis=1))

    radiated = in_bands(flow.radiated)
    plane = AIR_DENSITY * SOUND_SPEED * flow.area * in_bands(flow.mean_square_velocity)
    efficiency = np.divide(radiated, plane, out=np.full(centre.size, np.nan), where=plane > 0.0)
    return BandPower(
        centre, in_bands(flow.supplied), in_bands(flow.dissipated), radiated, efficiency
    )
