# ruff: noqa: T201
"""How fast a design is screened, beside a plain loop over scipy's solver.

Run by hand: ``python tests/benchmarks/screening.py [SAMPLE]``. A map of 10,000 conditions of the
calibrated fluorocarbon, then so many of them (default 6) one after the other by `solve_ivp`: the
same equations for the same time, no sound and no labels, as one would write it in an afternoon.
Processor seconds stand beside the clock's, since the machine may have other work.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

from models.rig_file import load_material_rig
from noise.screening.axis_values import spread
from noise.screening.design import Use
from noise.screening.point import evaluate_point
from noise.screening.screen import screen
from noise.screening.vibration import Condition
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import LEAST_OSCILLATION, friction_regime
from sim.bushing import lumped_bushing
from sim.friction import friction_law
from sim.parameters import resolve

RIG = load_material_rig("fluorocarbon")
SECONDS = 1.2
GRID = Use(
    speed=spread(0.25, 13.0, 101),
    interference=spread(0.178e-3, 0.381e-3, 33),
    support_stiffness=(2214.0, 3745.0, math.inf),
)


def by_solve_ivp(speed: float, interference: float, support: float) -> float:
    """Share that the torque's standard deviation has in its mean, in the last half."""
    j_e, j_c, k_e, k_b, c_e, c_b = lumped_bushing(RIG, interference, support).packed().tolist()
    fit = RIG.fit(interference)
    law = resolve("law", friction_law(RIG.friction.name).parameters, RIG.friction.parameters)
    kinetic, drop = fit.kinetic_torque, fit.critical_torque - fit.kinetic_torque
    stiffness = law["contact_stiffness_per_torque"] * kinetic
    damping = law["contact_damping_per_torque"] * kinetic
    fixed = k_b < 0.0

    def rates(_, x):
        theta1, omega1, theta2, omega2, shear, age = x
        v = speed - omega1
        strength = kinetic + drop * age / (age + law["ageing_time"])
        fading = (abs(v) / law["weakening_speed"]) ** law["weakening_exponent"]
        strength += law["weakening_share"] * kinetic * math.exp(-fading)
        shear_rate = v - stiffness * abs(v) * shear / strength
        friction = stiffness * shear + damping * shear_rate
        elastomer = k_e * (theta1 - theta2) + c_e * (omega1 - omega2)
        clamp = 0.0 if fixed else (elastomer - k_b * theta2 - c_b * omega2) / j_c
        ageing = 1.0 - abs(v) * age / law["renewal_angle"]
        return [omega1, (friction - elastomer) / j_e, omega2, clamp, shear_rate, ageing]

    grid = np.arange(round(0.5 * SECONDS * 30e3), round(SECONDS * 30e3)) / 30e3
    start = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    run = solve_ivp(rates, (0.0, SECONDS), start, t_eval=grid, rtol=1e-6, atol=1e-9)
    torque = k_e * (run.y[0] - run.y[2]) + c_e * (run.y[1] - run.y[3])
    return float(np.std(torque) / np.mean(torque))


def main() -> None:
    sample = int(sys.argv[1]) if len(sys.argv) > 1 else 6
    screen(["fluorocarbon"], Use(speed=(5.0,), interference=(0.279e-3,)))  # compiled and loaded
    for _ in range(2):
        used = time.process_time()
        found = screen(["fluorocarbon"], GRID)
        used = time.process_time() - used
        [one] = found.maps
        counts = {how: one.count(how) for how in ("simulated", "refined")}
        print(f"{one.label.size} conditions: {found.seconds:.1f} s, {used:.1f} s of processor time")
        print(f"  {counts}, {found.maps[0].open} beside a boundary as their nearest neighbour")
    rng = np.random.default_rng(1)
    looped, own, alike = 0.0, 0.0, 0
    for _ in range(sample):
        speed = float(rng.choice(GRID.speed))
        where = float(rng.choice(GRID.interference)), float(rng.choice(GRID.support_stiffness))
        start = time.process_time()
        vibrates = by_solve_ivp(speed, *where) > LEAST_OSCILLATION
        looped += time.process_time() - start
        start = time.process_time()
        evaluate_point(RIG, Condition(speed, *where))
        own += time.process_time() - start
        regime = friction_regime(motion_from_rest(RIG, speed, *where, seconds=SECONDS))
        alike += vibrates == (regime != "steady sliding")
    print(f"solve_ivp, {sample} conditions: {looped / sample:.2f} s each, {alike} regimes alike")
    print(f"  a point with its sound and label: {own / sample:.3f} s")
    whole = looped / sample * found.maps[0].label.size
    print(
        f"  10,000 of them: {whole:.0f} s of processor time, {whole / used:.0f} times the screen's"
    )


if __name__ == "__main__":
    main()
