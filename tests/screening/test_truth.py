"""Drawn designs and conditions: what a screen says of them against long runs and their labels.

The benchmark of screening: 200 designs by default, ``SCREEN_DRAWS`` for another number, other ones
by ``SCREEN_SEED``, and a file of all results by ``SCREEN_RESULTS``. Of each design one condition is
drawn, and two of its boundary of silence on the map of its speeds: the last that sounds and the
first that does not, 0.125 rad/s apart.
"""

import json
import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.screening.advice import advise, changed
from noise.screening.grid import Grid
from noise.screening.mapping import map_design
from noise.screening.point import batch_evaluator
from noise.screening.vibration import Condition
from tests.screening.long_runs import label_after, vibrates_after

DRAWS = int(os.environ.get("SCREEN_DRAWS", "200"))
SEED = int(os.environ.get("SCREEN_SEED", "33"))
STEP = 0.125
SECONDS = 10.0
MATERIALS = ("fluorocarbon", "fluorocarbon", "fluorocarbon-thesis", "natural-rubber")


def recorded(name, results):
    """Keep results for whoever asks for them."""
    if folder := os.environ.get("SCREEN_RESULTS"):
        Path(folder, f"{name}.json").write_text(json.dumps(results, indent=1), encoding="utf-8")


def drawn(rng):
    """A changed material at a condition."""
    while True:
        names = ("elastomer_stiffness", "critical_torque", "kinetic_torque")
        factors = {name: f"x{rng.uniform(0.85, 1.15):.3f}" for name in names}
        factors["damping"] = f"x{rng.uniform(0.8, 3.0):.3f}"  # so that many are quiet somewhere
        try:
            rig = load_material_rig(str(rng.choice(MATERIALS))).changed(**factors)
        except ParameterError:
            continue
        fit = rng.uniform(*rig.interference_range)
        support = float(rng.choice([2214.0, 3000.0, 3745.0, math.inf]))
        return rig, Condition(STEP * int(rng.integers(4, 100)), fit, support)


def mapped(rig, at):
    """The drawn condition on the map of its speeds, and the two beside the boundary of silence."""
    speeds = tuple(STEP * n for n in range(2, 105))
    one = (at.interference,), (at.support_stiffness,), (at.temperature,)
    grid = Grid(speeds, (), *one, (speeds[0], speeds[-1]))
    found = map_design(rig, grid, batch_evaluator(workers=1), design="drawn")
    noisy = np.flatnonzero(found.label[0, 0, 0] != "none")
    beside = [noisy[-1], noisy[-1] + 1] if noisy.size and noisy[-1] + 1 < len(speeds) else []

    def said(i):
        return tuple(str(part[0, 0, 0, i]) for part in (found.label, found.sound, found.physics))

    return [(replace(at, speed=speeds[i]), *said(i)) for i in (speeds.index(at.speed), *beside)]


def ends_of(rig, at, seconds):
    """Whether it vibrates in the end: from rest; through other speeds, by a jump and by ramps."""
    ways = [(share, 0.05) for share in (0.97, 0.85, 0.7, 0.5)] + [(0.7, 0.5), (0.5, 0.5)]
    ways += [(0.75, 2.0), (1.2, 2.0)]  # slow enough for a small limit cycle to follow
    return vibrates_after(rig, at, [at.speed], seconds=seconds), any(
        vibrates_after(rig, at, [share * at.speed, at.speed], seconds=seconds, ramp=ramp)
        for share, ramp in ways
    )


def judged(rig, at, said, sound, physics):
    """What the screen says and what long runs do."""
    rest, running = ends_of(rig, at, SECONDS)
    heard = label_after(rig, at, [at.speed], seconds=0.5 * SECONDS) if rest else "none"
    return {
        "material": rig.material, "at": str(at), "rest": rest, "running": running,
        "said": said, "sound": sound, "physics": physics, "heard": heard,
    }  # fmt: skip


def score(rows):
    """Count what was said, and what of it is wrong."""
    of = {kind: [row for row in rows if row["said"] == kind] for kind in ("none", "persists")}
    noisy = [row for row in rows if row["said"] not in of]
    named = [row for row in noisy if row["heard"] != "none"]
    return {
        "none": len(of["none"]),
        "none_but_sounds": sum(
            # What oscillates from rest and is labelled none is too faint to be heard.
            row["heard"] != "none" or (row["running"] and not row["rest"])
            for row in of["none"]
        ),
        "persists": len(of["persists"]),
        "persists_but_from_rest": sum(row["rest"] for row in of["persists"]),
        "persists_but_dies": sum(not row["running"] for row in of["persists"]),
        "noisy": len(noisy),
        "noisy_but_silent": sum(not (row["rest"] or row["running"]) for row in noisy),
        "named": len(named),
        "named_alike": sum(row["sound"] == row["heard"] for row in named),
        "named_alike_by_physics": sum(row["physics"] == row["heard"] for row in named),
    }


@pytest.mark.slow
def test_labels_of_drawn_designs_hold_beside_boundaries_and_away_from_them():
    rng = np.random.default_rng(SEED)
    away, beside = [], []
    for _ in range(DRAWS):
        rig, at = drawn(rng)
        here, *others = (judged(rig, *one) for one in mapped(rig, at))
        away.append(here)
        beside += others
    scores = {"away": score(away), "beside": score(beside)}
    recorded("labels", {"scores": scores, "points": [*away, *beside]})
    edge = scores["beside"]
    assert edge["none_but_sounds"] <= 0.02 * edge["none"]
    assert edge["noisy_but_silent"] <= 0.05 * edge["noisy"]
    named = [scores[where]["named"] for where in scores]
    alike = [scores[where]["named_alike"] for where in scores]
    assert sum(alike) >= 0.97 * sum(named)


@pytest.mark.slow
def test_offers_of_drawn_designs_end_the_noise():
    rng = np.random.default_rng(SEED + 1)
    held = []
    while len(held) < DRAWS // 2:
        rig, at = drawn(rng)
        for offer in advise(rig, at):
            if offer.ends:
                new, new_at = changed(rig, at, offer.name, offer.percent)
                noisy = any(ends_of(new, new_at, 2 * SECONDS))
                held.append((rig.material, str(at), offer.words, not noisy))
    recorded("advice", {"hold": sum(one[-1] for one in held), "offers": held})
    assert sum(one[-1] for one in held) >= 0.97 * len(held)
