"""Screens of which maps, critical speeds and ranks alone are asked for."""

from __future__ import annotations

import contextlib

import pytest

from noise.screening.point import SILENT, PointResult, evaluate_row
from noise.screening.screen import screen
from sim.analysis.regime import Regime


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


def judged_by_speed(points, ends=5.0):
    """Noise below a speed, in no time: what an evaluator of maps returns."""
    return [
        PointResult(Regime.STICK_SLIP, "squawk", False, "squawk", 57.0 + at.speed, 60.0 + at.speed)
        if at.speed < ends
        else SILENT
        for at in points
    ]


def evaluate_point(rig, at):
    """What is known of one condition."""
    return evaluate_row(rig, [at])[0]
