"""The test rig as plain data: what it is made of, where the sensors sit, how files state it.

Quantities are in SI units; the keys of rig files, their units and bounds are declared beside the
fields (`models.schema`), and `models.rig_file` reads and writes by them. Sources of bounds are the
thesis's rig, and bushings from a wiper's to a lorry's spring eye.
"""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any

from models.bushing import Sleeve, TemperatureDependence, shore_modulus
from models.condition import LENGTH_SLIPS, STIFFNESS_SLIPS
from models.errors import ParameterError
from models.schema import (
    Entry,
    Flag,
    Quantity,
    Table,
    Text,
    Texts,
    Vector,
    as_table,
    as_text,
    number,
    read_table,
    refuse_impossible,
    table_of,
)
from models.sensors import Sensors
from models.show import short_repr

if TYPE_CHECKING:  # brings numpy, which help does without
    from models.transfer_functions.measured import MeasuredResponse

EDGES = ("free", "simply_supported", "clamped")
"""How an edge of the plate may be held."""

HIGHEST_PLATE_FREQUENCY = 16e3
"""Modes of the plate are computed up to it [Hz]: measured creaks fill the band to 15 kHz."""

LEAST_HEIGHT = 0.01
"""Of the microphone over the plate: three surface elements [m]."""

FEWEST_MODES, MOST_MODES = 5, 5000
"""Of the plate: fewer radiate no band, more take minutes."""

MOST_SOLVED_MODES, MOST_UNLIKE_MODES = 1500, 600
"""Where modes are solved for, and where opposite edges are unlike as well: 4 to 8 seconds."""

_STIFFNESS, _DAMPING = "elastomer_stiffness_Nm_rad", "damping_Nms_rad"
_ELASTOMER = "elastomer_inertia_kgm2"
_TORQUE_SLIPS = ((1e-3, "Nmm"), (1e3, "kNm"))
_DAMPING_SLIPS = ((1e-3, "Nmm s/rad"), (180.0 / math.pi, "Nm s/degree"))
_INERTIA_SLIPS = ((1e-4, "kg cm2"), (1e-6, "kg mm2"))


@dataclass(frozen=True)
class LawSpec:
    """A friction law or an effect by name, with its parameters.

    Parameters
    ----------
    name : str
        Of a file in `sim.friction` or of an effect in `sim.effects`.
    parameters : mapping of str to float or str
        Those that differ from the law's own, each in the unit that its `Parameter` declares [unit].

    Examples
    --------
    >>> str(LawSpec("slip_pulse", {"amplitude": 120.0}))
    'slip_pulse:amplitude=120'
    """

    name: str
    parameters: Mapping[str, float | str] = field(default_factory=dict)

    def __str__(self) -> str:
        values = ",".join(
            f"{key}={value:g}" if isinstance(value, float) else f"{key}={value}"
            for key, value in self.parameters.items()
        )
        return f"{self.name}:{values}" if values else self.name


def parse_spec(text: str, where: str = "effect") -> LawSpec:
    """Parse ``name:key=value,key=value``.

    Raises
    ------
    ParameterError
        If the text has another form.

    Examples
    --------
    >>> parse_spec("slip_pulse:amplitude=120,threshold=3")
    LawSpec(name='slip_pulse', parameters={'amplitude': 120.0, 'threshold': 3.0})
    """
    name, _, rest = text.partition(":")
    parameters: dict[str, float | str] = {}
    for part in filter(None, (p.strip() for p in rest.split(","))):
        key, equals, value = part.partition("=")
        if not (equals and key.strip() and value.strip()):
            raise ParameterError(f"{where} {text!r}: write it as NAME:key=value,key=value")
        try:
            parameters[key.strip()] = float(value)
        except ValueError:
            parameters[key.strip()] = value.strip()
    if not name.strip():
        raise ParameterError(f"{where} {text!r}: write it as NAME:key=value,key=value")
    return LawSpec(name.strip(), parameters)


class _Law(Entry):
    """The friction law by name, with parameters; one that names none changes those of the base."""

    def read(self, value: Any, where: str, old: LawSpec | None = None) -> LawSpec:
        table = dict(as_table(value, self.key, where))
        stays = LawSpec("coulomb") if old is None else old
        named = as_text(table.pop("law", stays.name), "friction.law", where)
        given = {key: number(table, key, f"{where}, friction", low=-math.inf) for key in table}
        stated = {} if "law" in value else stays.parameters
        return LawSpec(named, {**stated, **given})

    def write(self, value: LawSpec) -> dict[str, Any]:
        return {"law": value.name, **value.parameters}


class _Effects(Entry):
    """A list of effects, each as ``name:key=value,key=value``."""

    def read(self, value: Any, where: str, old: Any = None) -> tuple[LawSpec, ...]:  # noqa: ARG002
        if not isinstance(value, list):
            raise ParameterError(
                f'{where}: effects must be a list such as ["slip_pulse:amplitude=20"]'
            )
        return tuple(parse_spec(as_text(e, self.key, where), f"{where}, effect") for e in value)

    def write(self, value: tuple[LawSpec, ...]) -> list[str]:
        return [str(effect) for effect in value]


@dataclass(frozen=True)
class _BySupport(Entry):
    """A quantity by support stiffness [Nm/rad], or one number for all supports."""

    value: Quantity

    def read(self, value: Any, where: str, old: Any = None) -> dict[float, float]:  # noqa: ARG002
        by_support = value if isinstance(value, Mapping) else {"fixed": value}
        if not by_support:
            raise ParameterError(f"{where}: {self.key} is empty")
        return {
            _stiffness(key, self.key, where): self.value.read(each, where)
            for key, each in by_support.items()
        }

    def write(self, value: Mapping[float, float]) -> dict[str, float]:
        return {support_name(support): each for support, each in value.items()}


def _stiffness(text: str, key: str, where: str) -> float:
    try:
        return support_stiffness(text)
    except ParameterError as error:
        raise ParameterError(f"{where}: {key} has the entry {text!r}; {error}") from None


def support_stiffness(text: str) -> float:
    """Return the support stiffness [Nm/rad] that a text states; ``fixed`` is infinite.

    Raises
    ------
    ParameterError
        It is neither a positive number nor ``fixed``.

    Examples
    --------
    >>> support_stiffness("2214"), support_stiffness("fixed")
    (2214.0, inf)
    """
    try:
        found = math.inf if text == "fixed" else float(text)
    except ValueError:
        found = math.nan
    if not found > 0.0 or (math.isinf(found) and text != "fixed"):
        raise ParameterError("supports are stiffnesses in Nm/rad, or fixed")
    return found


def support_name(support: float) -> str:
    """Name a support stiffness [Nm/rad] as keys and names of files do.

    Examples
    --------
    >>> support_name(2214.0), support_name(math.inf)
    ('2214', 'fixed')
    """
    return "fixed" if math.isinf(support) else f"{support:.6g}"


@short_repr
@dataclass(frozen=True)
class Fit:
    """Properties of the bushing at one interference fit.

    Parameters
    ----------
    interference : float
        [m]
    elastomer_stiffness : float
        Torsional stiffness k_E [Nm/rad] (Table 5.3).
    critical_torque, kinetic_torque : float
        Friction torque at which the contact breaks, and while it slides [Nm] (Section 4.2).
    damping : mapping of float to float
        Torsional damping c_E of bushing and beams together [Nm s/rad] by support stiffness
        [Nm/rad], the bolted clamp being ``math.inf`` (Table 5.5).

    Raises
    ------
    ParameterError
        A value that is not positive or not finite, or a kinetic torque above the critical one.
    """

    interference: Annotated[
        float,  # 0.127 to 0.381 at the rig (3.1.3); strains of rubber of 1 to 30 %
        Quantity("interference_mm", 1e-3, "mm", 1e-6, 100.0, (0.02, 3.0), LENGTH_SLIPS),
    ]
    elastomer_stiffness: Annotated[
        float,  # 430 to 1011 at the rig (Table 5.3); rings of 10 to 50 mm, G = 0.4 to 6 MPa
        Quantity(_STIFFNESS, 1.0, "Nm/rad", 1e-3, 1e8, (20.0, 2e4), STIFFNESS_SLIPS),
    ]
    critical_torque: Annotated[
        float,  # 5 to 40 at the rig (Appendix F); friction 0.1 to 2 at 0.1 to 5 MPa
        Quantity("critical_torque_Nm", 1.0, "Nm", 1e-6, 1e7, (0.3, 500.0), _TORQUE_SLIPS),
    ]
    kinetic_torque: Annotated[
        float, Quantity("kinetic_torque_Nm", 1.0, "Nm", 1e-6, 1e7, (0.2, 500.0), _TORQUE_SLIPS)
    ]
    damping: Annotated[
        Mapping[float, float],  # 0.08 to 0.24 at the rig (Table 5.5)
        _BySupport(
            _DAMPING, Quantity(_DAMPING, 1.0, "Nm s/rad", 1e-9, 1e3, (2e-3, 1.5), _DAMPING_SLIPS)
        ),
    ]

    def __post_init__(self) -> None:
        where = f"fit at {1e3 * self.interference:g} mm"
        positive = ("interference", "elastomer_stiffness")
        for name in (*positive, "critical_torque", "kinetic_torque"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf or (value == 0.0 and name in positive):
                raise ParameterError(f"{where}: {name} = {value:g} must be above 0")
        if self.critical_torque < self.kinetic_torque:
            raise ParameterError(
                f"{where}: critical_torque_Nm = {self.critical_torque:g} is below "
                f"kinetic_torque_Nm = {self.kinetic_torque:g}; a contact cannot break below the "
                "torque at which it slides"
            )
        if not all(0.0 <= damping < math.inf for damping in self.damping.values()):
            raise ParameterError(f"{where}: damping = {self.damping} must be 0 or more")


@dataclass(frozen=True)
class Beams:
    """The two steel beams that carry the clamp; their length follows from the support stiffness.

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
        Of the beams' bending modes above the first torsional one [-].
    accelerometer : float
        Where on the beam it sits, as a fraction of the length from the clamp.
    anchor_rotation : float, optional
        Stiffness of an anchor against the slope of its beam [Nm/rad]; rigid as in 3.1.1.
    anchor_translation : float, optional
        Stiffness of an anchor against the deflection of its beam [N/m]; rigid as in 3.1.1. Neither
        alters the support stiffness, only the modes above the first torsional one.
    strike : float, optional
        Where the reaction of a blow in the anchor's joint strikes the beam, as a fraction of the
        length from the anchor.
    radiating : bool, optional
        Whether beams and clamp are heard as well, not the plate alone.
    height : float, optional
        Of beams and shaft over the plate [m]; for their sound.
    clamp_width : float, optional
        Of the clamp along the shaft, and its height [m]; for its sound.
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


class _Edges(Entry):
    """How the plate's edges are held: one of `EDGES`, or a list of four of them."""

    def read(self, value: Any, where: str, old: Any = None) -> Any:  # noqa: ARG002
        sides = [value] * 4 if isinstance(value, str) else value
        if not (isinstance(sides, list) and len(sides) == 4 and all(s in EDGES for s in sides)):
            raise ParameterError(
                f"{where}: edges = {value!r} must be one of {', '.join(EDGES)}, or a list of four "
                "of them"
            )
        return value if isinstance(value, str) else tuple(sides)

    def write(self, value: Any) -> Any:
        return value if isinstance(value, str) else list(value)


class _LossFactor(Entry):
    """A loss factor, or a table of them by frequency in Hz."""

    def read(self, value: Any, where: str, old: Any = None) -> Any:  # noqa: ARG002
        if not isinstance(value, Mapping):
            return number({self.key: value}, self.key, where, high=1.0)
        found = []
        for key in value:
            try:
                frequency = float(key)
            except ValueError:
                frequency = math.nan
            if not 0.0 < frequency < math.inf:
                raise ParameterError(
                    f"{where}: loss_factor has the entry {key!r}; entries are frequencies in Hz "
                    "above 0"
                )
            found.append((frequency, number(value, key, f"{where}, loss_factor", high=1.0)))
        return tuple(sorted(found))

    def write(self, value: Any) -> Any:
        return {f"{f:.6g}": loss for f, loss in value} if isinstance(value, tuple) else value


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

    length: Annotated[float, Quantity("length_m", unit="m")]
    width: Annotated[float, Quantity("width_m", unit="m")]
    thickness: Annotated[float, Quantity("thickness_m", unit="m")]
    youngs_modulus: Annotated[float, Quantity("youngs_modulus_Pa", unit="Pa")]
    density: Annotated[float, Quantity("density_kgm3", unit="kg/m3")]
    poisson_ratio: Annotated[float, Quantity("poisson_ratio", high=0.5)]
    loss_factor: Annotated[float | tuple[tuple[float, float], ...], _LossFactor("loss_factor")]
    clamp_position: Annotated[tuple[float, float], Vector("clamp_position_m", 2)]
    edges: Annotated[str | tuple[str, str, str, str], _Edges("edges")] = "simply_supported"

    def __post_init__(self) -> None:
        refuse_impossible(self, "plate")
        table = self.loss_table
        if not table or not all(0.0 < loss <= 1.0 for _, loss in table):
            raise ParameterError(
                f"plate: loss_factor = {self.loss_factor} must be above 0 and at most 1"
            )
        rising = [0.0, *(frequency for frequency, _ in table)]
        if len(table) > 1 and any(b <= a for a, b in itertools.pairwise(rising)):
            raise ParameterError("plate: loss_factor must be given for rising frequencies")
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


def refuse_plate(plate: Plate, where: str) -> None:
    """Refuse a plate whose modes are too few or too many, or that the clamp is off.

    Raises
    ------
    ParameterError
        The message begins with `where`.
    """
    x, y = plate.clamp_position
    if abs(x) >= 0.5 * plate.length or abs(y) >= 0.5 * plate.width:
        raise ParameterError(f"{where}: clamp_position_m = [{x:g}, {y:g}] lies off the plate")
    modes = plate.expected_modes(HIGHEST_PLATE_FREQUENCY)
    left, right, front, back = plate.sides
    most, kind = MOST_MODES, "a plate"
    if set(plate.sides) != {"simply_supported"}:
        most, kind = MOST_SOLVED_MODES, "one whose edges are not all simply_supported"
    if left != right or front != back:
        most, kind = MOST_UNLIKE_MODES, "one whose opposite edges are unlike"
    if not FEWEST_MODES <= modes <= most:
        raise ParameterError(
            f"{where}: a plate of {plate.length:g} x {plate.width:g} x {plate.thickness:g} m has "
            f"about {modes:.3g} modes up to 16 kHz; {kind} must have {FEWEST_MODES} to {most}"
        )


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

    normal: Annotated[str, Text("normal")]
    position: Annotated[float, Quantity("position_m", unit="m", low=-math.inf)]
    reflection: Annotated[float, Quantity("reflection", low=-1.0, high=1.0)] = 1.0

    def __post_init__(self) -> None:
        if self.normal not in ("x", "y", "z"):
            raise ParameterError(f'floor: normal = {self.normal!r} must be "x", "y" or "z"')
        refuse_impossible(self, "floor")


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

    position: Annotated[tuple[float, float, float], Vector("position_m", 3)]
    floor: Annotated[Floor | None, Table("floor", Floor)] = None

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


class _Fits(Entry):
    """The bushing's properties as ``[[fit]]`` tables, by rising interference."""

    def read(self, value: Any, where: str, old: Any = None) -> tuple[Fit, ...]:  # noqa: ARG002
        if not isinstance(value, list):
            raise ParameterError(f"{where}: fit must be given as [[fit]] tables")
        fits = [read_table(Fit, one, f"{where}, fit {i}") for i, one in enumerate(value, start=1)]
        if not fits:
            raise ParameterError(f"{where}: needs at least one [[fit]]")
        if len({fit.interference for fit in fits}) < len(fits):
            raise ParameterError(f"{where}: two [[fit]] entries have the same interference_mm")
        return tuple(sorted(fits, key=lambda fit: fit.interference))

    def write(self, value: tuple[Fit, ...]) -> list[dict[str, Any]]:
        return [table_of(fit) for fit in value]


class _SleeveTable(Entry):
    """The sleeve, whose modulus may be stated by its hardness."""

    def read(self, value: Any, where: str, old: Sleeve | None = None) -> Sleeve:
        table = dict(as_table(value, self.key, where))
        where = f"{where}, {self.key}"
        hardness = table.pop("hardness_shore_A", None)
        if hardness is None:
            return read_table(Sleeve, table, where, old)
        if "youngs_modulus_MPa" in table:
            raise ParameterError(
                f"{where}: give one of youngs_modulus_MPa and hardness_shore_A, not both"
            )
        modulus = modulus_of(hardness, where)
        if old is None:
            table["youngs_modulus_MPa"] = modulus / 1e6
        return replace(read_table(Sleeve, table, where, old), youngs_modulus=modulus)

    def write(self, value: Sleeve) -> dict[str, Any]:
        return table_of(value)


def modulus_of(hardness: Any, where: str) -> float:
    """Young's modulus by a file's hardness in Shore A [Pa].

    Raises
    ------
    ParameterError
        No number, or one outside of what the relation holds for.

    Examples
    --------
    >>> round(modulus_of(60, "rig, change") / 1e6, 2)
    3.61
    """
    try:
        return shore_modulus(number({"hardness_shore_A": hardness}, "hardness_shore_A", where))
    except ParameterError as error:
        raise ParameterError(f"{where}: {str(error).removeprefix(f'{where}: ')}") from None


@short_repr
@dataclass(frozen=True)
class Rig:
    """Everything that the simulation needs to know about a test rig and its bushing.

    Parameters
    ----------
    name, material : str
    elastomer_inertia, clamp_inertia : float
        J_E and J_C [kg m2].
    fits : tuple of Fit
        By rising interference.
    friction : LawSpec
        Friction law of the contact; its torques come from the fit.
    elastomer_damping_share : float
        Share of c_E that acts in the elastomer, the rest in the beams; the thesis assumes 0.5.
    effects : tuple of LawSpec
        What the model includes beyond the friction law.
    beams, plate, microphone
        The structure and the sound's way.
    assumed : tuple of str
        The entries of the files that no source gives.
    measured : tuple of MeasuredResponse
        Responses measured on the rig, each in place of the modelled one of its support.
    sensors : Sensors
        What its signals are recorded through.
    fastest_fitted : float
        Fastest speed that the bushing was fitted at [rad/s]; infinite if none is stated.
    sleeve : Sleeve, optional
        The rubber that the fits were measured on, by which they change with its size and modulus.
    temperature : TemperatureDependence, optional
        How stiffness, damping and friction follow the temperature; without one they stay.
    """

    name: Annotated[str, Text("name")]
    material: Annotated[str, Text("material")]
    elastomer_inertia: Annotated[
        float,  # 1.5e-5 at the rig (Appendix F); 5 g at 10 mm to 2 kg at 50 mm
        Quantity(_ELASTOMER, 1.0, "kg m2", 1e-12, 1e3, (5e-7, 5e-3), _INERTIA_SLIPS),
    ]
    clamp_inertia: Annotated[
        float,  # 8.3e-4 at the rig (Appendix F); 50 g at 20 mm to 50 kg at 100 mm
        Quantity("clamp_inertia_kgm2", 1.0, "kg m2", 1e-12, 1e4, (2e-5, 0.5), _INERTIA_SLIPS),
    ]
    fits: Annotated[tuple[Fit, ...], _Fits("fit")]
    friction: Annotated[LawSpec, _Law("friction")]
    elastomer_damping_share: Annotated[
        float, Quantity("elastomer_damping_share", high=1.0, closed=True)
    ]
    effects: Annotated[tuple[LawSpec, ...], _Effects("effects")]
    beams: Annotated[Beams, Table("beams", Beams)]
    plate: Annotated[Plate, Table("plate", Plate)]
    microphone: Annotated[Microphone, Table("microphone", Microphone)]
    assumed: Annotated[tuple[str, ...], Texts("assumed")] = ()
    measured: tuple["MeasuredResponse", ...] = ()
    sensors: Sensors = field(default_factory=Sensors)
    fastest_fitted: Annotated[float, Quantity("fastest_fitted_rad_s", infinite="any")] = math.inf
    sleeve: Annotated[Sleeve | None, _SleeveTable("sleeve")] = None
    temperature: Annotated[
        TemperatureDependence | None, Table("temperature", TemperatureDependence, whole=True)
    ] = None

    def __post_init__(self) -> None:
        for name in ("elastomer_inertia", "clamp_inertia"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ParameterError(
                    f"rig {self.name!r}: {name} = {getattr(self, name):g} must be above 0"
                )

    @property
    def interference_range(self) -> tuple[float, float]:
        """Smallest and largest interference for which the bushing's properties are given [m]."""
        return self.fits[0].interference, self.fits[-1].interference

    def changed(self, **changes: str | float | Mapping[str, str | float]) -> "Rig":
        """Return the rig with quantities changed, as ``[change]`` in a rig file does.

        Parameters
        ----------
        **changes : str, float or mapping
            ``"x2"`` or ``"-20 %"`` by short or long name, a number by the long one, which names
            its unit; parameters of the friction law and of effects by their own names, where
            several have the name in a mapping by that of the effect, or ``friction``.

        Returns
        -------
        Rig
            Another one; this one stays as it is.

        Raises
        ------
        ParameterError
            A name is unknown or means several quantities, or an amount cannot be used.

        Examples
        --------
        >>> from models.rig_file import load_material_rig
        >>> rig = load_material_rig("fluorocarbon-thesis")
        >>> rig.changed(damping="x2", critical_torque="+50 %").fit(0.279e-3).critical_torque
        16.049...
        >>> rig.changed(damping_Nms_rad=0.09).fit(0.279e-3).damping[2214.0]
        0.09
        >>> calibrated = load_material_rig("fluorocarbon")
        >>> calibrated.changed(slip_pulse={"amplitude": "x0.5"}).effects[0].parameters["amplitude"]
        45.0
        """
        from models.change import changed_rig

        return changed_rig(self, changes, f"rig {self.name!r}")

    def fit(self, interference: float) -> Fit:
        """Properties at `interference` [m]: linear between the given fits, held outside them."""
        low, high = self.interference_range
        interference = min(max(interference, low), high)
        for left, right in zip(self.fits, self.fits[1:], strict=False):
            if interference <= right.interference:
                t = (interference - left.interference) / (right.interference - left.interference)
                return _between(left, right, t)
        return self.fits[-1]


def damping_at(fit: Fit, support_stiffness: float) -> float:
    """Damping c_E [Nm s/rad] at a support stiffness, linear in the compliance between entries.

    Examples
    --------
    >>> bushing = Fit(2.79e-4, 665.0, 10.7, 8.0, {2214.0: 0.105, 3745.0: 0.085})
    >>> damping_at(bushing, 2214.0), damping_at(bushing, math.inf)
    (0.105, 0.085)
    """
    points = sorted((_compliance(k), c) for k, c in fit.damping.items())
    x = _compliance(support_stiffness)
    if x <= points[0][0]:
        return points[0][1]
    for (x0, c0), (x1, c1) in itertools.pairwise(points):
        if x < x1:
            return c0 + (c1 - c0) * (x - x0) / (x1 - x0)
    return points[-1][1]


def effective_stiffness(fit: Fit, support_stiffness: float) -> float:
    """Stiffness k_EFF of elastomer and beams in series [Nm/rad], as the shaft feels it in stick.

    Notes
    -----
    Thesis, 4.1 and Table 5.4. Its static tests gave 2 to 15 % less (Table 5.3).

    Examples
    --------
    >>> bushing = Fit(2.79e-4, 665.0, 10.7, 8.0, {math.inf: 0.085})
    >>> round(effective_stiffness(bushing, 2214.0)), effective_stiffness(bushing, math.inf)
    (511, 665.0)
    """
    return 1.0 / (1.0 / fit.elastomer_stiffness + _compliance(support_stiffness))


def _compliance(stiffness: float) -> float:
    return 0.0 if math.isinf(stiffness) else 1.0 / stiffness


def _between(left: Fit, right: Fit, t: float) -> Fit:
    def mix(a: float, b: float) -> float:
        return a + t * (b - a)

    supports = sorted({*left.damping, *right.damping})
    return Fit(
        interference=mix(left.interference, right.interference),
        elastomer_stiffness=mix(left.elastomer_stiffness, right.elastomer_stiffness),
        critical_torque=mix(left.critical_torque, right.critical_torque),
        kinetic_torque=mix(left.kinetic_torque, right.kinetic_torque),
        damping={k: mix(damping_at(left, k), damping_at(right, k)) for k in supports},
    )
