"""Controls of a design: adjustable quantities with their bounds, for page and server.

A base is a shipped material or an opened rig file; friction law and effects are those of the base.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from models.condition import CONDITION
from models.errors import ParameterError
from models.rig import Rig
from models.rig_file import base_name, load_material_rig, load_rig, material_names

if TYPE_CHECKING:
    from noise.app.opened import Opened


_FACTORS = {
    "critical_torque": ("Critical torque", "at which the contact breaks"),
    "kinetic_torque": ("Kinetic torque", "while it slides"),
    "elastomer_stiffness": ("Stiffness", "torsional, of the elastomer"),
    "damping": ("Damping", "of bushing and beams together"),
    "elastomer_inertia": ("Inertia of the elastomer", ""),
    "clamp_inertia": ("Inertia of the clamp", ""),
}
_SLEEVE = {
    "wall": ("Wall of the rubber", "torques, stiffness and inertia follow"),
    "length": ("Length of the rubber", "torques, stiffness and inertia follow"),
    "youngs_modulus": ("Young's modulus of the rubber", "torques and stiffness follow"),
}


@dataclass(frozen=True)
class Control:
    """Adjustable quantity of a design.

    Parameters
    ----------
    key : str
        Key of its value in the state.
    kind : str
        ``number`` or ``switch``.
    group, label, meaning : str
        Heading, name and explanation.
    value : float or bool
        Value of the base [`unit`].
    unit : str
    low, high : float
        Range of the slider, which is plausible [`unit`].
    least, most : float
        Range of valid values [`unit`].
    log : bool
        Whether the slider is logarithmic.
    unless : str
        Key of a switch that disables this control.
    """

    key: str
    kind: str
    group: str
    label: str
    value: float | bool
    meaning: str = ""
    unit: str = ""
    low: float = 0.0
    high: float = 1.0
    least: float = 0.0
    most: float = 1.0
    log: bool = False
    unless: str = ""

    def read(self, stated: object) -> float | bool:
        """Parse the value of a request.

        Raises
        ------
        ParameterError
            The value is invalid for this control.
        """
        if self.kind == "switch":
            if isinstance(stated, bool):
                return stated
            raise ParameterError(f"{self.label}: must be on or off")
        number = isinstance(stated, int | float) and not isinstance(stated, bool)
        if not number or not self.least <= float(stated) <= self.most:  # type: ignore[arg-type]
            raise ParameterError(
                f"{self.label} {str(stated)[:40]}: must be a number from {self.least:g} to "
                f"{self.most:g} {self.unit}".rstrip()
            )
        return float(f"{stated:.6g}")  # as a rig file writes it


def controls_of(rig: Rig) -> list[Control]:
    """Return all controls of a rig.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> [control.key for control in controls_of(load_material_rig("PDMS"))][:6]
    ['speed', 'interference', 'fixed', 'support', 'temperature', 'change.critical_torque']
    """
    return [*_condition(rig), *_bushing(rig)]


def read_values(controls: list[Control], stated: object) -> dict[str, float | bool]:
    """Return the values of all controls, from a request or else from the base.

    Raises
    ------
    ParameterError
        A key is unknown or a value is invalid.
    """
    if not isinstance(stated, dict):
        raise ParameterError("design: the state must be an object of values by control")
    by_key = {control.key: control for control in controls}
    for key in stated:
        if key not in by_key:
            raise ParameterError(f"design: there is nothing called {str(key)[:60]!r} to change")
    return {
        key: control.read(stated[key]) if key in stated else control.value
        for key, control in by_key.items()
    }


def _number(
    key: str, group: str, label: str, value: float, unit: str, slider: tuple[float, float],
    admitted: tuple[float, float], meaning: str = "", *, log: bool = False, unless: str = "",
) -> Control:  # fmt: skip
    return Control(
        key, "number", group, label, float(f"{value:.6g}"), meaning, unit, *slider, *admitted,
        log=log, unless=unless,
    )  # fmt: skip


def _condition(rig: Rig) -> Iterator[Control]:
    group, fastest = "Condition", CONDITION["speed"].usual[1]
    yield _number(
        "speed", group, "Speed", min(fastest, 5.0), "rad/s", (0.0, fastest), (-200.0, 200.0)
    )
    low, high = (1e3 * fit for fit in rig.interference_range)
    fit, support, temperature = (
        CONDITION[name] for name in ("interference", "support_stiffness", "temperature")
    )
    default = min(max(fit.default, low), high)
    yield _number(
        "interference", group, "Interference", default, "mm",
        (round(0.7 * low, 3), round(1.3 * high, 3)), (fit.low, fit.high),
    )  # fmt: skip
    yield Control("fixed", "switch", group, "Clamp bolted to the baseplate", False)
    yield _number(
        "support", group, "Support stiffness", support.default, "Nm/rad", (1.2e3, 2e4),
        (support.low, support.high), log=True, unless="fixed",
    )  # fmt: skip
    yield _number(
        "temperature", group, "Temperature", temperature.default, "°C", temperature.usual,
        (temperature.low, temperature.high),
    )  # fmt: skip


def _bushing(rig: Rig) -> Iterator[Control]:
    named = _FACTORS | (_SLEEVE if rig.sleeve is not None else {})
    for name, (label, meaning) in named.items():
        yield _number(
            f"change.{name}", "Bushing, as a factor of the base", label, 1.0, "x", (0.2, 5.0),
            (0.01, 100.0), meaning, log=True,
        )  # fmt: skip


@dataclass(frozen=True)
class Base:
    """Base rig of designs.

    Parameters
    ----------
    name : str
        Name in the browser.
    file : Path or None
        None for a material.
    """

    name: str
    file: Path | None = None

    @cached_property
    def rig(self) -> Rig:
        """Rig, read once."""
        return load_material_rig(self.name) if self.file is None else load_rig(self.file)

    @cached_property
    def controls(self) -> list[Control]:
        """Controls with the values of the rig."""
        return controls_of(self.rig)

    def named_in(self, folder: Path) -> str:
        """Return the entry ``base`` of a rig file in a folder."""
        return self.name if self.file is None else base_name(self.file, folder)


def bases_of(opened: Opened) -> dict[str, Base]:
    """Return all bases by identifier: rig files, then materials.

    Raises
    ------
    BushingNoiseError
        A rig file cannot be read.

    Examples
    --------
    >>> from noise.app.opened import open_paths
    >>> next(iter(bases_of(open_paths([]))))
    'fluorocarbon'
    """
    bases = {f"rig {i}": Base(path.name, path) for i, path in enumerate(opened.rigs)}
    for named in bases.values():
        _ = named.controls  # what is wrong with it is told where it was named
    names = sorted(material_names(), key=lambda name: (name != "fluorocarbon", name.lower()))
    return bases | {name: Base(name) for name in names}


def base_of(stated: object, bases: dict[str, Base]) -> Base:
    """Return the base of a request.

    Raises
    ------
    ParameterError
        There is none.
    """
    if not isinstance(stated, str) or stated not in bases:
        raise ParameterError(f"design: base {str(stated)[:40]!r} is none of {', '.join(bases)}")
    return bases[stated]
