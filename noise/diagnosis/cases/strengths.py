"""Effects of the contract at a given strength, everything else about them drawn.

A strength of 1 is an effect that nobody overlooks, 0.01 one that nobody finds; in between it scales
the parameter that switches the effect off. Forms, places, times and frequencies are drawn over the
widest range in which the effect still is what its name says, since the real one's are not known.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from models.rig import LawSpec
from noise.diagnosis.cases.variants.common import log_uniform
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np

__all__ = ["drawn_effect"]

Values = dict[str, float]

_SENSED = ("torque", "acceleration", "pressure")


def drawn_effect(name: str, strength: float, rng: np.random.Generator) -> LawSpec:
    """Draw an effect of a strength.

    Parameters
    ----------
    name : str
        Of `sim.effects.EFFECTS`.
    strength : float
        From 0 to 1 [-].
    rng : numpy.random.Generator

    Returns
    -------
    LawSpec

    Examples
    --------
    >>> import numpy as np
    >>> drawn_effect("critical_torque_scatter", 0.5, np.random.default_rng(0)).parameters["scatter"]
    0.25
    """
    form = str(rng.choice(EFFECTS[name].forms))
    values: dict[str, float | str] = {"form": form, **_DRAW[name](strength, rng)}
    return LawSpec(name, values)


def _shares(
    rng: np.random.Generator, names: tuple[str, ...] = _SENSED, *, signed: bool = False
) -> Values:
    """Shares of a fault: mostly of one channel alone."""
    if rng.random() < 0.65:
        chosen = [str(rng.choice(names))]
    else:
        chosen = [name for name in names if rng.random() < 0.7] or [str(rng.choice(names))]
    shares = dict.fromkeys(_SENSED, 0.0)
    for name in chosen:
        size = float(rng.uniform(0.5, 1.0)) if len(chosen) > 1 else 1.0
        shares[name] = size * (float(rng.choice([-1.0, 1.0])) if signed else 1.0)
    return shares


def _level(rng: np.random.Generator, pascal: float) -> float:
    return 20.0 * math.log10(pascal * float(rng.uniform(0.2, 1.0)) / 20e-6)


def _amplitude_softening(a: float, rng: np.random.Generator) -> Values:
    return {
        "share": 0.6 * a,
        "twist": log_uniform(rng, 4e-4, 6e-3),
        "averaging_time": log_uniform(rng, 0.02, 0.2),
    }


def _background_noise(a: float, rng: np.random.Generator) -> Values:
    return {
        "amount": a,
        "pressure_level": _level(rng, 0.3),
        "angle": 0.0,
        "acceleration": 8.0 * float(rng.uniform(0.2, 1.0)),
        "torque": 0.15 * float(rng.uniform(0.2, 1.0)),
    }


def _beam_modes(a: float, rng: np.random.Generator) -> Values:
    return {
        "amount": a,
        "frequency": log_uniform(rng, 350.0, 6000.0),
        "constant": log_uniform(rng, 8.0, 40.0),
        "damping_ratio": log_uniform(rng, 0.004, 0.04),
        "anchor_mass": log_uniform(rng, 0.005, 0.08),
    }


def _channel_delay(a: float, rng: np.random.Generator) -> Values:
    return {
        "delay": a * log_uniform(rng, 5e-4, 3e-3),
        "bandwidth": log_uniform(rng, 3.0, 80.0),
        "angle": 0.0,
    } | _shares(rng, signed=True)


def _clipping(a: float, rng: np.random.Generator) -> Values:
    return {"amount": 0.75 * a} | _shares(rng)


def _critical_torque_scatter(a: float, rng: np.random.Generator) -> Values:
    return {"scatter": 0.5 * a, "correlation": float(rng.uniform(0.2, 0.9))}


def _frictional_heating(a: float, rng: np.random.Generator) -> Values:
    return {
        "softening": 0.02 * a,
        "resistance": log_uniform(rng, 0.3, 2.0),
        "area": log_uniform(rng, 3e-4, 1e-3),
        "time_constant": log_uniform(rng, 0.03, 1.0),
        "floor": float(rng.uniform(0.3, 0.7)),
    }


def _gain_error(a: float, rng: np.random.Generator) -> Values:
    return {
        "error": float(rng.choice([-0.5, 0.8])) * a,
        "corner": log_uniform(rng, 150.0, 3000.0),
        "angle": 0.0,
    } | _shares(rng)


def _mains_hum(a: float, rng: np.random.Generator) -> Values:
    return {
        "amount": a,
        "pressure_level": _level(rng, 0.25),
        "angle": 0.0,
        "frequency": float(rng.choice([50.0, 60.0])) * (1.0 + 2e-3 * float(rng.standard_normal())),
        "acceleration": 6.0 * float(rng.uniform(0.2, 1.0)),
        "torque": 0.3 * float(rng.uniform(0.2, 1.0)),
    }


def _mount_resonance(a: float, rng: np.random.Generator) -> Values:
    mostly = ("acceleration",) if rng.random() < 0.7 else _SENSED
    return {
        "amount": a,
        "frequency": log_uniform(rng, 900.0, 9000.0),
        "damping_ratio": log_uniform(rng, 0.015, 0.15),
    } | _shares(rng, mostly)


def _partial_slip(a: float, rng: np.random.Generator) -> Values:
    return {"share": 0.92 * a, "exponent": log_uniform(rng, 1.2, 12.0)}


def _plate_modes(a: float, rng: np.random.Generator) -> Values:
    return {
        "amount": 2.0 * a,
        "frequency": log_uniform(rng, 150.0, 3000.0),
        "damping_ratio": log_uniform(rng, 0.006, 0.15),
        "spacing": log_uniform(rng, 150.0, 1500.0),
    }


def _room_reflections(a: float, rng: np.random.Generator) -> Values:
    return {
        "amount": 4.0 * a,
        "distance": float(rng.uniform(0.3, 1.0)),
        "length": float(rng.uniform(3.0, 12.0)),
        "width": float(rng.uniform(2.5, 9.0)),
        "height": float(rng.uniform(2.3, 5.0)),
        "reverberation_time": log_uniform(rng, 0.1, 1.2),
    }


def _shaft_compliance(a: float, rng: np.random.Generator) -> Values:
    return {
        "compliance": 8e-4 * a,
        "inertia": log_uniform(rng, 3e-5, 2e-4),
        "damping_ratio": log_uniform(rng, 0.01, 0.2),
        "reference_torque": log_uniform(rng, 5.0, 30.0),
    }


def _slip_pulse(a: float, rng: np.random.Generator) -> Values:
    return {
        "amplitude": 250.0 * a,
        "threshold": float(rng.choice([0.0, 0.0, 1.0, 3.0])),
        "duration": log_uniform(rng, 2e-5, 2.5e-4),
    }


def _speed_fluctuation(a: float, rng: np.random.Generator) -> Values:
    return {
        "depth": 0.25 * a,
        "frequency": log_uniform(rng, 3.0, 45.0),
        "bandwidth": log_uniform(rng, 3.0, 60.0),
    }


def _static_ageing(a: float, rng: np.random.Generator) -> Values:
    return {"share": 0.97 * a, "ageing_time": log_uniform(rng, 5e-4, 2e-2)}


def _transfer_film(a: float, rng: np.random.Generator) -> Values:
    return {
        "coverage": a,
        "torque_ratio": float(rng.uniform(1.4, 3.0)),
        "drop_left": float(rng.uniform(0.1, 0.5)),
        "roughness": 0.05 * float(rng.uniform(0.5, 1.0)),
        "growth_angle": log_uniform(rng, 0.2, 3.0),
        "formed": 0.0,
    }


def _velocity_strengthening(a: float, rng: np.random.Generator) -> Values:
    return {"gain": 0.5 * a, "speed": log_uniform(rng, 5.0, 20.0)}


def _velocity_weakening(a: float, rng: np.random.Generator) -> Values:
    return {"share": 0.5 * a, "speed": log_uniform(rng, 2.0, 20.0)}


def _viscoelastic_stiffness(a: float, rng: np.random.Generator) -> Values:
    return {
        "stiffening": 0.9 * a,
        "relaxation_time": log_uniform(rng, 5e-5, 1e-2),
        "spread": float(rng.uniform(2.0, 8.0)),
        "exponent": float(rng.uniform(0.1, 0.4)),
    }


_DRAW: dict[str, Callable[[float, np.random.Generator], Values]] = {
    "amplitude_softening": _amplitude_softening,
    "background_noise": _background_noise,
    "beam_modes": _beam_modes,
    "channel_delay": _channel_delay,
    "clipping": _clipping,
    "critical_torque_scatter": _critical_torque_scatter,
    "frictional_heating": _frictional_heating,
    "gain_error": _gain_error,
    "mains_hum": _mains_hum,
    "mount_resonance": _mount_resonance,
    "partial_slip": _partial_slip,
    "plate_modes": _plate_modes,
    "room_reflections": _room_reflections,
    "shaft_compliance": _shaft_compliance,
    "slip_pulse": _slip_pulse,
    "speed_fluctuation": _speed_fluctuation,
    "static_ageing": _static_ageing,
    "transfer_film": _transfer_film,
    "velocity_strengthening": _velocity_strengthening,
    "velocity_weakening": _velocity_weakening,
    "viscoelastic_stiffness": _viscoelastic_stiffness,
}
