r"""Stabilizer bar in two bushings, with its links: the car's model of Recommendation 7.

The bar turns in two bushings on the body; an arm at each end is linked to a wheel. In torsion it is
a chain of inertias and springs,

.. math::
    k = G J / l, \qquad J_i = \rho J l, \qquad J = \pi (d^4 - d_i^4) / 32

for each piece of length l, with an arm's inertia at either end, where the link exerts the force k_L
(s - r theta) on the arm r; s is the travel of the wheel, expressed as the angle s / r of the arm.

Links also load the bar in bending. By the statics of a beam of length B on two supports of spacing
w, with forces F_l and F_r at its ends, the left bushing carries F_l (1/2 + B / 2w) +
F_r (1/2 - B / 2w), so wheels in opposite directions load a bushing with B / w times the force of a
link.

Limits: wheels that move together do not twist the bar, which is then the rig twice.
"""

import math
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Rig
from models.rig_file import read_toml, rig_from
from models.schema import Quantity, Text, as_table, declared, read_table, refuse_unknown

WHEELS = {"together": (1.0, 1.0), "opposite": (1.0, -1.0), "left": (1.0, 0.0)}
"""Travel of the left and the right wheel, relative to the drive."""

_PIECES = 12
"""Approximate number of pieces of the bar; its first mode between fixed arms is then 0.3 % low."""


@dataclass(frozen=True)
class Bar:
    """Stabilizer bar.

    Parameters
    ----------
    diameter, wall : float
        Dimensions of the tube [m]; a wall of half the diameter is a solid bar.
    length : float
        Length between the arms [m].
    arm_length : float
        Distance from the axis to a link [m].
    arm_inertia : float
        Inertia of one arm about that axis [kg m2].
    shear_modulus : float
        [Pa]
    density : float
        [kg/m3]
    damping_ratio : float
        Damping ratio of the bar's first torsional mode [-], proportional to frequency.
    """

    diameter: Annotated[float, Quantity("bar_diameter_mm", 1e-3, "mm")]
    wall: Annotated[float, Quantity("bar_wall_mm", 1e-3, "mm")]
    length: Annotated[float, Quantity("bar_length_mm", 1e-3, "mm")]
    arm_length: Annotated[float, Quantity("arm_length_mm", 1e-3, "mm")]
    arm_inertia: Annotated[float, Quantity("arm_inertia_kgm2")]
    shear_modulus: Annotated[float, Quantity("shear_modulus_Pa", unit="Pa")] = 7.9e10
    density: Annotated[float, Quantity("density_kgm3")] = 7850.0
    damping_ratio: Annotated[float, Quantity("bar_damping_ratio", closed=True)] = 0.005

    @property
    def polar_moment(self) -> float:
        """Polar moment of the section [m4]."""
        inner = self.diameter - 2.0 * self.wall
        return math.pi / 32.0 * (self.diameter**4 - inner**4)


@dataclass(frozen=True)
class Suspension:
    """Suspension of bar, links and two bushings, whose brackets are those of the rig.

    Parameters
    ----------
    rig : Rig
        Bushing, clamp, structure and plate; the bar lies along the plate's y.
    bar : Bar
    spacing : float
        Distance between the bushings, which lie symmetrically [m].
    link_stiffness : float
        Stiffness of a link with its joints [N/m].
    link_damping : float
        [N s/m]
    wheels : str
        Travel of the wheels, a key of `WHEELS`.
    friction_coefficient : float, optional
        Friction coefficient that gives the contact pressure from the kinetic torque [-]; by default
        the pressure is Lame's for the rig's sleeve.

    Raises
    ------
    ParameterError
        The bushings do not lie between the arms, or on the plate.
    """

    rig: Rig
    bar: Bar
    spacing: Annotated[float, Quantity("bushing_spacing_mm", 1e-3, "mm")]
    link_stiffness: Annotated[float, Quantity("link_stiffness_N_m", unit="N/m")]
    link_damping: Annotated[float, Quantity("link_damping_Ns_m", closed=True)]
    wheels: Annotated[str, Text("wheels")]
    friction_coefficient: Annotated[float | None, Quantity("friction_coefficient", high=10.0)] = (
        None
    )

    def __post_init__(self) -> None:
        if not 0.0 < self.spacing < self.bar.length:
            raise ParameterError(
                f"suspension: spacing = {self.spacing:g} m must be above 0 and below the bar's "
                f"length = {self.bar.length:g} m"
            )
        if not 0.0 < 2.0 * self.bar.wall <= self.bar.diameter:
            raise ParameterError(
                f"suspension: the bar's wall = {self.bar.wall:g} m must be above 0 and at most "
                f"half of its diameter = {self.bar.diameter:g} m"
            )
        if self.wheels not in WHEELS:
            raise ParameterError(
                f"suspension: wheels = {self.wheels!r}; there are {', '.join(WHEELS)}"
            )
        if self.spacing >= self.rig.plate.width:
            raise ParameterError(
                f"suspension: spacing = {self.spacing:g} m does not lie on the plate, whose "
                f"width is {self.rig.plate.width:g} m"
            )
        if self.rig.sleeve is None:
            raise ParameterError(
                "suspension: the normal load needs the contact pressure, hence a [sleeve] table in "
                "the rig file: inner_radius_mm, wall_mm, length_mm, and hardness_shore_A or "
                "youngs_modulus_MPa"
            )

    @property
    def positions(self) -> tuple[float, float]:
        """Positions of left and right bushing along the plate's y [m]."""
        return -0.5 * self.spacing, 0.5 * self.spacing

    def contact_pressure(self, interference: float) -> float:
        """Return the mean pressure in an unloaded bushing [Pa], by its interference [m].

        Examples
        --------
        >>> from models.rig_file import load_material_rig
        >>> rig, bar = load_material_rig("fluorocarbon-thesis"), Bar(0.03, 0.004, 0.9, 0.2, 0.02)
        >>> dry = Suspension(rig, bar, 0.4, 2e6, 100.0, "opposite", friction_coefficient=0.5)
        >>> round(dry.contact_pressure(0.279e-3) / 1e6, 3)
        0.277
        """
        sleeve = self.rig.sleeve
        assert sleeve is not None  # checked in __post_init__
        if self.friction_coefficient is None:
            return sleeve.pressure(interference)
        of_unit = 2.0 * math.pi * sleeve.inner_radius**2 * sleeve.length
        return self.rig.fit(interference).kinetic_torque / (self.friction_coefficient * of_unit)

    def preload(self, interference: float) -> float:
        """Return contact pressure times radius and length of a bushing [N], by interference [m]."""
        sleeve = self.rig.sleeve
        assert sleeve is not None
        return self.contact_pressure(interference) * sleeve.inner_radius * sleeve.length


class TorsionChain(NamedTuple):
    """Bar in torsion as a chain of inertias with springs between them and links to the travel.

    Parameters
    ----------
    inertia : ndarray, shape (n,)
        [kg m2]; an infinite inertia keeps its speed.
    stiffness, damping : ndarray, shape (n - 1,)
        Between neighbours [Nm/rad], [Nm s/rad].
    link_stiffness, link_damping : ndarray, shape (n,)
        Between the travel and each inertia [Nm/rad], [Nm s/rad].
    travel : ndarray, shape (n,)
        Travel at each inertia over that of the drive [-].
    start : ndarray, shape (n,)
        Initial speed over that of the drive [-].
    bushings : ndarray of int, shape (n_bushings,)
        Inertias at the bushings.
    load : ndarray, shape (n_bushings, n)
        Normal force on each bushing per torque of each link [N/Nm].

    Examples
    --------
    >>> bar = Bar(0.03, 0.004, 0.9, 0.2, 0.02)
    >>> chain = torsion_chain(bar, 0.4, 2e6, 100.0, "opposite")
    >>> chain.bushings, chain.load[:, [0, -1]].round(3)
    (array([3, 8]), array([[ 8.125, -3.125],
           [-3.125,  8.125]]))
    """

    inertia: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    link_stiffness: NDArray[np.float64]
    link_damping: NDArray[np.float64]
    travel: NDArray[np.float64]
    start: NDArray[np.float64]
    bushings: NDArray[np.int64]
    load: NDArray[np.float64]


def torsion_chain(
    bar: Bar, spacing: float, link_stiffness: float, link_damping: float, wheels: str
) -> TorsionChain:
    """Return the torsion chain of a bar with two bushings.

    Parameters
    ----------
    bar, spacing, link_stiffness, link_damping, wheels
        As for `Suspension`.

    Returns
    -------
    TorsionChain
        Chain from the left arm to the right one.
    """
    overhang = 0.5 * (bar.length - spacing)
    spans = (overhang, spacing, overhang)
    counts = [max(1, round(_PIECES * span / bar.length)) for span in spans]
    lengths = np.repeat([s / n for s, n in zip(spans, counts, strict=True)], counts)
    stiffness = bar.shear_modulus * bar.polar_moment / lengths
    inertia = np.zeros(lengths.size + 1)
    inertia[:-1] += 0.5 * bar.density * bar.polar_moment * lengths
    inertia[1:] += 0.5 * bar.density * bar.polar_moment * lengths
    inertia[[0, -1]] += bar.arm_inertia
    # Stiffness-proportional: 2 zeta / omega of the bar's own first mode, sqrt(G / rho) pi / length.
    first = math.pi / bar.length * math.sqrt(bar.shear_modulus / bar.density)
    ends = np.zeros(inertia.size)
    ends[[0, -1]] = bar.arm_length**2
    left, right = WHEELS[wheels]
    place = np.concatenate([[0.0], np.cumsum(lengths)]) / bar.length
    travel = np.zeros(inertia.size)
    travel[[0, -1]] = left, right
    lever = 0.5 * bar.length / spacing
    load = np.zeros((2, inertia.size))
    load[:, 0] = 0.5 + lever, 0.5 - lever
    load[:, -1] = 0.5 - lever, 0.5 + lever
    return TorsionChain(
        inertia=inertia,
        stiffness=stiffness,
        damping=2.0 * bar.damping_ratio / first * stiffness,
        link_stiffness=link_stiffness * ends,
        link_damping=link_damping * ends,
        travel=travel,
        start=left + (right - left) * place,
        bushings=np.array([counts[0], counts[0] + counts[1]]),
        load=load / bar.arm_length,
    )


def suspension_file(named: Path = Path("suspension")) -> Path | None:
    """Return the file that ``--rig`` names if it describes a suspension, else None.

    Parameters
    ----------
    named : Path
        A file, or ``suspension`` for the shipped example where no file has this name.

    Examples
    --------
    >>> suspension_file().name
    'suspension.toml'
    """
    if str(named) == "suspension" and not named.exists():
        return Path(str(resources.files("models") / "data" / "rigs" / "suspension.toml"))
    try:
        content = read_toml(named, "")
    except ParameterError:
        return None  # the next reader raises the reason
    return named if "suspension" in content else None


def load_suspension(path: Path) -> Suspension:
    """Read a rig file with a ``[suspension]`` table.

    Parameters
    ----------
    path : Path
        As from `suspension_file`.

    Returns
    -------
    Suspension

    Raises
    ------
    ParameterError
        An entry cannot be used; the message names the key.

    Examples
    --------
    >>> load_suspension(suspension_file()).wheels
    'opposite'
    """
    where = f"rig file {path}"
    content = read_toml(path, where)
    table = as_table(content.pop("suspension"), "suspension", where)
    rig, here = rig_from(content, path.parent, where), f"{where}, suspension"
    bar_keys = {entry.key for entry in declared(Bar).values()}
    refuse_unknown(table, {*bar_keys, *(e.key for e in declared(Suspension).values())}, here)
    bar = read_table(Bar, {key: table[key] for key in table if key in bar_keys}, here)
    rest = {key: table[key] for key in table if key not in bar_keys}
    return read_table(Suspension, rest, here, rig=rig, bar=bar)
