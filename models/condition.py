"""Operating condition of a recording or a run: speed, fit, support, material, temperature."""

import math
from dataclasses import dataclass
from typing import Annotated

from models.errors import ParameterError
from models.schema import Quantity, Text, declared
from models.units import ABSOLUTE_ZERO

FIXED = math.inf
"""Support stiffness of the clamp bolted to the baseplate [Nm/rad]."""

_SAME = 1e-3  # relative difference

# Up to 19.75 rad/s at the rig (5.1.3); a bar that swings by 30 degrees at 6 Hz reaches 20.
_SPEED = Quantity("speed_rad_s", 1.0, "rad/s", -1e6, 1e6, (-25.0, 25.0))
# 0.127 to 0.381 mm at the rig (3.1.3); strains of rubber of 1 to 30 %.
_FIT = Quantity("interference_mm", 1e-3, "mm", 1e-6, 10.0, (0.02, 3.0), 0.279)
# 2214 and 3745 Nm/rad at the rig (Table 3.2).
_SUPPORT = Quantity(
    "support_stiffness_Nm_rad", 1.0, "Nm/rad", 1e-3, 1e12, (1e3, 2e5), 2214.0, infinite="fixed"
)
# From a car's cold start to beside its exhaust.
_TEMPERATURE = Quantity(
    "temperature_C", 1.0, "degree Celsius", ABSOLUTE_ZERO, 2000.0, (-40.0, 150.0), default=23.0
)


@dataclass(frozen=True)
class Condition:
    """Operating condition; ``None`` for unknown quantities.

    Parameters
    ----------
    speed : float, optional
        Angular speed of the shaft [rad/s], signed. ``None`` also if it varies during the run.
    interference : float, optional
        Interference fit between shaft and compressed bushing [m].
    support_stiffness : float, optional
        Torsional stiffness of the beams that hold the clamp [Nm/rad]; `FIXED` for the clamp bolted
        to the baseplate.
    material : str, optional
        Elastomer, by the name of its material file.
    temperature : float, optional
        Ambient temperature [degree Celsius].

    Examples
    --------
    >>> squawk = Condition(speed=5.0, interference=0.279e-3, support_stiffness=2214.0)
    >>> squawk.material is None
    True
    """

    speed: Annotated[float | None, _SPEED] = None
    interference: Annotated[float | None, _FIT] = None
    support_stiffness: Annotated[float | None, _SUPPORT] = None
    material: Annotated[str | None, Text("material")] = None
    temperature: Annotated[float | None, _TEMPERATURE] = None

    @property
    def words(self) -> list[str]:
        """Material, fit, support and speed for titles, as far as known.

        Examples
        --------
        >>> Condition(speed=5.0, interference=0.279e-3, support_stiffness=FIXED).words
        ['0.279 mm', 'clamp fixed', '5 rad/s']
        """
        words = [] if self.material is None else [self.material]
        if self.interference is not None:
            words.append(f"{1e3 * self.interference:.4g} mm")
        if self.support_stiffness is not None:
            fixed = math.isinf(self.support_stiffness)
            words.append("clamp fixed" if fixed else f"{self.support_stiffness:g} Nm/rad")
        if self.speed is not None:
            words.append(f"{self.speed:g} rad/s")
        return words


CONDITION: dict[str, Quantity] = {
    name: entry for name, entry in declared(Condition).items() if isinstance(entry, Quantity)
}
"""Declared quantities of a condition, by the names of the fields."""


@dataclass(frozen=True)
class KnownCondition(Condition):
    """Operating condition with known speed, interference and support stiffness.

    Parameters
    ----------
    speed : float
        Angular speed of the shaft [rad/s], signed.
    interference : float
        Interference fit between shaft and compressed bushing [m].
    support_stiffness : float
        Torsional stiffness of the beams [Nm/rad], or `FIXED`.
    material, temperature
        As for `Condition`.

    Examples
    --------
    >>> KnownCondition(5.0, 0.279e-3, 2214.0).speed
    5.0
    """

    speed: float
    interference: float
    support_stiffness: float


def known_condition(condition: Condition) -> KnownCondition:
    """Return a condition as a `KnownCondition`, for simulations.

    Parameters
    ----------
    condition : Condition

    Returns
    -------
    KnownCondition

    Raises
    ------
    ParameterError
        A quantity is unknown; the message names all of them.

    Examples
    --------
    >>> known_condition(Condition(5.0, 0.279e-3, 2214.0, material="PDMS")).material
    'PDMS'
    >>> known_condition(Condition(interference=0.279e-3))
    Traceback (most recent call last):
    models.errors.ParameterError: the condition states no speed [rad/s], support stiffness ...
    """
    if isinstance(condition, KnownCondition):
        return condition
    speed, interference = condition.speed, condition.interference
    support = condition.support_stiffness
    if speed is None or interference is None or support is None:
        named = {
            "speed [rad/s]": speed,
            "interference [m]": interference,
            "support stiffness [Nm/rad]": support,
        }
        missing = ", ".join(name for name, value in named.items() if value is None)
        raise ParameterError(
            f"the condition states no {missing}; a run needs speed, interference and support"
        )
    return KnownCondition(speed, interference, support, condition.material, condition.temperature)


def same_support(one: float, other: float) -> bool:
    """Return whether two support stiffnesses [Nm/rad] are equal to a tenth of a percent.

    Examples
    --------
    >>> same_support(2214.0, 2215.0), same_support(2214.0, FIXED), same_support(FIXED, FIXED)
    (True, False, True)
    """
    return math.isclose(one, other, rel_tol=_SAME)


def support_stiffness(text: str) -> float:
    """Parse a support stiffness [Nm/rad]; ``fixed`` is infinite.

    Raises
    ------
    ParameterError
        The text is neither a positive number nor ``fixed``.

    Examples
    --------
    >>> support_stiffness("2214"), support_stiffness("fixed")
    (2214.0, inf)
    """
    try:
        stiffness = math.inf if text == "fixed" else float(text)
    except ValueError:
        stiffness = math.nan
    if not stiffness > 0.0 or (math.isinf(stiffness) and text != "fixed"):
        raise ParameterError("supports are stiffnesses in Nm/rad, or fixed")
    return stiffness


def support_name(support: float) -> str:
    """Return the name of a support stiffness [Nm/rad] in keys and file names.

    Examples
    --------
    >>> support_name(2214.0), support_name(math.inf)
    ('2214', 'fixed')
    """
    return "fixed" if math.isinf(support) else f"{support:.6g}"
