"""The comment of an MDF4 file: common properties in XML, where conditions may stand.

It is read here and not by the library, which has no public name for these properties and prints
what it cannot follow.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from models.errors import RecordingError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["comment_properties"]

_NAMED = ("e", "list", "tree", "elist")
_NAMESPACE = re.compile(r"""\sxmlns=(["']).*?\1""")


def comment_properties(path: Path, comment: str) -> dict[str, object]:
    """Read the common properties in the comment of a file, at any depth.

    Parameters
    ----------
    path : Path
        For messages.
    comment : str
        Text of the comment; one that is no XML has no properties.

    Raises
    ------
    RecordingError
        A property has no name.

    Examples
    --------
    >>> from pathlib import Path
    >>> entry = '<e name="speed_rad_s">5.0</e>'
    >>> text = f"<HDcomment><TX/><common_properties>{entry}</common_properties></HDcomment>"
    >>> comment_properties(Path("run.mf4"), text)
    {'speed_rad_s': '5.0'}
    """
    try:
        root = ET.fromstring(_NAMESPACE.sub("", comment))
    except (ET.ParseError, ValueError):
        return {}
    found: dict[str, object] = {}
    for properties in root.iter("common_properties"):
        for element in properties.iter():
            if element.tag not in _NAMED:
                continue
            if "name" not in element.attrib:
                raise RecordingError(f"{path}: is damaged (a property of its comment has no name)")
            if element.tag == "e":
                found[element.attrib["name"]] = element.text or ""
    return found
