"""Routes: samples, spectrogram and levels of a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.routing import BaseRoute

    from noise.app.opened import Opened

__all__ = ["routes"]


def routes(_opened: Opened) -> list[BaseRoute]:
    """Return the routes of this view."""
    return []
