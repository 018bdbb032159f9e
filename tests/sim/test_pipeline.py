"""The stages of a run, called one by one, and the presets of their timing."""

from dataclasses import replace

import numpy as np
import pytest

from models.radiation.rig_response import impulse_responses
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.run import (
    DIAGNOSIS,
    SIMULATION,
    plan_run,
    pulse_force,
    radiate_motion,
    run_motion,
    simulate,
)

RIG = replace(load_material_rig("fluorocarbon"), effects=(LawSpec("slip_pulse"),))
AT = {"interference": 0.381e-3, "support_stiffness": 2214.0}


def planned(**given):
    how = AT | {"temperature": 23.0, "seconds": 0.2, "rate": 30e3, "settling": None}
    return plan_run(RIG, 1.0, library=None, **how | given)


def test_the_stages_one_by_one_are_the_run():
    run, plan = simulate(RIG, 1.0, seconds=0.2, **AT), planned()
    motion = run_motion(plan)
    sound = radiate_motion(
        motion, impulse_responses(plan.rig, *AT.values(), plan.rate), plan.effects
    )
    kept = slice(plan.n_settling, None)
    assert np.array_equal(motion.torque[kept], run.motion.torque)
    assert np.array_equal(sound.pressure[kept], run.pressure)
    assert np.array_equal(sound.pulse_pressure[kept], run.pulse_pressure)
    assert pulse_force(motion, plan.effects).max() > 0.0
    assert plan.condition == run.recording.condition
    assert (run.motion.rate, run.settling) == (SIMULATION.rate(30e3), SIMULATION.settling)


@pytest.mark.parametrize(
    ("timing", "rate", "fine", "settling"),
    [
        (SIMULATION, 30e3, 90e3, 0.5),
        (SIMULATION, 25.6e3, 102.4e3, 0.5),
        (DIAGNOSIS, 30e3, 90e3, 0.25),
        (DIAGNOSIS, 25.6e3, 76.8e3, 0.25),
    ],
)
def test_presets_are_what_shipped_models_have_seen(timing, rate, fine, settling):
    assert (timing.rate(rate), timing.settling) == (fine, settling)
    assert timing.rate(rate) == timing.decimation(rate) * rate
