"""Templates of the pages: everything escaped, nothing undefined, nothing from outside."""

from __future__ import annotations

import base64
import hashlib
from functools import lru_cache
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader, StrictUndefined

from noise.labels.label_display import LABEL_LOOKS

if TYPE_CHECKING:
    from jinja2 import Template

__all__ = ["as_base64", "template"]


def template(name: str) -> Template:
    """Return a template of the folder ``templates``.

    Examples
    --------
    >>> template("report.html.j2").name
    'report.html.j2'
    """
    return _environment().get_template(name)


def as_base64(content: bytes) -> str:
    """Encode bytes for a ``data:`` address.

    Examples
    --------
    >>> as_base64(b"RIFF")
    'UklGRg=='
    """
    return base64.b64encode(content).decode()


@lru_cache(maxsize=1)
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("noise.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["looks"] = LABEL_LOOKS
    environment.filters["base64"] = as_base64
    # What the page's own policy lets the browser run.
    environment.filters["sha256"] = lambda text: as_base64(hashlib.sha256(text.encode()).digest())
    return environment
