"""Stabilizer bar in two bushings as plain data, and its rig file."""

from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Annotated

from models.errors import ParameterError
from models.rig import Rig
from models.rig_file import material_of, read_toml, rig_from
from models.schema import Quantity, Text, as_table, read_table

SHIPPED = Path(str(resources.files("models") / "data" / "rigs" / "suspension.toml"))
"""Rig file of the shipped suspension."""

WHEELS = {"together": (1.0, 1.0), "opposite": (1.0, -1.0), "left": (1.0, 0.0)}
"""Travel of the left and the right wheel, relative to the drive."""


@dataclass(frozen=True)
class Suspension:
    """Stabilizer bar, links and two bushings, whose brackets are those of the rig.

    Parameters
    ----------
    rig : Rig
        Bushing, clamp, structure and plate; the bar lies along the plate's y.
    bar_diameter, bar_wall : float
        Dimensions of the tube [m]; a wall of half the diameter is a solid bar.
    bar_length : float
        Length between the arms [m].
    arm_length : float
        Distance from the axis to a link [m].
    arm_inertia : float
        Inertia of one arm about that axis [kg m2].
    spacing : float
        Distance between the bushings, which lie symmetrically [m].
    link_stiffness : float
        Stiffness of a link with its joints [N/m].
    link_damping : float
        [N s/m]
    wheels : str
        Travel of the wheels, a key of `WHEELS`.
    shear_modulus : float
        Of the bar [Pa].
    density : float
        [kg/m3]
    damping_ratio : float
        Damping ratio of the bar's first torsional mode [-], proportional to frequency.

    Raises
    ------
    ParameterError
        The bushings do not lie between the arms, or on the plate.
    """

    rig: Rig
    bar_diameter: Annotated[float, Quantity("bar_diameter_mm", 1e-3, "mm")]
    bar_wall: Annotated[float, Quantity("bar_wall_mm", 1e-3, "mm")]
    bar_length: Annotated[float, Quantity("bar_length_mm", 1e-3, "mm")]
    arm_length: Annotated[float, Quantity("arm_length_mm", 1e-3, "mm")]
    arm_inertia: Annotated[float, Quantity("arm_inertia_kgm2")]
    spacing: Annotated[float, Quantity("bushing_spacing_mm", 1e-3, "mm")]
    link_stiffness: Annotated[float, Quantity("link_stiffness_N_m", unit="N/m")]
    link_damping: Annotated[float, Quantity("link_damping_Ns_m", closed=True)]
    wheels: Annotated[str, Text("wheels")]
    shear_modulus: Annotated[float, Quantity("shear_modulus_Pa", unit="Pa")] = 7.9e10
    density: Annotated[float, Quantity("density_kgm3")] = 7850.0
    damping_ratio: Annotated[float, Quantity("bar_damping_ratio", closed=True)] = 0.005

    def __post_init__(self) -> None:
        wrong = ""
        if not 0.0 < self.spacing < self.bar_length:
            wrong = f"spacing = {self.spacing:g} m must be below the bar's {self.bar_length:g} m"
        elif not 2.0 * self.bar_wall <= self.bar_diameter:
            wrong = f"the bar's wall = {self.bar_wall:g} m must be at most half of its diameter"
        elif self.wheels not in WHEELS:
            wrong = f"wheels = {self.wheels!r}; there are {', '.join(WHEELS)}"
        elif self.spacing >= self.rig.plate.width:
            wrong = f"spacing = {self.spacing:g} m does not lie on the plate of width_m"
        elif self.rig.sleeve is None:
            wrong = "the normal load needs the contact pressure, hence a [sleeve] in the rig file"
        if wrong:
            raise ParameterError(f"suspension: {wrong}")

    def preload(self, interference: float) -> float:
        """Return contact pressure times radius and length of a bushing [N], by interference [m]."""
        sleeve = self.rig.sleeve
        assert sleeve is not None  # checked in __post_init__
        return sleeve.pressure(interference) * sleeve.inner_radius * sleeve.length


def load_suspension(path: Path) -> Suspension | None:
    """Read a rig file with a ``[suspension]`` table; None if it names a rig instead.

    Parameters
    ----------
    path : Path
        A file, or ``suspension`` for the shipped example where no file has this name.

    Raises
    ------
    ParameterError
        The file or an entry cannot be used; the message names the key.

    Examples
    --------
    >>> load_suspension(Path("suspension")).wheels, load_suspension(Path("PDMS"))
    ('opposite', None)
    """
    if str(path) == "suspension" and not path.exists():
        path = SHIPPED
    if material_of(path) is not None:
        return None
    where = f"rig file {path}"
    content = read_toml(path, where)
    if "suspension" not in content:
        return None
    table = as_table(content.pop("suspension"), "suspension", where)
    rig = rig_from(content, path.parent, where)
    return read_table(Suspension, table, f"{where}, suspension", rig=rig)
