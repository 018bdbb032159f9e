"""Test rig and bushing as plain data, with their declared entries of rig files.

Quantities are in SI units; the keys of rig files, their units and bounds are declared beside the
fields (`models.schema`), from which `models.rig_file` reads and writes. Bounds follow from the
thesis's rig, and from bushings of wipers up to spring eyes of lorries.
"""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Annotated, Any

from models.bench import Beams, Microphone, Plate
from models.bushing import HARDNESS, Sleeve, TemperatureDependence, shore_modulus
from models.condition import support_name, support_stiffness
from models.errors import ParameterError
from models.schema import (
    Entry,
    Quantity,
    ReadBy,
    Table,
    Text,
    Texts,
    as_table,
    as_text,
    number,
    read_table,
    refuse_impossible,
    table_of,
)
from models.sensors import Sensors
from models.show import short_repr

if TYPE_CHECKING:
    from models.transfer_functions.measured import MeasuredResponse

_STIFFNESS, _DAMPING = "elastomer_stiffness_Nm_rad", "damping_Nms_rad"
_ELASTOMER = "elastomer_inertia_kgm2"


@dataclass(frozen=True)
class LawSpec:
    """Name of a friction law or an effect, with its parameters.

    Parameters
    ----------
    name : str
        Name of a law in `sim.friction` or an effect in `sim.effects`.
    parameters : mapping of str to float or str
        Parameters that differ from the defaults, in the units of their `Parameter` [unit].

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
    """Entry of the friction law; a table without a name changes the parameters of the base."""

    def read(self, value: Any, where: str, old: LawSpec | None = None) -> LawSpec:
        table = dict(as_table(value, self.key, where))
        base = LawSpec("coulomb") if old is None else old
        name = as_text(table.pop("law", base.name), "friction.law", where)
        stated = {key: number(table, key, f"{where}, friction", low=-math.inf) for key in table}
        return LawSpec(name, stated if "law" in value else {**base.parameters, **stated})

    def write(self, value: LawSpec) -> dict[str, Any]:
        return {"law": value.name, **value.parameters}


def _effects(value: Any, key: str, where: str) -> tuple[LawSpec, ...]:
    if not isinstance(value, list):
        raise ParameterError(f'{where}: effects must be a list such as ["slip_pulse:amplitude=20"]')
    return tuple(parse_spec(as_text(e, key, where), f"{where}, effect") for e in value)


@dataclass(frozen=True)
class _BySupport(Entry):
    """Entry of a quantity by support stiffness [Nm/rad], or one number for all supports."""

    value: Quantity

    def read(self, value: Any, where: str, old: Any = None) -> dict[float, float]:  # noqa: ARG002
        by_support = value if isinstance(value, Mapping) else {"fixed": value}
        if not by_support:
            raise ParameterError(f"{where}: {self.key} is empty")
        values = {}
        for key, each in by_support.items():
            try:
                support = support_stiffness(key)
            except ParameterError as error:
                raise ParameterError(
                    f"{where}: {self.key} has the entry {key!r}; {error}"
                ) from None
            values[support] = self.value.read(each, where)
        return values

    def write(self, value: Mapping[float, float]) -> dict[str, float]:
        return {support_name(support): each for support, each in value.items()}


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
        Friction torque at which the contact breaks, and in sliding [Nm] (Section 4.2).
    damping : mapping of float to float
        Torsional damping c_E of bushing and beams together [Nm s/rad] by support stiffness
        [Nm/rad], ``math.inf`` for the bolted clamp (Table 5.5).

    Raises
    ------
    ParameterError
        A value is not positive or not finite, or the kinetic torque is above the critical one.
    """

    interference: Annotated[
        float,  # 0.127 to 0.381 at the rig (3.1.3); strains of rubber of 1 to 30 %
        Quantity("interference_mm", 1e-3, "mm", 1e-6, 100.0, (0.02, 3.0)),
    ]
    elastomer_stiffness: Annotated[
        float,  # 430 to 1011 at the rig (Table 5.3); rings of 10 to 50 mm, G = 0.4 to 6 MPa
        Quantity(_STIFFNESS, 1.0, "Nm/rad", 1e-3, 1e8, (20.0, 2e4)),
    ]
    critical_torque: Annotated[
        float,  # 5 to 40 at the rig (Appendix F); friction 0.1 to 2 at 0.1 to 5 MPa
        Quantity("critical_torque_Nm", 1.0, "Nm", 1e-6, 1e7, (0.3, 500.0)),
    ]
    kinetic_torque: Annotated[
        float, Quantity("kinetic_torque_Nm", 1.0, "Nm", 1e-6, 1e7, (0.2, 500.0))
    ]
    damping: Annotated[
        Mapping[float, float],  # 0.08 to 0.24 at the rig (Table 5.5)
        _BySupport(_DAMPING, Quantity(_DAMPING, 1.0, "Nm s/rad", 1e-9, 1e3, (2e-3, 1.5))),
    ]

    def __post_init__(self) -> None:
        where = f"fit at {1e3 * self.interference:g} mm"
        refuse_impossible(self, where)
        if self.critical_torque < self.kinetic_torque:
            raise ParameterError(
                f"{where}: critical_torque_Nm = {self.critical_torque:g} is below "
                f"kinetic_torque_Nm = {self.kinetic_torque:g}; a contact cannot break below the "
                "torque at which it slides"
            )


def _fits(value: Any, key: str, where: str) -> tuple[Fit, ...]:
    """Read ``[[fit]]`` tables, sorted by interference."""
    if not (isinstance(value, list) and value):
        raise ParameterError(f"{where}: fit must be given as [[fit]] tables, one at least")
    fits = [read_table(Fit, one, f"{where}, {key} {i}") for i, one in enumerate(value, start=1)]
    if len({fit.interference for fit in fits}) < len(fits):
        raise ParameterError(f"{where}: two [[fit]] entries have the same interference_mm")
    return tuple(sorted(fits, key=lambda fit: fit.interference))


class _SleeveTable(Table):
    """Entry of the sleeve, whose modulus may be stated by its hardness."""

    def read(self, value: Any, where: str, old: Sleeve | None = None) -> Sleeve:
        table, inside = dict(as_table(value, self.key, where)), f"{where}, {self.key}"
        if HARDNESS.key in table:
            if "youngs_modulus_MPa" in table:
                raise ParameterError(
                    f"{inside}: give one of youngs_modulus_MPa and hardness_shore_A, not both"
                )
            hardness = HARDNESS.read(table.pop(HARDNESS.key), inside)
            table["youngs_modulus_MPa"] = shore_modulus(hardness) / 1e6
        sleeve: Sleeve = super().read(table, where, old)
        return sleeve


@short_repr
@dataclass(frozen=True)
class Rig:
    """Test rig with its bushing: all data that the simulation needs.

    Parameters
    ----------
    name, material : str
    elastomer_inertia, clamp_inertia : float
        J_E and J_C [kg m2].
    fits : tuple of Fit
        Fits by rising interference.
    friction : LawSpec
        Friction law of the contact; its torques are those of the fit.
    elastomer_damping_share : float
        Share of c_E in the elastomer, with the rest in the beams; the thesis assumes 0.5.
    effects : tuple of LawSpec
        Effects beyond the friction law.
    beams, plate, microphone
        Structure and radiation.
    assumed : tuple of str
        Entries of the files that have no source.
    measured : tuple of MeasuredResponse
        Responses measured on the rig, which replace the modelled ones of their support.
    sensors : Sensors
        Sensors of the recordings.
    fastest_fitted : float
        Highest speed of the fit [rad/s]; infinite if none is stated.
    sleeve : Sleeve, optional
        Rubber sleeve of the fits, from which they are scaled to other sizes and moduli.
    temperature : TemperatureDependence, optional
        Temperature dependence of stiffness, damping and friction; by default none.
    """

    name: Annotated[str, Text("name")]
    material: Annotated[str, Text("material")]
    elastomer_inertia: Annotated[
        float,  # 1.5e-5 at the rig (Appendix F); 5 g at 10 mm to 2 kg at 50 mm
        Quantity(_ELASTOMER, 1.0, "kg m2", 1e-12, 1e3, (5e-7, 5e-3)),
    ]
    clamp_inertia: Annotated[
        float,  # 8.3e-4 at the rig (Appendix F); 50 g at 20 mm to 50 kg at 100 mm
        Quantity("clamp_inertia_kgm2", 1.0, "kg m2", 1e-12, 1e4, (2e-5, 0.5)),
    ]
    fits: Annotated[tuple[Fit, ...], ReadBy("fit", _fits, lambda fits: [*map(table_of, fits)])]
    friction: Annotated[LawSpec, _Law("friction")]
    elastomer_damping_share: Annotated[
        float, Quantity("elastomer_damping_share", high=1.0, closed=True)
    ]
    effects: Annotated[
        tuple[LawSpec, ...], ReadBy("effects", _effects, lambda value: [*map(str, value)])
    ]
    beams: Annotated[Beams, Table("beams", Beams)]
    plate: Annotated[Plate, Table("plate", Plate)]
    microphone: Annotated[Microphone, Table("microphone", Microphone)]
    assumed: Annotated[tuple[str, ...], Texts("assumed")] = ()
    measured: tuple["MeasuredResponse", ...] = ()
    sensors: Sensors = field(default_factory=Sensors)
    fastest_fitted: Annotated[float, Quantity("fastest_fitted_rad_s", infinite="any")] = math.inf
    sleeve: Annotated[Sleeve | None, _SleeveTable("sleeve", Sleeve)] = None
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
        """Smallest and largest interference of the fits [m]."""
        return self.fits[0].interference, self.fits[-1].interference

    def changed(self, **changes: str | float | Mapping[str, str | float]) -> "Rig":
        """Return a rig with quantities changed, like ``[change]`` in a rig file.

        Parameters
        ----------
        **changes : str, float or mapping
            ``"x2"`` or ``"-20 %"`` by short or long name, a number by the long one, which includes
            the unit; parameters of the friction law and of effects by their own names, or, if these
            are ambiguous, in a mapping by the name of the effect, or ``friction``.

        Returns
        -------
        Rig

        Raises
        ------
        ParameterError
            A name is unknown or ambiguous, or an amount cannot be used.

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
        """Return the fit at `interference` [m]: linear between the fits, constant beyond them."""
        low, high = self.interference_range
        interference = min(max(interference, low), high)
        for left, right in zip(self.fits, self.fits[1:], strict=False):
            if interference <= right.interference:
                t = (interference - left.interference) / (right.interference - left.interference)
                return _between(left, right, t)
        return self.fits[-1]


def damping_at(fit: Fit, support_stiffness: float) -> float:
    """Return the damping c_E [Nm s/rad] at a support stiffness, interpolated over compliance.

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
    """Return the stiffness k_EFF of elastomer and beams in series [Nm/rad], seen by the shaft.

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
        damping={k: mix(damping_at(left, k), damping_at(right, k)) for k in supports},
        **{
            each.name: mix(getattr(left, each.name), getattr(right, each.name))
            for each in fields(Fit)
            if each.name != "damping"
        },
    )
