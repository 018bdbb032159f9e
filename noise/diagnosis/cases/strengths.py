"""Effects of the contract at a given strength, everything else about them drawn.

A strength of 1 is an effect that nobody overlooks, 0.01 one that nobody finds; in between it scales
the parameter that switches the effect off. Forms, places, times and frequencies are drawn over the
widest range in which the effect still is what its name says, since the real one's are not known.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from models.rig import LawSpec
from noise.diagnosis.cases.variants.common import log_uniform
from sim.effects import EFFECTS

Values = dict[str, float]
Draw = Callable[[float, "np.random.Generator"], float]
"""Of a strength and a generator."""

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
    0.4
    """
    values: dict[str, float | str] = {"form": str(rng.choice(EFFECTS[name].forms))}
    # A mount is mostly that of the accelerometer; this is drawn before its resonance.
    alone = name == "mount_resonance" and rng.random() < 0.7
    values |= {key: draw(strength, rng) for key, draw in _PARAMETERS[name].items()}
    if name in _ON_CHANNELS:
        names = ("acceleration",) if alone else _SENSED
        values |= _shares(rng, names, signed=name == "channel_delay")
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


def _times(factor: float) -> Draw:
    """Return a number in proportion to the strength; nothing is drawn."""
    return lambda strength, _rng: factor * strength


def _log(low: float, high: float) -> Draw:
    return lambda _strength, rng: log_uniform(rng, low, high)


def _even(low: float, high: float, factor: float = 1.0) -> Draw:
    return lambda _strength, rng: factor * float(rng.uniform(low, high))


def _level(pascal: float) -> Draw:
    """Return a sound pressure level of up to so many pascal [dB re 20 µPa]."""
    return lambda _strength, rng: 20.0 * math.log10(pascal * float(rng.uniform(0.2, 1.0)) / 20e-6)


_STRENGTH, _ZERO = _times(1.0), _times(0.0)

_ON_CHANNELS = ("channel_delay", "clipping", "gain_error", "mount_resonance")
"""Effects that have a share of each channel as well."""

_PARAMETERS: dict[str, dict[str, Draw]] = {
    "amplitude_softening": {
        "share": _times(0.78), "twist": _log(2e-4, 8e-3), "averaging_time": _log(0.01, 0.5),
    },
    "background_noise": {
        "amount": _STRENGTH, "pressure_level": _level(1.0), "angle": _ZERO,
        "acceleration": _log(2.5, 25.0), "torque": _log(0.04, 0.4),
    },
    "beam_modes": {
        "amount": _STRENGTH, "frequency": _log(200.0, 9000.0), "constant": _log(8.0, 100.0),
        "damping_ratio": _log(0.003, 0.06), "anchor_mass": _log(0.005, 0.15),
    },
    "channel_delay": {
        "delay": lambda strength, rng: strength * log_uniform(rng, 5e-4, 1.5e-2),
        "bandwidth": _log(3.0, 80.0), "angle": _ZERO,
    },
    "clipping": {"amount": _times(0.9)},
    "critical_torque_scatter": {"scatter": _times(0.8), "correlation": _even(0.2, 0.95)},
    "frictional_heating": {
        "softening": _times(0.04), "resistance": _log(0.3, 4.0), "area": _log(2e-4, 1e-3),
        "time_constant": _log(0.03, 1.0), "floor": _even(0.3, 0.7),
    },
    "gain_error": {
        "error": lambda strength, rng: float(rng.choice([-0.85, 2.0])) * strength,
        "corner": _log(100.0, 5000.0), "angle": _ZERO,
    },
    "mains_hum": {
        "amount": _STRENGTH, "pressure_level": _level(0.8), "angle": _ZERO,
        "frequency": lambda _strength, rng: (
            float(rng.choice([50.0, 60.0])) * (1.0 + 2e-3 * float(rng.standard_normal()))
        ),
        "acceleration": _log(1.8, 18.0), "torque": _log(0.08, 0.8),
    },
    "mount_resonance": {
        "amount": _STRENGTH, "frequency": _log(400.0, 12e3), "damping_ratio": _log(0.01, 0.3),
    },
    "partial_slip": {"share": _times(0.95), "exponent": _log(1.0, 15.0)},
    "plate_modes": {
        "amount": _times(8.0), "frequency": _log(100.0, 6000.0),
        "damping_ratio": _log(0.004, 0.2), "spacing": _log(150.0, 3000.0),
    },
    "room_reflections": {
        "amount": _times(8.0), "distance": _even(0.2, 1.2), "length": _even(3.0, 12.0),
        "width": _even(2.5, 9.0), "height": _even(2.3, 5.0), "reverberation_time": _log(0.1, 1.5),
    },
    "shaft_compliance": {
        "compliance": _times(2.5e-3), "inertia": _log(3e-5, 1e-3),
        "damping_ratio": _log(0.005, 0.5), "reference_torque": _log(5.0, 30.0),
    },
    "slip_pulse": {
        "amplitude": _times(800.0),
        "threshold": lambda _strength, rng: float(rng.choice([0.0, 0.0, 0.3, 1.0])),
        "duration": _log(1.5e-5, 6e-4),
    },
    "speed_fluctuation": {
        "depth": _times(0.3), "frequency": _log(2.0, 100.0), "bandwidth": _log(2.0, 80.0),
    },
    "static_ageing": {"share": _times(0.97), "ageing_time": _log(1e-3, 0.1)},
    "transfer_film": {
        "coverage": _STRENGTH, "torque_ratio": _log(1.3, 4.0), "drop_left": _even(0.05, 0.7),
        "roughness": _log(0.005, 0.1), "growth_angle": _log(0.05, 3.0), "formed": _ZERO,
    },
    "velocity_strengthening": {"gain": _times(1.5), "speed": _log(8.0, 40.0)},
    "velocity_weakening": {"share": _times(0.85), "speed": _log(0.8, 50.0)},
    "viscoelastic_stiffness": {
        "stiffening": _times(3.0), "relaxation_time": _log(3e-5, 0.1), "spread": _even(2.0, 8.0),
        "exponent": _even(0.1, 0.6),
    },
}  # fmt: skip
"""Draws of each effect's parameters, in the order in which they are made."""
