# ruff: noqa: T201
"""How fast the rig is simulated, beside what a user would take instead.

Run by hand: ``python tests/benchmarks/simulator.py``. One second of stick-slip, the thesis's rig at
3745 Nm/rad and 1 rad/s, output at 30 kHz; processor seconds, best of several, everything in one
process. `solve_ivp` solves the same equations, stick and slip in turn with event location.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import LAWS
from sim.motion import simulate_motion
from sim.rig_effects import constant_version
from sim.run import simulate
from sim.shaft import ConstantSpeed
from tests.helpers.contacts import solve_stick_slip

if TYPE_CHECKING:
    from collections.abc import Callable

    from models.rig import Rig

RATE = 30e3
N = round(RATE)
RIG = load_material_rig("fluorocarbon-thesis")
SYSTEM = lumped_bushing(RIG, 0.279e-3, 3745.0).packed()
CRITICAL, KINETIC, SPEED = 10.7, 8.0, 1.0
CONDITIONS = ((0.279e-3, 3745.0, 1.0), (0.279e-3, 3745.0, 5.0), (0.381e-3, 2214.0, 5.0))
"""Interference [m], stiffness of the support [Nm/rad], speed [rad/s]."""


def best_of(n: int, call: Callable[[], object]) -> float:
    times = []
    for _ in range(n):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def exact(speed: float = SPEED) -> int:
    _, _, events = solve_stick_slip(SYSTEM, CRITICAL, KINETIC, np.full(N, speed), 1.0 / RATE)
    return len(events)


def general_solver(method: str, tolerance: float) -> int:
    """Stick and slip in turn; returns the number of events."""
    j_e, j_c, k_e, k_b, c_e, c_b = SYSTEM.tolist()
    grid = np.arange(N) / RATE

    def clamp(x, torque):
        return (torque - k_b * x[2] - c_b * x[3]) / j_c

    def stick(t, x):
        return [SPEED, 0.0, x[3], clamp(x, k_e * (x[0] - x[2]) + c_e * (SPEED - x[3]))]

    def slip(t, x):
        torque = k_e * (x[0] - x[2]) + c_e * (x[1] - x[3])
        return [x[1], (KINETIC - torque) / j_e, x[3], clamp(x, torque)]

    def breaks(t, x):
        return CRITICAL - k_e * (x[0] - x[2]) - c_e * (SPEED - x[3])

    def catches(t, x):
        return SPEED - x[1] if t > start + 1e-7 else 1.0

    breaks.terminal = catches.terminal = True
    start, x, stuck, events = 0.0, [0.0, SPEED, 0.0, 0.0], True, 0
    while start < grid[-1]:
        rates, end = (stick, breaks) if stuck else (slip, catches)
        solution = solve_ivp(
            rates, (start, grid[-1]), x, method, t_eval=grid[grid >= start], events=end,
            rtol=tolerance, atol=1e-3 * tolerance,
        )  # fmt: skip
        if solution.status != 1:
            break
        start, x = solution.t_events[0][0], solution.y_events[0][0]
        x[1], stuck, events = SPEED, not stuck, events + 1
    return events


def motion(
    rig: Rig, interference: float = 0.279e-3, support: float = 3745.0, speed: float = SPEED
) -> Callable[[], object]:
    effects = activated(rig.effects, EFFECTS)
    return lambda: simulate_motion(
        rig, ConstantSpeed(speed), interference=interference, support_stiffness=support,
        seconds=1.0, rate=RATE, effects=effects,
    )  # fmt: skip


def calibrated() -> None:
    """Print what the calibrated material costs over constant torques, by condition."""
    irregular = load_material_rig("fluorocarbon")
    rigs = (RIG, constant_version(irregular), irregular)
    print(f"\n{'calibrated, motion':34}{'constant torques':>18}{'alike':>16}{'irregular':>16}")
    for condition in CONDITIONS:
        times = []
        for rig in rigs:
            call = motion(rig, *condition)
            call()
            times.append(best_of(7, call))
        interference, support, speed = condition
        name = f"{1e3 * interference:.3f} mm, {support:g} Nm/rad, {speed:g} rad/s"
        ratios = "".join(f"{1e3 * t:8.2f}{t / times[0]:7.1f}x" for t in times[1:])
        print(f"{name:34}{1e3 * times[0]:18.2f}{ratios}")


def main() -> None:
    baseline = best_of(15, exact)
    print(f"baseline: {1e3 * baseline:.2f} ms, {1e9 * baseline / N:.1f} ns a sample")
    for speed in (5.0, 12.0):
        seconds = best_of(15, lambda speed=speed: exact(speed))
        print(f"  at {speed:g} rad/s, {exact(speed)} events: {1e9 * seconds / N:.1f} ns a sample")
    print(f"\n{'solver':34}{'ms':>10}{'x baseline':>12}{'events':>8}")
    for method, tolerance in (("RK45", 1e-6), ("RK45", 1e-9), ("DOP853", 1e-9)):
        start = time.process_time()
        events = general_solver(method, tolerance)
        seconds = time.process_time() - start
        name = f"solve_ivp {method}, rtol {tolerance:g}"
        print(f"{name:34}{1e3 * seconds:10.0f}{seconds / baseline:12.0f}{events:8d}")
    print(f"{'exact between events':34}{1e3 * baseline:10.2f}{1:12.0f}{exact():8d}")
    print(f"\n{'true stick and one effect':34}{'ms':>10}{'x baseline':>12}")
    for name, effect in EFFECTS.items():
        if effect.contact is not None or effect.drive is not None:
            table_row(name, replace(RIG, effects=(LawSpec(name, {}),)), baseline)
    print(f"\n{'friction law':34}{'ms':>10}{'x baseline':>12}")
    for name in LAWS:
        table_row(name, replace(RIG, friction=LawSpec(name, {})), baseline)
    calibrated()
    print(f"\n{'motion, sound and acquisition':34}{'ms':>10}{'x baseline':>12}")
    for material in ("fluorocarbon-thesis", "fluorocarbon"):
        rig = load_material_rig(material)
        simulate(rig, SPEED, seconds=0.1)
        seconds = best_of(3, lambda rig=rig: simulate(rig, SPEED, seconds=1.0, settling=0.0))
        print(f"{material:34}{1e3 * seconds:10.2f}{seconds / baseline:12.1f}")


def table_row(name: str, rig: Rig, baseline: float) -> None:
    call = motion(rig)
    call()
    seconds = best_of(5, call)
    print(f"{name:34}{1e3 * seconds:10.2f}{seconds / baseline:12.1f}")


if __name__ == "__main__":
    exact()
    main()
