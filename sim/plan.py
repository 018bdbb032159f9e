"""Plan of a run: its rig, drive, condition, effects, rate and lengths, checked before computing."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from models.condition import Condition
from models.errors import ParameterError
from models.rig import Rig
from models.schema import refuse_impossible
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect, activated
from sim.shaft import ConstantSpeed, ShaftMotion
from sim.temperature import at_temperature

LONGEST_RUN = 600.0
"""Longest run and longest settling [s]: the whole run is in memory."""


@dataclass(frozen=True)
class Timing:
    """Rate, settling and solver tolerance of a kind of run.

    Parameters
    ----------
    least_rate : float
        Lowest rate of motion and sound, which are computed at a multiple of the sampling rate [Hz].
    settling : float
        Time that a shaft at constant speed turns before the recording starts [s].
    tolerance : float, optional
        Error of a solver step where the motion has no exact solution [-]; by default that of the
        friction law.

    Examples
    --------
    >>> SIMULATION.rate(30e3), SIMULATION.rate(48e3), DIAGNOSIS.rate(25.6e3)
    (90000.0, 96000.0, 76800.0)
    """

    least_rate: float
    settling: float
    tolerance: float | None = None

    def decimation(self, sampling_rate: float) -> int:
        """Return the ratio of the rate of motion and sound to a sampling rate [Hz]."""
        return math.ceil(self.least_rate / sampling_rate)

    def rate(self, sampling_rate: float) -> float:
        """Return the rate of motion and sound for a sampling rate [Hz]."""
        return self.decimation(sampling_rate) * sampling_rate


SIMULATION = Timing(least_rate=90e3, settling=0.5)
"""Timing of recordings for users: the sound is accurate beyond 20 kHz."""

DIAGNOSIS = Timing(least_rate=75e3, settling=0.25, tolerance=3e-6)
"""Timing of the many runs that a diagnosis compares with recordings: settled for as long as
structures ring, torques accurate to four digits. The shipped posterior of causes was fitted to
runs of exactly this timing, so the two change together."""

LEARNING = replace(DIAGNOSIS, least_rate=60e3)
"""Timing of the cases that the posterior was fitted to: usual sampling rates are still at least
halved, so the anti-alias filter removes the same band as in a recording."""

REGIME_RATE = 15e3
"""Rate of a motion that only serves to find its regime and slow lines [Hz]: it resolves stick, and
the solution does not depend on it."""


@dataclass(frozen=True)
class Setting:
    """Rig, drive and condition: everything that can be changed during a run.

    Parameters
    ----------
    rig : Rig
    shaft : ShaftMotion
        A motion that can be compared by ``==``. Its clock continues where only its numbers change,
        and restarts where its class changes.
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


@dataclass(frozen=True, eq=False)
class Plan:
    """Inputs of one run: rig, drive, condition, active effects and sampling.

    Parameters
    ----------
    rig : Rig
        Rig at the ambient temperature.
    shaft : ShaftMotion
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    effects : sequence of ActiveEffect
        Effects in the order in which they act.
    rate : float
        Rate of motion and sound [Hz].
    n_settling, n_recorded : int
        Samples at that rate before the recording starts, and in it.
    condition : Condition, optional
        Condition of the recording; without a speed where it varies.
    """

    rig: Rig
    shaft: ShaftMotion
    interference: float
    support_stiffness: float
    effects: Sequence[ActiveEffect]
    rate: float
    n_settling: int
    n_recorded: int
    condition: Condition = field(default_factory=Condition)


def plan_run(
    setting: Setting,
    *,
    seconds: float,
    rate: float,
    settling: float | None = None,
    library: Mapping[str, Effect] | None = None,
) -> Plan:
    """Check the inputs of a run, and plan it.

    Parameters
    ----------
    setting : Setting
    seconds, settling, library
        As for `sim.run.simulate`.
    rate : float
        Sampling rate of the recording [Hz].

    Returns
    -------
    Plan
        At a multiple of `rate`, by `SIMULATION`.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> setting = Setting(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0)
    >>> plan = plan_run(setting, seconds=1.0, rate=30e3)
    >>> plan.rate, plan.n_settling, plan.n_recorded, plan.condition.speed
    (90000.0, 45000, 90000, 5.0)
    """
    shaft = setting.shaft
    if settling is None:
        settling = SIMULATION.settling if isinstance(shaft, ConstantSpeed) else 0.0
    condition = Condition(
        speed=shaft.value if isinstance(shaft, ConstantSpeed) else None,
        interference=setting.interference,
        support_stiffness=setting.support_stiffness,
        material=setting.rig.material,
        temperature=setting.temperature,
    )
    refuse_impossible(condition, "condition")
    if not (0.0 < seconds <= LONGEST_RUN and 0.0 <= settling <= LONGEST_RUN):
        raise ParameterError(
            f"seconds = {seconds:g} must be above 0, settling = {settling:g} at least 0, both at "
            f"most {LONGEST_RUN:g}"
        )
    if not 1e3 <= rate <= 400e3:
        raise ParameterError(f"rate = {rate:g} Hz must lie between 1000 and 400000")
    if round(seconds * rate) < 2:
        raise ParameterError(f"seconds = {seconds:g} holds no two samples at {rate:g} Hz")
    rig = at_temperature(setting.rig, setting.temperature)
    return Plan(
        rig=rig,
        shaft=shaft,
        interference=setting.interference,
        support_stiffness=setting.support_stiffness,
        effects=activated(rig.effects, library or EFFECTS),
        rate=SIMULATION.rate(rate),
        n_settling=round(settling * SIMULATION.rate(rate)),
        n_recorded=round(seconds * rate) * SIMULATION.decimation(rate),
        condition=condition,
    )
