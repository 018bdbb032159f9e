"""Design of the app: a base rig and its changes, as a rig, a run setting and a rig file."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.change import changed_rig
from models.errors import ParameterError
from models.radiation.rig_response import anchor_arm
from models.rig import Rig, damping_at
from models.rig_file import changed_rig_text
from noise.app.design_controls import Base, base_of, read_values
from noise.base.files import atomic
from noise.base.remarks import effect_remarks, temperature_remark, use_remarks
from sim.effects import EFFECTS
from sim.plan import Setting
from sim.shaft import ConstantSpeed
from sim.temperature import at_temperature

Values = Mapping[str, float | bool]


@dataclass(frozen=True, eq=False)
class Design:
    """State of all controls.

    Parameters
    ----------
    base : Base
    values : mapping of str to float or bool
        Of all controls [unit of each].
    setting : Setting
        Setting of the live run.
    changes : dict of str to str
        Entries of ``[change]``.
    """

    base: Base
    values: Values
    setting: Setting
    changes: Mapping[str, str]

    @property
    def rig(self) -> Rig:
        """Rig with all changes."""
        return self.setting.rig

    @property
    def options(self) -> str:
        """Condition as command-line options."""
        support = "fixed" if self.values["fixed"] else f"{self.values['support']:g}"
        words = [
            f"--speed {self.values['speed']:g}", f"--interference {self.values['interference']:g}",
            f"--support-stiffness {support}",
        ]  # fmt: skip
        if self.values["temperature"] != 23.0:
            words.append(f"--temperature {self.values['temperature']:g}")
        return " ".join(words)

    def text(self, folder: Path, name: str) -> str:
        """Return the text of the rig file `name` in a folder."""
        notes = [f"bushing-noise simulate --rig {name} {self.options}"]
        return changed_rig_text(
            self.base.named_in(folder), self.changes, self.rig.effects, {}, notes
        )

    def facts(self) -> dict[str, str]:
        """Return the resulting quantities of the bushing with units, by short name."""
        setting = self.setting
        fit = at_temperature(setting.rig, setting.temperature).fit(setting.interference)
        quantities = {
            "critical_torque": (fit.critical_torque, "Nm"),
            "kinetic_torque": (fit.kinetic_torque, "Nm"),
            "elastomer_stiffness": (fit.elastomer_stiffness, "Nm/rad"),
            "damping": (damping_at(fit, setting.support_stiffness), "Nm s/rad"),
            "elastomer_inertia": (setting.rig.elastomer_inertia, "kg m2"),
            "clamp_inertia": (setting.rig.clamp_inertia, "kg m2"),
        }
        if (sleeve := setting.rig.sleeve) is not None:
            quantities["wall"] = (1e3 * sleeve.wall, "mm")
            quantities["length"] = (1e3 * sleeve.length, "mm")
            quantities["youngs_modulus"] = (1e-6 * sleeve.youngs_modulus, "MPa")
        return {name: f"{value:.4g} {unit}" for name, (value, unit) in quantities.items()}

    def remarks(self) -> list[str]:
        """Return remarks: values out of the usual range, and data that were not measured."""
        setting = self.setting
        notes = use_remarks(
            setting.rig,
            speed=[setting.shaft.top_speed(math.inf)],
            interference=[setting.interference],
            support_stiffness=[setting.support_stiffness],
            temperature=[setting.temperature],
        )
        notes.append(temperature_remark(setting.rig, setting.temperature))
        notes += effect_remarks(setting.rig, EFFECTS)
        left_out = [
            e.name
            for e in setting.rig.effects
            if e.name in EFFECTS and EFFECTS[e.name].needs_whole_run
        ]
        if left_out:
            notes.append(
                f"effect {', '.join(left_out)}: acts on a run as a whole, so it is not heard "
                "here, but in what is saved"
            )
        return [text for text in notes if text]


def design_of(stated: object, bases: dict[str, Base]) -> Design:
    """Parse the design of a request, ``{"base": ..., "values": {...}}``.

    Raises
    ------
    ParameterError
        The design is invalid.
    """
    if not isinstance(stated, dict):
        raise ParameterError("design: must be an object with base and values")
    base = base_of(stated.get("base"), bases)
    values = read_values(base.controls, stated.get("values", {}))
    own = {control.key: control.value for control in base.controls}
    changes = {
        key.removeprefix("change."): f"x{value:g}"
        for key, value in values.items()
        if key.startswith("change.") and value != own[key]
    }
    rig = changed_rig(base.rig, changes, "design")
    if not values["fixed"]:
        anchor_arm(rig.beams, rig.plate, float(values["support"]))  # refuses what is off the plate
    setting = Setting(
        rig,
        ConstantSpeed(float(values["speed"])),
        1e-3 * float(values["interference"]),
        math.inf if values["fixed"] else float(values["support"]),
        float(values["temperature"]),
    )
    return Design(base, values, setting, changes)


_NAME = re.compile(r"[\w][\w .+-]{0,79}")


def name_of(request: dict[str, Any]) -> str:
    """Return the file name of a request, without ending.

    Raises
    ------
    ParameterError
        The name is missing or not a plain file name.

    Examples
    --------
    >>> name_of({"name": "softer"})
    'softer'
    """
    name = request.get("name")
    if not isinstance(name, str) or not _NAME.fullmatch(name) or name.endswith((".", " ")):
        raise ParameterError(
            "name: must begin with a letter or digit and hold letters, digits, spaces, and . _ + - "
            "alone, 80 at most"
        )
    return name.removesuffix(".toml")


def save_rig(request: dict[str, Any], bases: dict[str, Base], folder: Path) -> dict[str, str]:
    """Write a design as a rig file; return its path and the command that simulates it.

    Raises
    ------
    ParameterError
        The design or its name is invalid, or the file exists.
    """
    design, name = design_of(request, bases), f"{name_of(request)}.toml"
    target = folder / name
    again = request.get("replace") is True
    if target.exists() and not again:
        raise ParameterError(f"{name} is there already; take another name, or save again over it")
    if any(base.file is not None and base.file.absolute() == target for base in bases.values()):
        raise ParameterError(f"{name} is a rig file that is open; take another name")
    with atomic(target) as part:
        part.write_text(design.text(folder, name), encoding="utf-8")
    return {
        "file": str(target),
        "command": f"bushing-noise simulate --rig {name} {design.options} --out heard",
    }
