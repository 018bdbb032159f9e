"""What can be changed while a rig turns, and the impulse responses that go with it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.radiation.rig_response import first_mode_damping, impulse_responses
from sim.chain import changed_chain
from sim.run import plan_run
from sim.temperature import at_temperature

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.radiation.impulse_responses import ImpulseResponses
    from models.rig import Rig
    from sim.effects.effect import Effect
    from sim.pipeline import Plan
    from sim.shaft import ShaftMotion

__all__ = ["KnownPaths", "Setting", "paths_key", "paths_of", "plan_of", "streams"]


@dataclass(frozen=True)
class Setting:
    """What can be changed while it runs.

    Parameters
    ----------
    rig : Rig
    shaft : ShaftMotion
        Of a kind that can be compared. Its clock goes on where only its numbers change, and starts
        anew where it is of another kind.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    temperature : float
        [degree Celsius]
    """

    rig: Rig
    shaft: ShaftMotion
    interference: float
    support_stiffness: float
    temperature: float = 23.0

    def moves_as(self, other: Setting) -> bool:
        """Whether nothing but the motion of the shaft differs."""
        return replace(self, shaft=other.shaft) == other


def paths_of(
    setting: Setting, rate: float, *, library: Mapping[str, Effect] | None = None, seed: int = 0
) -> ImpulseResponses:
    """Impulse responses at a rate [Hz], as the effects of the rig change them.

    Parameters
    ----------
    setting : Setting
    rate : float
        Of the computation [Hz].
    library, seed
        As of `LiveRun`.
    """
    plan = plan_of(setting, rate, library, n=2)
    paths = impulse_responses(plan.rig, plan.interference, plan.support_stiffness, plan.rate)
    return changed_chain(paths, plan.effects, streams(seed)[1].spawn(1)[0])


def paths_key(setting: Setting) -> tuple[object, ...]:
    """All that the impulse responses depend on: two settings of one key share them.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.shaft import ConstantSpeed
    >>> one = Setting(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0)
    >>> looser = replace(one, rig=one.rig.changed(kinetic_torque="x0.5"), shaft=ConstantSpeed(1.0))
    >>> damped = replace(one, rig=one.rig.changed(damping="x2"))
    >>> paths_key(one) == paths_key(looser), paths_key(one) == paths_key(damped)
    (True, False)
    """
    rig = at_temperature(setting.rig, setting.temperature)
    support = setting.support_stiffness
    fixed = math.isinf(support)
    return (
        rig.beams,
        rig.plate,
        rig.microphone,
        rig.clamp_inertia,
        rig.measured,
        support,
        0.0 if fixed else first_mode_damping(rig, setting.interference, support),
        rig.effects,
    )


class KnownPaths:
    """Impulse responses of the last setting that was asked for, computed at once."""

    def __init__(self, rate: float, library: Mapping[str, Effect] | None, seed: int) -> None:
        self._rate, self._library, self._seed = rate, library, seed
        self._asked: Setting | None = None
        self._key: tuple[object, ...] = ()
        self._found: ImpulseResponses | None = None

    def __call__(self, setting: Setting) -> ImpulseResponses:
        """Return those of a setting."""
        key = self._key if setting is self._asked else paths_key(setting)
        if self._found is None or key != self._key:
            self._found = paths_of(setting, self._rate, library=self._library, seed=self._seed)
        self._asked, self._key = setting, key
        return self._found


def plan_of(setting: Setting, rate: float, library: Mapping[str, Effect] | None, n: int) -> Plan:
    """Plan the run of a setting over `n` samples at a rate [Hz], of effects those that go on."""
    plan = plan_run(
        setting.rig,
        setting.shaft,
        interference=setting.interference,
        support_stiffness=setting.support_stiffness,
        temperature=setting.temperature,
        seconds=max(n, 2) / rate,
        rate=rate,
        settling=None,
        library=library,
    )
    kept = [active for active in plan.effects if not active.effect.needs_whole_run]
    return replace(plan, effects=kept)


def streams(seed: int) -> list[np.random.Generator]:
    """Streams of the sensors' noise and of effects that scatter, as `sim.run.simulate` has them."""
    return np.random.default_rng(seed).spawn(2)
