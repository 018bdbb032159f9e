"""The test rig as plain data: what it is made of, where the sensors sit.

Reading and checking rig files is the business of `models.rig_files.rig_file`.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.rig_files.rig_plate import EDGES, HIGHEST_PLATE_FREQUENCY, Floor, Microphone, Plate
from models.sensors import Sensors
from models.show import short_repr

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.bushing import Sleeve, TemperatureDependence
    from models.transfer_functions.measured import MeasuredResponse

__all__ = [
    "EDGES",
    "HIGHEST_PLATE_FREQUENCY",
    "Beams",
    "Fit",
    "Floor",
    "LawSpec",
    "Microphone",
    "Plate",
    "Rig",
]


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

    interference: float
    elastomer_stiffness: float
    critical_torque: float
    kinetic_torque: float
    damping: Mapping[float, float]

    def __post_init__(self) -> None:
        where = f"fit at {1e3 * self.interference:g} mm"
        for name in ("interference", "elastomer_stiffness"):
            _refuse_unless_positive(getattr(self, name), name, where)
        if not 0.0 <= self.kinetic_torque <= self.critical_torque < math.inf:
            raise ParameterError(
                f"{where}: critical_torque = {self.critical_torque:g} and kinetic_torque = "
                f"{self.kinetic_torque:g} Nm; a contact breaks at no less than it slides at, and "
                "neither is negative"
            )
        for support, damping in self.damping.items():
            if not 0.0 <= damping < math.inf:
                raise ParameterError(
                    f"{where}: damping at {support:g} Nm/rad is {damping:g}; it must be 0 or more"
                )


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

    width: float
    thickness: float
    lever: float
    youngs_modulus: float
    density: float
    damping_ratio: float
    accelerometer: float
    anchor_rotation: float = math.inf
    anchor_translation: float = math.inf
    strike: float = 1 / 24
    radiating: bool = False
    height: float = 0.06
    clamp_width: float = 0.04


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

    name: str
    material: str
    elastomer_inertia: float
    clamp_inertia: float
    fits: tuple[Fit, ...]
    friction: LawSpec
    elastomer_damping_share: float
    effects: tuple[LawSpec, ...]
    beams: Beams
    plate: Plate
    microphone: Microphone
    assumed: tuple[str, ...] = ()
    measured: tuple[MeasuredResponse, ...] = ()
    sensors: Sensors = field(default_factory=Sensors)
    fastest_fitted: float = math.inf
    sleeve: Sleeve | None = None
    temperature: TemperatureDependence | None = None

    def __post_init__(self) -> None:
        for name in ("elastomer_inertia", "clamp_inertia"):
            _refuse_unless_positive(getattr(self, name), name, f"rig {self.name!r}")

    @property
    def interference_range(self) -> tuple[float, float]:
        """Smallest and largest interference for which the bushing's properties are given [m]."""
        return self.fits[0].interference, self.fits[-1].interference

    def changed(self, **changes: str | float | Mapping[str, str | float]) -> Rig:
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
        >>> from models.rig_files.rig_file import load_material_rig
        >>> rig = load_material_rig("fluorocarbon-thesis")
        >>> rig.changed(damping="x2", critical_torque="+50 %").fit(0.279e-3).critical_torque
        16.049...
        >>> rig.changed(damping_Nms_rad=0.09).fit(0.279e-3).damping[2214.0]
        0.09
        >>> calibrated = load_material_rig("fluorocarbon")
        >>> calibrated.changed(slip_pulse={"amplitude": "x0.5"}).effects[0].parameters["amplitude"]
        45.0
        """
        from models.rig_files.change import changed_rig

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


def _refuse_unless_positive(value: float, name: str, where: str) -> None:
    if not 0.0 < value < math.inf:
        raise ParameterError(f"{where}: {name} = {value:g} must be above 0 and finite")


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
