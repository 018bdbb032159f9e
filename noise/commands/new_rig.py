"""``bushing-noise new-rig``: write a commented rig file to start from."""

from __future__ import annotations

from argparse import Namespace
from importlib import resources
from pathlib import Path

from models.errors import ParameterError
from noise.base.files import atomic, check_target
from noise.base.progress import report
from noise.commands.materials import fit_text
from noise.commands.options import Option

OPTIONS = (
    Option("material MATERIAL", str, "fluorocarbon", count="?"),
    Option("--out FILE.toml", Path),
)


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
    """Return a commented rig file based on a material.

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
    template = resources.files("noise.commands") / "new_rig.toml"
    return template.read_text(encoding="utf-8").format(
        base=rig.material or material,
        effects=", ".join(f'"{one}"' for one in rig.effects) or '"slip_pulse"',
        fits="\n".join(f"#   {fit_text(fit)}" for fit in rig.fits),
        interference=[round(1e3 * fit.interference, 6) for fit in rig.fits],
    )
