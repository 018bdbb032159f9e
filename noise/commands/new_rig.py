"""``bushing-noise new-rig``: a commented rig file to start from."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from models.errors import ParameterError
from noise.base.files import atomic, check_target
from noise.base.progress import report
from noise.commands.materials import fit_text
from noise.commands.options import SEED, Option

OPTIONS = (
    Option("material MATERIAL", str, "fluorocarbon", count="?"),
    Option("--out FILE.toml", Path),
    SEED,
)

_TEXT = """\
# Rig file of bushing-noise: every command takes it as --rig FILE, screen as a design.
# What is not stated here stays as in the base. A # begins a comment.
base = "{base}"
name = "my rig"

# Effects, in place of those of the base (`bushing-noise effects` lists them):
# effects = [{effects}]

[change]
# A factor ("x1.2") or a percentage ("-10 %") by the name without a unit; a number, for every fit
# and support, by the name with its unit. In the base:
{fits}
# elastomer_stiffness = "-10 %"
# critical_torque = "+10 %"
# kinetic_torque = "+10 %"
# damping = "x1.2"

# [sensors]
# noise = {{ torque = 0.01, acceleration = 0.1, pressure = 2e-3 }}   # rms, in Nm, m/s2 and Pa
# range = {{ torque = 100, acceleration = 5000, pressure = 20 }}     # of the converter
# bits = 16

# [design]                                 # use of the design, for `bushing-noise screen`
# speed_rad_s = "0.25..13"
# interference_mm = {interference}
# support_stiffness_Nm_rad = [2214, 3745, "fixed"]

# [tolerances]                             # relative standard deviations of parts
# elastomer_stiffness = 0.05
# critical_torque = 0.05
"""


def run(options: Namespace) -> int:
    """Write or print the file."""
    text = new_rig_text(options.material)
    if options.out is None:
        print(text, end="")
        return 0
    if options.out.suffix.lower() != ".toml":
        raise ParameterError(f"--out is {str(options.out)!r}; a rig file ends in .toml")
    check_target(options.out)
    if options.out.exists():
        raise ParameterError(f"{options.out} exists already; name a new file, or remove it first")
    with atomic(options.out) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")
    report(options.out)
    return 0


def new_rig_text(material: str) -> str:
    """Return a commented rig file on a material.

    Raises
    ------
    ParameterError
        There is no such material.

    Examples
    --------
    >>> new_rig_text("PDMS").splitlines()[2]
    'base = "PDMS"'
    """
    from models.rig_file import load_material_rig

    rig = load_material_rig(material)
    return _TEXT.format(
        base=rig.material or material,
        effects=", ".join(f'"{one}"' for one in rig.effects) or '"slip_pulse"',
        fits="\n".join(f"#   {fit_text(fit)}" for fit in rig.fits),
        interference=[round(1e3 * fit.interference, 6) for fit in rig.fits],
    )
