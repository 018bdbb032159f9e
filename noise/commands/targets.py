"""Where results go, checked before the work whose result they are."""

from __future__ import annotations

from tempfile import TemporaryFile
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["check_target"]


def check_target(path: Path, option: str = "--out") -> None:
    """Refuse a file, or folder, that cannot be made because of what stands above it.

    `option` is the one that names it.

    Raises
    ------
    ParameterError
        The nearest folder above `path` that exists is none, or may not be written to.

    Examples
    --------
    >>> from pathlib import Path
    >>> check_target(Path("new") / "folder" / "table.csv")
    """
    try:
        above = next(parent for parent in path.absolute().parents if parent.exists())
    except OSError as error:
        raise ParameterError(f"{option} {path}: cannot be written ({error.strerror})") from None
    if not above.is_dir():
        raise ParameterError(f"{option} {path}: {above} is a file, not a folder")
    try:
        with TemporaryFile(dir=above):  # what counts is not the permission but whether it works
            pass
    except OSError:
        raise ParameterError(f"{option} {path}: the folder {above} may not be written to") from None
