"""Titles of pictures and maps: support, material and condition in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from noise.labels.conditions import Range

__all__ = ["place_title", "support_words"]


def support_words(support_stiffness: float) -> str:
    """Name a support [Nm/rad] for a title.

    Examples
    --------
    >>> support_words(2214.0), support_words(math.inf)
    ('2214 Nm/rad', 'clamp fixed')
    """
    return "clamp fixed" if math.isinf(support_stiffness) else f"{support_stiffness:g} Nm/rad"


def place_title(material: str | None, support: Range | None) -> str:
    """Name material and support [Nm/rad] of a map.

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
