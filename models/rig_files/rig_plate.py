"""The baseplate and the microphone over it, as plain data.

Both are built by hand as often as read from a file, so they check themselves.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from models.errors import ParameterError
from models.show import short_repr

__all__ = ["EDGES", "HIGHEST_PLATE_FREQUENCY", "Floor", "Microphone", "Plate"]

EDGES = ("free", "simply_supported", "clamped")
"""How an edge of the plate may be held."""

HIGHEST_PLATE_FREQUENCY = 16e3
"""Plate modes are kept up to it [Hz]: measured creaks fill the band to 15 kHz."""

LEAST_HEIGHT = 0.01
"""Of the microphone over the plate: three surface elements [m]."""


@short_repr
@dataclass(frozen=True)
class Plate:
    """The baseplate that the beams' anchors stand on.

    Parameters
    ----------
    length, width, thickness : float
        Along x, y and z [m]; the origin of all positions is the middle of its upper surface.
    youngs_modulus : float
        [Pa]
    density : float
        [kg/m3]
    poisson_ratio : float
        [-]
    loss_factor : float, or tuple of (float, float)
        Of all modes; or by frequency [Hz], in rising order: a power law between the entries, held
        outside them.
    clamp_position : tuple of 2 floats
        Where the middle of the clamp stands over the plate, x and y [m]; the beams lie along x.
    edges : one of `EDGES`, or tuple of 4 of them
        All edges alike, or those at the smallest x, largest x, smallest y, largest y.

    Raises
    ------
    ParameterError
        If a quantity is not positive, a loss factor or Poisson's ratio out of range, or an edge
        unknown.

    Examples
    --------
    >>> Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.0), edges="free").sides
    ('free', 'free', 'free', 'free')
    """

    length: float
    width: float
    thickness: float
    youngs_modulus: float
    density: float
    poisson_ratio: float
    loss_factor: float | tuple[tuple[float, float], ...]
    clamp_position: tuple[float, float]
    edges: str | tuple[str, str, str, str] = "simply_supported"

    def __post_init__(self) -> None:
        for name in ("length", "width", "thickness", "youngs_modulus", "density"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ParameterError(f"plate: {name} = {getattr(self, name):g} must be above 0")
        if not 0.0 < self.poisson_ratio <= 0.5:
            raise ParameterError(
                f"plate: poisson_ratio = {self.poisson_ratio:g} must be above 0 and at most 0.5"
            )
        table = self.loss_table
        if not table or not all(0.0 < loss <= 1.0 for _, loss in table):
            raise ParameterError(
                f"plate: loss_factor = {self.loss_factor} must be above 0 and at most 1"
            )
        rising = [0.0, *(frequency for frequency, _ in table)]
        if len(table) > 1 and any(b <= a for a, b in itertools.pairwise(rising)):
            raise ParameterError("plate: loss_factor must be given for rising frequencies above 0")
        if len(self.sides) != 4 or not set(self.sides) <= set(EDGES):
            raise ParameterError(
                f"plate: edges = {self.edges!r} must be one of {', '.join(EDGES)}, "
                "or a list of four of them"
            )

    @property
    def sides(self) -> tuple[str, str, str, str]:
        """Edges at the smallest x, largest x, smallest y, largest y."""
        if isinstance(self.edges, str):
            return (self.edges, self.edges, self.edges, self.edges)
        return self.edges

    @property
    def loss_table(self) -> tuple[tuple[float, float], ...]:
        """Loss factor by frequency [Hz]; a single entry holds for all."""
        if isinstance(self.loss_factor, tuple):
            return self.loss_factor
        return ((1.0, self.loss_factor),)

    @property
    def mass_per_area(self) -> float:
        """[kg/m2]."""
        return self.density * self.thickness

    @property
    def stiffness_per_mass(self) -> float:
        """D / (rho h), D = E h^3 / (12 (1 - nu^2)) being the bending stiffness [m4/s2]."""
        return (
            self.youngs_modulus * self.thickness**2 / (12 * (1 - self.poisson_ratio**2))
        ) / self.density

    def expected_modes(self, highest_frequency: float) -> float:
        """How many modes it has up to a frequency [Hz], by its mean modal density.

        Notes
        -----
        N = f S / 2 sqrt(rho h / D); L. Cremer, M. Heckl, *Structure-Borne Sound*, section 4.3.

        Examples
        --------
        >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
        >>> round(steel.expected_modes(16e3))
        345
        """
        area = self.length * self.width
        return 0.5 * highest_frequency * area / math.sqrt(self.stiffness_per_mass)


@dataclass(frozen=True)
class Floor:
    """A plane that reflects the plate's sound, parallel to two of the axes.

    Sensible are a plane at right angles to the plate, such as the floor beneath a plate that
    stands upright in a wall: its one image is exact; and a plane over the plate and the microphone,
    such as a ceiling: its first reflection is kept, straight and by way of the baffle. A floor
    under a plate that lies flat is behind the baffle, where its sound does not go.

    Parameters
    ----------
    normal : "x", "y" or "z"
    position : float
        Where it cuts that axis [m].
    reflection : float
        Pressure reflected over pressure arriving, -1 to 1 [-].

    Raises
    ------
    ParameterError
        If normal or reflection are none.
    """

    normal: str
    position: float
    reflection: float = 1.0

    def __post_init__(self) -> None:
        if self.normal not in ("x", "y", "z"):
            raise ParameterError(f"floor: normal = {self.normal!r} must be x, y or z")
        if not -1.0 <= self.reflection <= 1.0:
            raise ParameterError(f"floor: reflection = {self.reflection:g} must be from -1 to 1")
        if not math.isfinite(self.position):
            raise ParameterError(f"floor: position = {self.position:g} must be a finite number")


@short_repr
@dataclass(frozen=True)
class Microphone:
    """Where the sound is heard.

    Parameters
    ----------
    position : tuple of 3 floats
        Relative to the middle of the plate's upper surface [m].
    floor : Floor, optional

    Raises
    ------
    ParameterError
        If it is not at least 0.01 m over the plate.
    """

    position: tuple[float, float, float]
    floor: Floor | None = None

    def __post_init__(self) -> None:
        height = self.position[2]
        if not height >= LEAST_HEIGHT:
            raise ParameterError(
                f"microphone: position has z = {height:g} m, inside or behind the plate, whose "
                f"surface is z = 0; it must be at least {LEAST_HEIGHT:g} m above the plate"
            )

    def images(self, plate: Plate) -> tuple[tuple[tuple[float, float, float], float], ...]:
        """Give the positions at which the plate in its baffle is heard, each with its weight.

        Raises
        ------
        ParameterError
            If the floor cuts the plate, or stands between plate and microphone.

        Examples
        --------
        >>> upright = Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
        >>> Microphone((0.1, 0.2, 1.0), Floor("y", -0.5, 0.9)).images(upright)
        (((0.1, 0.2, 1.0), 1.0), ((0.1, -1.2, 1.0), 0.9))
        """
        heard = ((self.position, 1.0),)
        if self.floor is None:
            return heard
        x, y, z = self.position
        plane, weight = self.floor.position, self.floor.reflection
        if self.floor.normal == "z":
            if plane <= z:
                raise ParameterError(
                    f"floor: position = {plane:g} m along z must be above the microphone at "
                    f"{z:g} m; what is behind the plate's baffle reflects nothing"
                )
            return (*heard, ((x, y, 2 * plane - z), weight), ((x, y, 2 * plane + z), weight))
        half, mine = (plate.length / 2, x) if self.floor.normal == "x" else (plate.width / 2, y)
        if abs(plane) < half or (plane - mine) * plane <= 0.0:
            raise ParameterError(
                f"floor: position = {plane:g} m along {self.floor.normal} must have the plate, to "
                f"+-{half:g} m, and the microphone, at {mine:g} m, on the same side of it"
            )
        mirrored = (2 * plane - x, y, z) if self.floor.normal == "x" else (x, 2 * plane - y, z)
        return (*heard, (mirrored, weight))
