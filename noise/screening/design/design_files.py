"""Copies of design files beside a screen, so that a review finds what each map is of.

Measured responses that a file names by a path of its own folder go with it. One named by a way out
of that folder would not be found from the copy, and the copy is refused. A base out of that folder,
or with such a base of its own, is named by the copy from where it lies.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from models.errors import BushingNoiseError, ParameterError
from models.rig_file import base_name, read_toml
from noise.screening.design.design import load_design


def copy_design_file(name: str, source: Path, folder: Path) -> Path:
    """Copy a design's file to ``folder/NAME.toml``, with the responses that it names.

    Parameters
    ----------
    name : str
        What the screen calls the design.
    source, folder : Path

    Returns
    -------
    Path
        The copy.

    Raises
    ------
    ParameterError
        The name is none of a file, or the copy is no design; the message says so.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as made:
    ...     source = Path(made) / "mine.toml"
    ...     size = source.write_text('material = "PDMS"', encoding="utf-8")
    ...     copy_design_file("soft", source, Path(made) / "designs").name
    'soft.toml'
    """
    target = folder / f"{name}.toml"
    where = f"design {source}: cannot be copied to {target}"
    if Path(name).name != name:
        raise ParameterError(f"{where}: the design's name is none of a file")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in _named_files(source):
            if not path.is_absolute() and ".." not in path.parts:
                (folder / path).parent.mkdir(parents=True, exist_ok=True)
                _copied(source.parent / path, folder / path)
        if (base := _base_elsewhere(source)) is None:
            _copied(source, target)
        else:
            named = f"base = {json.dumps(base_name(base, folder), ensure_ascii=False)}"
            text = source.read_text(encoding="utf-8")
            target.write_text(_BASE.sub(lambda _: named, text, count=1), encoding="utf-8")
        load_design(target)
    except OSError as error:
        raise ParameterError(f"{where}: {error.strerror or error}") from None
    except BushingNoiseError as error:
        target.unlink(missing_ok=True)
        raise ParameterError(f"{where}: {error}") from None
    return target


_BASE = re.compile(r"""^base\s*=\s*(?:"[^"]*"|'[^']*')""", re.MULTILINE)
"""How a file names its base, before any table."""


def _base_elsewhere(source: Path) -> Path | None:
    """Return the base of a file where the way to it, or to its own, leads out of a folder."""
    named = Path(read_toml(source, f"design {source}").get("base", ""))
    base = source.parent / named
    if named.is_absolute() or not base.is_file():
        return None
    return base if ".." in named.parts or _base_elsewhere(base) is not None else None


def _copied(source: Path, target: Path) -> None:
    if not (target.exists() and source.samefile(target)):
        shutil.copyfile(source, target)


def _named_files(source: Path) -> list[Path]:
    content = read_toml(source, f"design {source}")
    found = [
        Path(value)
        for table in content.get("measured_response", [])
        for key, value in table.items()
        if key.startswith("torque_to_") and isinstance(value, str)
    ]
    base = Path(content.get("base", ""))
    if base.suffix and (source.parent / base).is_file() and _base_elsewhere(source) is None:
        found += [base, *(base.parent / named for named in _named_files(source.parent / base))]
    return found
