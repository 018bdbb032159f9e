"""Static tests and ring-downs of the second rig: slow motion below any slip, and a shaft held."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from .. import kernel
from ..cases import NOISE, sampled
from ..files import write_wav
from ..rig import FIXED, Parameters, plain
from .laws import Law, turn_with
from .rigs import Made, _scattered

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["held", "record_static", "to_and_fro", "write_static"]

RATE = 20_000
_DECIMATION = 4


def to_and_fro(amplitude: float, frequency: float, seconds: float) -> NDArray[np.float64]:
    """Speed of a shaft that swings as amplitude [rad] times a sine, from rest at no angle."""
    t = np.arange(round(seconds * RATE * _DECIMATION) + 1) / (RATE * _DECIMATION)
    omega = 2.0 * np.pi * frequency
    return amplitude * omega * np.cos(omega * t)


def held(angle: float, speed: float, seconds: float) -> NDArray[np.float64]:
    """Speed of a shaft that turns by an angle [rad], and is then held."""
    t = np.arange(round(seconds * RATE * _DECIMATION) + 1) / (RATE * _DECIMATION)
    return np.where(t < angle / speed, speed, 0.0)


def record_static(
    made: Made, interference: float, support: float, omega: NDArray[np.float64], seed: int,
    *, scatter: float = 1.0,
) -> NDArray[np.float32]:  # fmt: skip
    """Record torque and angle, shape (2, n), of a rig at rest that is turned by `omega`."""
    stiffness, critical, kinetic = made.truth["fits"][str(interference)]
    rig = Parameters(
        *made.truth["inertias"], stiffness, support, made.truth["damping"][str(support)], critical,
        kinetic,
    )  # fmt: skip
    once, _, chance = _scattered(rig, 1.0, scatter, [seed, 91])
    setup = plain(
        once, 0.0, rate=float(RATE * _DECIMATION), seconds=(omega.size - 1) / (RATE * _DECIMATION),
        settling=0.0,
    )  # fmt: skip
    setup.omega[:] = omega
    turned = turn_with(setup, made.law)
    angle = turned.states[:, kernel.SURFACE_ANGLE]
    return np.stack([
        sampled(x, _DECIMATION, scatter * NOISE[name], name, chance)
        for name, x in (("torque", turned.torque), ("angle", angle))
    ])  # fmt: skip


def write_static(
    path: Path, samples: NDArray[np.float32], interference: float, support: float
) -> None:
    """Write a recording with its sidecar."""
    write_wav(path, samples, RATE)
    sidecar = {
        "channels": [{"name": "torque", "unit": "N m"}, {"name": "angle", "unit": "rad"}],
        "conditions": {
            "interference_mm": interference,
            "support_stiffness_Nm_rad": support if support > 0.0 else None,
        },
        "calibrated": True,
    }  # fmt: skip
    path.with_suffix(".json").write_text(json.dumps(sidecar, indent=1) + "\n", encoding="utf-8")


def made_with(law: Law, support: float = FIXED) -> Made:
    """Return an unrecorded rig with a law at 0.279 mm, to be tested statically."""
    truth = {
        "inertias": (1.0 / 65000.0, 1.0 / 1200.0), "fits": {"0.279": (665.0, 10.7, 8.0)},
        "damping": {str(support): 0.1},
    }  # fmt: skip
    return Made(law, truth, (), RATE, ())
