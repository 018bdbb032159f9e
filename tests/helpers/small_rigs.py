"""A bench with a made structure and runs of it, short enough for tests of the diagnosis."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from models.condition import KnownCondition
from models.rig import Fit, LawSpec
from models.rig_file import load_material_rig
from noise.diagnosis.simulated.repeats import (
    Scatter,
    perturb_run,
    plan_repeat,
    record,
    repeat_motion,
)
from noise.diagnosis.simulated.transfer_functions import chain_of, torque_transfer_functions
from noise.recordings import write_recording
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.plan import DIAGNOSIS
from sim.run import apply_sensor_effects, radiate_motion, sensor_signals

__all__ = [
    "RATE", "RIG", "RIG_FILE", "SECONDS", "at", "gap_of_case", "only", "run", "table_of",
    "write_case",
]  # fmt: skip

RATE, SECONDS = 25.6e3, 0.4

RIG = replace(
    load_material_rig("fluorocarbon-thesis"),
    fits=(Fit(0.279e-3, 665.0, 10.7, 8.0, {2214.0: 0.105, 3745.0: 0.085, math.inf: 0.085}),),
)

RIG_FILE = """\
name = "small"
material = "fluorocarbon"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
effects = []
friction = { law = "coulomb" }
[[fit]]
interference_mm = 0.279
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = 10.7
kinetic_torque_Nm = 8.0
damping_Nms_rad = { "2214" = 0.105, "3745" = 0.085, fixed = 0.085 }
"""

_TRANSFERS = {}


def at(speed, support=2214.0):
    return KnownCondition(
        speed=speed, interference=0.279e-3, support_stiffness=support, material="fluorocarbon"
    )


def run(condition, *effects, seed=0, seconds=SECONDS, rate=RATE, rig=RIG, library=EFFECTS):
    """Record one run; an effect is (name, parameters)."""
    support = condition.support_stiffness
    if support not in _TRANSFERS:
        _TRANSFERS[support] = torque_transfer_functions(RIG, condition.interference, support)
    active = activated([LawSpec(name, values) for name, values in effects], library)
    impacts = any(e.effect.force is not None or e.effect.chain is not None for e in active)
    fine = DIAGNOSIS.rate(rate)
    chain = chain_of(
        rig, condition.interference, support, _TRANSFERS[support], fine, impacts=impacts
    )
    rng = np.random.default_rng(seed)
    once, found = perturb_run(rig, condition, Scatter(), rng, support=True)
    plan = plan_repeat(once, found, active, rate=fine, seconds=seconds)
    motion = repeat_motion(plan, rng)
    changed = apply_chain_effects(chain, active, np.random.default_rng(0))
    sound = radiate_motion(motion, changed, active)
    signals = apply_sensor_effects(
        sensor_signals(motion, sound, plan.n_settling), active, fine, rng
    )
    return record(signals, rate, condition, rng, decimation=DIAGNOSIS.decimation(rate))


def gap_of_case(recordings, rig):
    """Gap between recordings and the rig as its file has it."""
    from noise.diagnosis.fit.case_comparison import CaseComparison

    return CaseComparison(rig, tuple(recordings), EFFECTS, None, (), np.empty(0)).gap()


def only(recording, *kinds):
    """Return a recording of which fewer channels were recorded."""
    rows = [recording.channel_names.index(kind) for kind in kinds]
    return replace(
        recording,
        samples=recording.samples[rows],
        channels=tuple(recording.channels[row] for row in rows),
    )


def table_of(names, measured, *, scatter=1.0, speeds=None, rate=RATE):
    """Make a table of a case whose nominal numbers are all 0."""
    from noise.diagnosis.evidence.summary import CaseTable

    measured = np.asarray(measured, dtype=np.float64)
    speeds = speeds or [1.0 + i for i in range(len(measured))]
    return CaseTable(
        tuple(names),
        measured,
        np.zeros_like(measured),
        np.full_like(measured, scatter),
        tuple(at(v) for v in speeds),
        rate,
    )


def write_case(folder, recordings, rig_text=RIG_FILE):
    """Lay a case out as a user does; return its folder of recordings and its rig file."""
    data, rig = folder / "data", folder / "rig.toml"
    data.mkdir(parents=True)
    rig.write_text(rig_text, encoding="utf-8")
    for i, recording in enumerate(recordings):
        write_recording(data / f"run{i + 1:02d}.wav", recording)
    return data, rig
