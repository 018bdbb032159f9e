"""Test bench as plain data: beams, baseplate and microphone.

Quantities are in SI units; the keys of rig files, their units and bounds are declared beside the
fields (`models.schema`).
"""

import math
from dataclasses import dataclass
from typing import Annotated

from models.errors import ParameterError
from models.schema import Flag, Quantity, Vector, refuse_impossible

HIGHEST_PLATE_FREQUENCY = 16e3
"""Highest mode of the plate [Hz]: measured creaks fill the band up to 15 kHz."""

LEAST_HEIGHT = 0.01
"""Lowest height of the microphone over the plate: three surface elements [m]."""

FEWEST_MODES, MOST_MODES = 5, 5000
"""Limits of the number of plate modes: fewer radiate no band, more take minutes."""


@dataclass(frozen=True)
class Beams:
    """Two steel beams that carry the clamp; their length follows from the support stiffness.

    Parameters
    ----------
    width, thickness : float
        Cross-section [m].
    lever : float
        Distance R from the shaft's axis to the beams' roots at the clamp [m] (4.12).
    youngs_modulus : float
        [Pa]
    density : float
        [kg/m3]
    damping_ratio : float
        Damping ratio of the bending modes above the first torsional mode [-].
    accelerometer : float
        Place of the accelerometer on the beam, as a fraction of the length from the clamp.
    anchor_rotation : float, optional
        Stiffness of an anchor against the slope of its beam [Nm/rad]; rigid as in 3.1.1.
    anchor_translation : float, optional
        Stiffness of an anchor against the deflection of its beam [N/m]; rigid as in 3.1.1. Neither
        changes the support stiffness, only the modes above the first torsional one.
    strike : float, optional
        Place where the reaction of an impact in the anchor's joint acts on the beam, as a fraction
        of the length from the anchor.
    radiating : bool, optional
        Whether beams and clamp radiate sound, besides the plate.
    height : float, optional
        Height of beams and shaft over the plate [m], for their sound.
    clamp_width : float, optional
        Width of the clamp along the shaft, and its height [m], for its sound.
    """

    width: Annotated[float, Quantity("width_m")]
    thickness: Annotated[float, Quantity("thickness_m")]
    lever: Annotated[float, Quantity("lever_m")]
    youngs_modulus: Annotated[float, Quantity("youngs_modulus_Pa", unit="Pa")]
    density: Annotated[float, Quantity("density_kgm3", unit="kg/m3")]
    damping_ratio: Annotated[float, Quantity("damping_ratio", high=1.0)]
    accelerometer: Annotated[float, Quantity("accelerometer", high=1.0, closed=True)]
    anchor_rotation: Annotated[
        float, Quantity("anchor_rotation_Nm_rad", unit="Nm/rad", infinite="rigid")
    ] = math.inf
    anchor_translation: Annotated[
        float, Quantity("anchor_translation_N_m", unit="N/m", infinite="rigid")
    ] = math.inf
    strike: Annotated[float, Quantity("strike", high=1.0)] = 1 / 24
    radiating: Annotated[bool, Flag("radiate")] = False
    height: Annotated[float, Quantity("height_m", high=1.0)] = 0.06
    clamp_width: Annotated[float, Quantity("clamp_width_m", high=1.0)] = 0.04

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness E I of one beam [N m2] (4.12).

        Examples
        --------
        >>> round(Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3).bending_stiffness, 3)
        13.549
        """
        return self.youngs_modulus * self.width * self.thickness**3 / 12

    @property
    def mass_per_length(self) -> float:
        """Mass of one beam per length [kg/m]."""
        return self.density * self.width * self.thickness


@dataclass(frozen=True)
class Plate:
    """Baseplate that the beams' anchors stand on, with simply supported edges.

    Parameters
    ----------
    length, width, thickness : float
        Dimensions along x, y and z [m]; the origin is the middle of the upper surface.
    youngs_modulus : float
        [Pa]
    density : float
        [kg/m3]
    poisson_ratio : float
        [-]
    loss_factor : float
        Loss factor of all modes [-].
    clamp_position : tuple of 2 floats
        Position x, y of the middle of the clamp over the plate [m]; the beams lie along x.

    Raises
    ------
    ParameterError
        If a quantity is not positive, or a loss factor or Poisson's ratio out of range.
    """

    length: Annotated[float, Quantity("length_m", unit="m")]
    width: Annotated[float, Quantity("width_m", unit="m")]
    thickness: Annotated[float, Quantity("thickness_m", unit="m")]
    youngs_modulus: Annotated[float, Quantity("youngs_modulus_Pa", unit="Pa")]
    density: Annotated[float, Quantity("density_kgm3", unit="kg/m3")]
    poisson_ratio: Annotated[float, Quantity("poisson_ratio", high=0.5)]
    loss_factor: Annotated[float, Quantity("loss_factor", high=1.0)]
    clamp_position: Annotated[tuple[float, float], Vector("clamp_position_m", 2)]

    def __post_init__(self) -> None:
        refuse_impossible(self, "plate")

    @property
    def mass_per_area(self) -> float:
        """Mass per area [kg/m2]."""
        return self.density * self.thickness

    @property
    def stiffness_per_mass(self) -> float:
        """Bending stiffness D = E h^3 / (12 (1 - nu^2)) over mass per area rho h [m4/s2]."""
        return (
            self.youngs_modulus * self.thickness**2 / (12 * (1 - self.poisson_ratio**2))
        ) / self.density


def refuse_plate(plate: Plate, where: str) -> None:
    """Raise if a plate has too few or too many modes, or does not lie below the clamp.

    Raises
    ------
    ParameterError
        The message begins with `where`.
    """
    x, y = plate.clamp_position
    if abs(x) >= 0.5 * plate.length or abs(y) >= 0.5 * plate.width:
        raise ParameterError(f"{where}: clamp_position_m = [{x:g}, {y:g}] lies off the plate")
    # By the mean modal density: L. Cremer, M. Heckl, Structure-Borne Sound, section 4.3.
    area = plate.length * plate.width
    modes = 0.5 * HIGHEST_PLATE_FREQUENCY * area / math.sqrt(plate.stiffness_per_mass)
    if not FEWEST_MODES <= modes <= MOST_MODES:
        raise ParameterError(
            f"{where}: a plate of {plate.length:g} x {plate.width:g} x {plate.thickness:g} m has "
            f"about {modes:.3g} modes up to 16 kHz; it must have {FEWEST_MODES} to {MOST_MODES}"
        )


@dataclass(frozen=True)
class Microphone:
    """Microphone over the plate.

    Parameters
    ----------
    position : tuple of 3 floats
        Position relative to the middle of the plate's upper surface [m].

    Raises
    ------
    ParameterError
        If it is less than 0.01 m over the plate.
    """

    position: Annotated[tuple[float, float, float], Vector("position_m", 3)]

    def __post_init__(self) -> None:
        height = self.position[2]
        if not height >= LEAST_HEIGHT:
            raise ParameterError(
                f"microphone: position has z = {height:g} m, inside or behind the plate, whose "
                f"surface is z = 0; it must be at least {LEAST_HEIGHT:g} m above the plate"
            )
