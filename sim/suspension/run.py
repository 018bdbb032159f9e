"""One run of a car's stabilizer bar: from the travel of its wheels to a recording.

Every bushing sends its torque through clamp, beams and plate as the rig's does, at its own place on
the plate; accelerometers sit at both, and the microphone hears the sum. The brackets act on each
other through the bar alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import Condition
from models.errors import ParameterError
from models.radiation.rig_response import impulse_responses
from models.recording import Channel, Recording
from sim.acquisition import Acquisition, sample
from sim.analysis.regime import never_slips
from sim.chain import changed_chain
from sim.pipeline import SIMULATION, apply_sensor_effects, radiate_motion, sensor_signals
from sim.run import plan_run
from sim.suspension.kernel import torque_gain
from sim.suspension.motion import simulate_suspension

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.rig import Rig
    from models.suspension import Suspension
    from sim.effects.effect import Effect
    from sim.shaft import ShaftMotion
    from sim.suspension.motion import SuspensionMotion

LONGEST_SUSPENSION_RUN = 20.0
"""All that moves is held in memory [s]."""


@dataclass(frozen=True, eq=False)
class SuspensionRun:
    """What a run of a suspension gives.

    Parameters
    ----------
    recording : Recording
        ``torque``, ``acceleration`` and ``angle`` are those of the left bushing, ``torque_2`` and
        so on those of the right one; ``pressure`` is of both.
    motion : SuspensionMotion
        At the rate of the computation, from rest on.
    gain : float
        Largest torque of a bushing under its load over that without [-].
    pressure : float
        Contact pressure before any load [Pa].
    friction_coefficient : float
        That this and the kinetic torque make together [-].
    """

    recording: Recording
    motion: SuspensionMotion
    gain: float
    pressure: float
    friction_coefficient: float

    def remarks(self) -> tuple[str, ...]:
        """Say what a user should know of it, a line each."""
        load = float(np.abs(self.motion.load).max())
        lifted = (
            f"lifts the bar off a part of it and raises its torque up to {self.gain:.3g} times"
            if self.gain > 1.0
            else "is carried by the contact pressure and leaves its torque as it is"
        )
        return (
            "torque, acceleration and angle are of the left bushing, those with _2 of the right "
            "one; the pressure is of both",
            f"the links load a bushing with up to {load:.0f} N, which {lifted}",
            f"the contact pressure is taken to be {self.pressure / 1e6:.3g} MPa, which with the "
            f"kinetic torque is a friction coefficient of {self.friction_coefficient:.3g}; where "
            "that is not believed, friction_coefficient under [suspension] gives the pressure",
            *(
                f"{side} bushing: its contact holds from first to last"
                for side, motion in zip(("left", "right"), self.motion.bushings, strict=True)
                if never_slips(motion)
            ),
        )


def run_suspension(
    suspension: Suspension,
    shaft: ShaftMotion | float,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float,
    seconds: float,
    acquisition: Acquisition,
    library: Mapping[str, Effect] | None = None,
    rng: np.random.Generator | None = None,
) -> SuspensionRun:
    """Simulate one run of a suspension.

    Parameters
    ----------
    suspension : Suspension
    shaft : ShaftMotion or float
        Travel of the wheels, as the speed that it asks of an arm [rad/s].
    interference, support_stiffness, temperature, seconds, acquisition, library, rng
        As for `sim.run.simulate`.

    Returns
    -------
    SuspensionRun

    Raises
    ------
    ParameterError
        If a value cannot be used, or the run is too long.

    Examples
    --------
    >>> from models.suspension import load_suspension
    >>> from models.suspension import suspension_file
    >>> from sim.shaft import Oscillation
    >>> run = run_suspension(load_suspension(suspension_file()), Oscillation(0.1, 2.0),
    ...     interference=0.279e-3, support_stiffness=2214.0, temperature=23.0, seconds=0.1,
    ...     acquisition=Acquisition(30e3))
    >>> run.recording.channel_names
    ('torque', 'acceleration', 'pressure', 'angle', 'torque_2', 'acceleration_2', 'angle_2')
    """
    if seconds > LONGEST_SUSPENSION_RUN:
        raise ParameterError(
            f"suspension: --seconds {seconds:g} is too long, since the whole run is held in "
            f"memory; give {LONGEST_SUSPENSION_RUN:g} or less"
        )
    acquisition = acquisition.over(suspension.rig.sensors)
    noise_rng, effect_rng = (rng or np.random.default_rng(0)).spawn(2)
    plan = plan_run(
        suspension.rig, shaft, interference=interference, support_stiffness=support_stiffness,
        temperature=temperature, seconds=seconds, rate=acquisition.rate, settling=None,
        library=library,
    )  # fmt: skip
    rig = plan.rig  # at the temperature
    suspension = replace(suspension, rig=rig)
    motion = simulate_suspension(
        suspension, plan.shaft, interference=interference,
        support_stiffness=support_stiffness, seconds=(plan.n_settling + plan.n_kept) / plan.rate,
        rate=plan.rate, effects=plan.effects, rng=effect_rng,
    )  # fmt: skip
    signals: dict[str, np.ndarray[tuple[int], np.dtype[np.float64]]] = {}
    decimation = SIMULATION.decimation(acquisition.rate)
    pressure = np.zeros(plan.n_kept)
    seen = []
    for each, place in zip(motion.bushings, suspension.positions, strict=True):
        paths = impulse_responses(_placed(rig, place), interference, support_stiffness, plan.rate)
        paths = changed_chain(paths, plan.effects, effect_rng.spawn(1)[0])
        sound = radiate_motion(each, paths, plan.effects)
        seen.append(sensor_signals(each, sound, plan.n_settling))
        pressure += seen[-1]["pressure"]
    for number, own in enumerate(seen, start=1):
        sensed = apply_sensor_effects(
            own | {"pressure": pressure}, plan.effects, plan.rate, effect_rng
        )
        for kind, values in sample(sensed, decimation, acquisition, noise_rng).items():
            if number > 1 and kind == "pressure":
                continue  # one microphone
            signals[kind if number == 1 else f"{kind}_{number}"] = values
    channels = [
        Channel(name, position=rig.microphone.position if name == "pressure" else None)
        for name in signals
    ]
    return SuspensionRun(
        Recording(
            samples=np.stack(list(signals.values())),
            rate=acquisition.rate,
            channels=tuple(channels),
            condition=Condition(
                interference=interference, support_stiffness=support_stiffness,
                material=rig.material, temperature=temperature,
            ),
        ),
        motion,
        gain=torque_gain(float(np.abs(motion.load).max()) / suspension.preload(interference)),
        pressure=suspension.contact_pressure(interference),
        friction_coefficient=_coefficient(suspension, interference),
    )  # fmt: skip


def _placed(rig: Rig, along: float) -> Rig:
    """Return the rig with its clamp so far along the plate's y [m]."""
    return replace(
        rig, plate=replace(rig.plate, clamp_position=(rig.plate.clamp_position[0], along))
    )


def _coefficient(suspension: Suspension, interference: float) -> float:
    """Friction coefficient that contact pressure and kinetic torque make together [-]."""
    sleeve = suspension.rig.sleeve
    assert sleeve is not None  # a suspension has one
    torque = 2.0 * np.pi * sleeve.inner_radius * suspension.preload(interference)
    return float(suspension.rig.fit(interference).kinetic_torque / torque)
