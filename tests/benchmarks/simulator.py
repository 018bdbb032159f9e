# ruff: noqa: T201
"""How fast the rig is simulated: by law, by effect, and with sound and acquisition.

Run by hand: ``python -m tests.benchmarks.simulator``. One second of stick-slip, the thesis's rig at
3745 Nm/rad and 1 rad/s, output at 30 kHz; processor seconds, best of several, everything in one
process, over those of true stick solved exactly between events.
"""

import time
from collections.abc import Callable
from dataclasses import replace

from models.rig import LawSpec, Rig
from models.rig_file import load_material_rig
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import LAWS
from sim.motion import simulate_motion
from sim.run import simulate
from sim.shaft import ConstantSpeed

RIG = load_material_rig("fluorocarbon-thesis")


def best_of(n: int, call: Callable[[], object]) -> float:
    call()  # compiled and loaded
    times = []
    for _ in range(n):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def motion(rig: Rig) -> float:
    effects = activated(rig.effects, EFFECTS)
    return best_of(5, lambda: simulate_motion(
        rig, ConstantSpeed(1.0), interference=0.279e-3, support_stiffness=3745.0, seconds=1.0,
        rate=30e3, effects=effects,
    ))  # fmt: skip


def main() -> None:
    baseline = motion(RIG)
    rows = {f"law {name}": replace(RIG, friction=LawSpec(name)) for name in LAWS}
    for name, effect in EFFECTS.items():
        if effect.contact is not None or effect.drive is not None:
            rows[f"true stick and {name}"] = replace(RIG, effects=(LawSpec(name),))
    seconds = {name: motion(rig) for name, rig in rows.items()}
    for material in ("fluorocarbon-thesis", "fluorocarbon"):
        rig = load_material_rig(material)
        seconds[f"{material}, recorded"] = best_of(3, lambda rig=rig: simulate(rig, 1.0))
    for name, took in seconds.items():
        print(f"{name:42}{1e3 * took:10.2f} ms {took / baseline:8.1f}")


if __name__ == "__main__":
    main()
