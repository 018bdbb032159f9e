"""Pictures into files, whose ending says the format.

The ending is checked before the work whose result is drawn, and a file is the same byte for byte
whenever it is written: dates and names of programs are left out.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.base.files import atomic

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["PICTURE_ENDINGS", "check_picture_path", "write_picture"]

PICTURE_ENDINGS = (".png", ".svg", ".pdf")
"""What a picture's file may end in, in either case."""

_NOTHING_BUT_THE_PICTURE = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def check_picture_path(path: Path) -> None:
    """Refuse a file that no picture can be written to.

    Raises
    ------
    ParameterError
        Its ending is none of `PICTURE_ENDINGS`, or it is a folder.

    Examples
    --------
    >>> from pathlib import Path
    >>> check_picture_path(Path("run07.png"))
    """
    if path.suffix.lower() not in PICTURE_ENDINGS:
        raise ParameterError(f"{path}: a picture ends in {', '.join(PICTURE_ENDINGS[:-1])} or .pdf")
    if path.is_dir():
        raise ParameterError(f"{path}: is a folder; name a file to write")


def write_picture(path: str | Path, figure: Figure) -> None:
    """Write a figure, whole or not at all.

    Parameters
    ----------
    path : str or Path
        Its ending says the format, see `PICTURE_ENDINGS`.
    figure : matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        No picture can be written there.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from matplotlib.figure import Figure
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "empty.png"
    ...     write_picture(path, Figure())
    ...     path.read_bytes()[1:4]
    b'PNG'
    """
    path = Path(path)
    check_picture_path(path)
    from models.drawing import styled

    ending = path.suffix.lower()
    with styled(), atomic(path) as temporary:
        figure.savefig(temporary, format=ending[1:], metadata=_NOTHING_BUT_THE_PICTURE[ending])
