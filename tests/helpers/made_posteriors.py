"""A cause posterior of a made world: each cause moves numbers of its own."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from noise.diagnosis.causes.location import learn_stage_nulls
from noise.diagnosis.evidence.summary import scale_of
from noise.training.causes.cases.draw import Truth
from noise.training.causes.fit import Known, train_posterior
from sim.effects import EFFECTS
from tests.helpers.small_rigs import table_of

__all__ = ["MOVES", "NAMES", "made_cases", "made_nulls", "made_posterior", "made_table"]

_NAMES = (
    "angle_speed_spread", "contact_creep_up_4", "contact_law_down_3", "contact_peak_spread",
    "acceleration_gain_5", "acceleration_hum_50", "acceleration_delay", "pressure_gain_9",
    "pressure_left_9", "pressure_top", "torque_offset", "common_1",
)  # fmt: skip

MOVES = {
    "partial_slip": ("contact_creep_up_4",),
    "velocity_weakening": ("contact_law_down_3",),
    "beam_modes": ("acceleration_gain_5",),
    "plate_modes": ("pressure_gain_9", "pressure_left_9"),
    "clipping": ("pressure_top",),
    "speed_fluctuation": ("angle_speed_spread",),
}
"""Numbers that each cause moves."""

_MORE = {name: (f"contact_of_{name}",) for name in EFFECTS if name not in MOVES}
NAMES = (*_NAMES, *(name for names in _MORE.values() for name in names))

_OTHER = {"parameters": ("contact_peak_spread",), "unknown": ("common_1", "torque_offset")}


def made_table(rng, cause=None, size=12.0, n=4):
    measured = rng.normal(size=(n, len(NAMES)))
    for name in (MOVES | _MORE | _OTHER).get(cause, ()):
        measured[:, NAMES.index(name)] += size
    return table_of(NAMES, measured, speeds=[1.0, 2.0, 3.0, 3.0][:n])


def made_cases(seed=0, each=10):
    rng = np.random.default_rng(seed)
    cases = [Known(made_table(rng), Truth("none")) for _ in range(3 * each)]
    for name in EFFECTS:
        truth = Truth("one", (name,), ("form",), (0.5,))
        cases += [Known(made_table(rng, name), truth) for _ in range(each)]
    for kind in _OTHER:
        cases += [Known(made_table(rng, kind), Truth(kind)) for _ in range(each)]
    return [replace(case, rig=i) for i, case in enumerate(cases)]


@cache
def made_nulls(seed=0, n=300):
    """Learn what cases without a cause differ by."""
    rng = np.random.default_rng(seed)
    tables = [made_table(rng) for _ in range(n)]
    return learn_stage_nulls(tables, NAMES, scale_of(tables, NAMES))


@cache
def made_posterior(seed=0):
    """Train on them; the same one for all that only look at it."""
    return train_posterior(made_cases(seed, each=12), seed=seed, n_rounds=30)
