"""Effects beyond the plain rig, in random forms and strengths, for designs to differ by.

The strengths go from hardly there to well beyond what repeats differ by. `frictional_heating`,
`shaft_compliance` and `partial_slip` take thirty times the plain model's time, so they come seldom.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.rig import LawSpec
from noise.training.draws import log_uniform
from sim.effects import EFFECTS

if TYPE_CHECKING:
    import numpy as np

__all__ = ["random_extras"]

_RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "velocity_weakening": {"share": (0.01, 0.2), "speed": (2.0, 40.0)},
    "velocity_strengthening": {"gain": (0.005, 0.15)},
    "static_ageing": {"share": (0.1, 0.8), "ageing_time": (1e-4, 1e-2)},
    "critical_torque_scatter": {"scatter": (0.01, 0.3)},
    "amplitude_softening": {"share": (0.05, 0.4)},
    "viscoelastic_stiffness": {"stiffening": (0.03, 0.6)},
    "transfer_film": {"coverage": (0.1, 1.0), "roughness": (0.002, 0.03)},
    "speed_fluctuation": {"depth": (0.003, 0.15), "bandwidth": (1.0, 60.0)},
    "beam_modes": {"amount": (0.1, 3.0), "frequency": (800.0, 8e3)},
    "plate_modes": {"amount": (0.1, 3.0), "frequency": (200.0, 3e3), "spacing": (150.0, 1e3)},
    "room_reflections": {"amount": (0.1, 2.0), "reverberation_time": (0.1, 1.2)},
    "background_noise": {"amount": (0.3, 3.0), "pressure_level": (25.0, 50.0)},
    "mains_hum": {"amount": (0.1, 1.0), "pressure_level": (30.0, 55.0)},
    "mount_resonance": {"amount": (0.1, 1.0), "frequency": (1e3, 12e3)},
    "clipping": {"amount": (0.03, 0.6)},
    "gain_error": {"error": (0.02, 0.4)},
    "channel_delay": {"delay": (1e-5, 5e-3)},
    "slip_pulse": {"amplitude": (20.0, 150.0), "threshold": (2.0, 6.5)},
}
"""What is drawn, evenly in its logarithm; the other parameters keep their defaults."""

_DEAR: dict[str, dict[str, tuple[float, float]]] = {
    "frictional_heating": {"softening": (1e-3, 0.03)},
    "shaft_compliance": {"compliance": (2e-5, 6e-4)},
    "partial_slip": {"share": (0.1, 0.9)},
}

_SHARE_OF_DEAR = 0.02


def random_extras(present: tuple[LawSpec, ...], rng: np.random.Generator) -> tuple[LawSpec, ...]:
    """Return none, on a third of the calls one or two effects that are not `present`.

    Examples
    --------
    >>> import numpy as np
    >>> extras = [random_extras((), np.random.default_rng(seed)) for seed in range(60)]
    >>> sum(map(bool, extras)), max(map(len, extras))
    (18, 2)
    """
    chance = rng.random()
    if chance < _SHARE_OF_DEAR:
        pool, n = _DEAR, 1
    elif chance < 0.35:
        pool, n = _RANGES, int(rng.integers(1, 3))
    else:
        return ()
    taken = {spec.name for spec in present}
    names = [name for name in pool if name not in taken]
    return tuple(
        _drawn(names[i], pool[names[i]], rng) for i in rng.permutation(len(names))[:n].tolist()
    )


def _drawn(name: str, ranges: dict[str, tuple[float, float]], rng: np.random.Generator) -> LawSpec:
    forms = EFFECTS[name].forms
    values: dict[str, float | str] = {"form": forms[int(rng.integers(len(forms)))]}
    for key, (low, high) in ranges.items():
        values[key] = log_uniform(low, high, rng)
    return LawSpec(name, values)
