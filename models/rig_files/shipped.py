"""The bench and the materials that are shipped, as their TOML files say them."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

from models.checks import meant
from models.errors import ParameterError

__all__ = [
    "bench_content", "material_content", "material_names", "material_of", "shipped_name",
    "suspension_file",
]  # fmt: skip

_DATA = resources.files("models") / "data"


def material_names() -> tuple[str, ...]:
    """Names of the materials that are shipped.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> "PDMS" in material_names()
    True
    """
    folder = _DATA / "materials"
    return tuple(sorted(Path(entry.name).stem for entry in folder.iterdir()))


def shipped_name(name: str) -> str | None:
    """Return the name of a shipped material as it is written; case does not matter.

    Examples
    --------
    >>> shipped_name("pdms"), shipped_name("our rubber")
    ('PDMS', None)
    """
    known = {each.lower(): each for each in material_names()}
    return known.get(name.strip().lower())


def material_of(path: Path) -> str | None:
    """Return the shipped material that stands in the place of a rig file, None where none does.

    Examples
    --------
    >>> material_of(Path("pdms")), material_of(Path("bench.toml"))
    ('PDMS', None)
    """
    return None if path.exists() else shipped_name(str(path))


def bench_content() -> dict[str, Any]:
    """Return what the file of the shipped bench holds.

    Examples
    --------
    >>> bench_content()["plate"]["thickness_m"]
    0.01
    """
    return tomllib.loads((_DATA / "rigs" / "bench.toml").read_text(encoding="utf-8"))


def suspension_file() -> Path:
    """Return the file of the shipped suspension, an example.

    Examples
    --------
    >>> suspension_file().name
    'suspension.toml'
    """
    return Path(str(_DATA / "rigs" / "suspension.toml"))


def material_content(name: str) -> dict[str, Any]:
    """Return what the file of a shipped material holds; case does not matter.

    Raises
    ------
    ParameterError
        If the material is unknown.

    Examples
    --------
    >>> material_content("pdms")["material"]
    'PDMS'
    """
    known = shipped_name(name)
    if known is None:
        raise ParameterError(
            f"material {name!r} is unknown{meant(name, material_names())}; there are "
            f"{', '.join(material_names())}"
        )
    text = (_DATA / "materials" / f"{known}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text) | {"material": known}
