"""Effects of the contract at a given strength, everything else about them drawn.

A strength of 1 is an effect that nobody overlooks, 0.01 one that nobody finds; in between it scales
the parameter that switches the effect off. Forms, places, times and frequencies are drawn over the
widest range in which the effect still is what its name says, since the real one's are not known.
"""

from __future__ import annotations

import tomllib
from importlib import resources

import numpy as np

from models.rig import LawSpec
from noise.diagnosis.cases.draws import SENSED, draw_numbers
from sim.effects import EFFECTS

_OWN_FORMS = tomllib.loads((resources.files(__package__) / "own_forms.toml").read_text("utf-8"))

_ON_CHANNELS = ("channel_delay", "clipping", "gain_error", "mount_resonance")
"""Effects that have a share of each channel as well."""


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
    values |= draw_numbers(_OWN_FORMS[name], rng, strength)
    if name in _ON_CHANNELS:
        names = ("acceleration",) if alone else SENSED
        values |= _shares(rng, names, signed=name == "channel_delay")
    return LawSpec(name, values)


def _shares(
    rng: np.random.Generator, names: tuple[str, ...] = SENSED, *, signed: bool = False
) -> dict[str, float]:
    """Shares of a fault: mostly of one channel alone."""
    if rng.random() < 0.65:
        chosen = [str(rng.choice(names))]
    else:
        chosen = [name for name in names if rng.random() < 0.7] or [str(rng.choice(names))]
    shares = dict.fromkeys(SENSED, 0.0)
    for name in chosen:
        size = float(rng.uniform(0.5, 1.0)) if len(chosen) > 1 else 1.0
        shares[name] = size * (float(rng.choice([-1.0, 1.0])) if signed else 1.0)
    return shares
