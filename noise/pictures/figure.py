"""Shared parts of pictures: channel kinds, titles, figure frame and file output.

The ending of a file says its format. It is checked before the work whose result is drawn, and a
file is the same byte for byte whenever it is written: dates and names of programs are left out.
Matplotlib is imported where something is drawn.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from models.drawing import CHANNEL_LOOKS, styled
from models.errors import ParameterError
from models.recording import REFERENCE_PRESSURE
from noise.base.files import atomic
from noise.base.progress import readable
from noise.labels.conditions import Range

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURE_ENDINGS = (".png", ".svg", ".pdf")
"""What a picture's file may end in, in either case."""

_NOTHING_BUT_THE_PICTURE = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}

_WIDTH = 12.0
"""Of a picture [inch]."""


class Kind(NamedTuple):
    """Appearance of a kind of channel.

    Parameters
    ----------
    name, unit : str
        As they are written on an axis.
    colour : str
    reference : float
        Of levels, in the channel's unit, such as [Pa]; that of ISO 1683 where there is one.
    density : str
        The reference of the autospectral density in words.
    """

    name: str
    unit: str
    colour: str
    reference: float
    density: str


def _kind(name: str, label: str, reference: float, density: str) -> Kind:
    look = CHANNEL_LOOKS[name]
    return Kind(label, look.unit, look.colour, reference, density)


KINDS = {
    "torque": _kind("torque", "Torque", 1.0, "(1 Nm)²/Hz"),
    "acceleration": _kind("acceleration", "Beam acceleration", 1e-6, "(1 µm/s²)²/Hz"),
    "pressure": _kind("pressure", "Sound pressure", REFERENCE_PRESSURE, "(20 µPa)²/Hz"),
}
"""The kinds of channel that are shown, in their order."""


def support_words(support_stiffness: float) -> str:
    """Return the name of a support [Nm/rad] for titles.

    Examples
    --------
    >>> support_words(2214.0), support_words(math.inf)
    ('2214 Nm/rad', 'clamp fixed')
    """
    return "clamp fixed" if math.isinf(support_stiffness) else f"{support_stiffness:g} Nm/rad"


def place_title(material: str | None, support: Range | None) -> str:
    """Return the title of a map: material and support [Nm/rad].

    Examples
    --------
    >>> place_title("PDMS", None)
    'PDMS, support not known'
    """
    named = "material not known" if material is None else material
    if support is None:
        return f"{named}, support not known"
    if support.low == support.high:
        return f"{named}, {support_words(support.low)}"
    return f"{named}, {support.low:.4g} to {support.high:.4g} Nm/rad"


def new_figure(height: float, title: str) -> Figure:
    """Return an empty figure of the common width, `height` inches high, with its title.

    The title may be the name of a file, which can hold anything: no formula is made of it.

    Examples
    --------
    >>> new_figure(4.0, "5 rad/s").get_size_inches().tolist()
    [12.0, 4.0]
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, height), layout="constrained")
    figure.suptitle(
        readable(title), fontsize=13.0, fontweight="bold", color="#222222", parse_math=False
    )
    return figure


def check_picture_path(path: Path) -> None:
    """Refuse an invalid path of a picture.

    Raises
    ------
    ParameterError
        Its ending is none of `PICTURE_ENDINGS`, or it is a folder.

    Examples
    --------
    >>> check_picture_path(Path("run07.png"))
    """
    if path.suffix.lower() not in PICTURE_ENDINGS:
        raise ParameterError(f"{path}: a picture ends in {', '.join(PICTURE_ENDINGS[:-1])} or .pdf")
    if path.is_dir():
        raise ParameterError(f"{path}: is a folder; name a file to write")


def write_picture(path: str | Path, figure: Figure) -> None:
    """Write a figure atomically.

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
    >>> from matplotlib.figure import Figure
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "empty.png"
    ...     write_picture(path, Figure())
    ...     path.read_bytes()[1:4]
    b'PNG'
    """
    path = Path(path)
    check_picture_path(path)
    ending = path.suffix.lower()
    with styled(), atomic(path) as temporary:
        figure.savefig(temporary, format=ending[1:], metadata=_NOTHING_BUT_THE_PICTURE[ending])
