"""Screens of which maps, critical speeds and ranks alone are asked for."""

from __future__ import annotations

import contextlib

import pytest

from noise.screening.screen import screen


@contextlib.contextmanager
def no_advice():
    """Search for no advice, which takes most of the time of a small screen."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("noise.screening.screen.advise", lambda *_, **__: ())
        yield


def quick_screen(*given, **more):
    """Screen designs without advice."""
    with no_advice():
        return screen(*given, **more)
