"""How fast the rig is simulated, beside what a user would take instead.

Run by hand: ``python tests/benchmarks/simulator.py``. One second of stick-slip at 30 kHz, the
thesis's rig at 1 rad/s; seconds are the best of five.
"""

import math
import time

import numpy as np
from scipy.integrate import solve_ivp

from models.rig_file import load_material_rig
from sim.bushing import lumped_bushing
from sim.run import simulate
from sim.stick_slip import solve_stick_slip

SECONDS = 1.0
RATE = 30e3


def best_of(n, call):
    times = []
    for _ in range(n):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)


def exact():
    system = lumped_bushing(load_material_rig("fluorocarbon-thesis"), 0.279e-3, 3745.0).packed()
    shaft = np.full(round(SECONDS * RATE), 1.0)
    return lambda: solve_stick_slip(system, 10.7, 8.0, shaft, 1.0 / RATE)


def general_solver():
    """Solve with solve_ivp, RK45, rtol 1e-6; the friction smoothed by tanh, as is often done."""
    j_e, j_c, k_e, k_b, c_e, c_b = lumped_bushing(
        load_material_rig("fluorocarbon-thesis"), 0.279e-3, 3745.0
    ).packed()

    def rates(_, x):
        v = 1.0 - x[1]
        torque = (8.0 + 2.7 * math.exp(-((v / 0.1) ** 2))) * math.tanh(v / 0.01)
        elastomer = k_e * (x[0] - x[2]) + c_e * (x[1] - x[3])
        return [
            x[1],
            (torque - elastomer) / j_e,
            x[3],
            (elastomer - k_b * x[2] - c_b * x[3]) / j_c,
        ]

    grid = np.arange(round(SECONDS * RATE)) / RATE
    return lambda: solve_ivp(rates, (0.0, grid[-1]), np.zeros(4), t_eval=grid, rtol=1e-6)


def whole_chain(material):
    rig = load_material_rig(material)
    return lambda: simulate(rig, 1.0, seconds=SECONDS, settling=0.0)


def main():
    cases = {
        "exact between events": (exact(), 5),
        "solve_ivp RK45, rtol 1e-6": (general_solver(), 1),
        "motion, sound and acquisition, fluorocarbon-thesis": (
            whole_chain("fluorocarbon-thesis"),
            5,
        ),
        "motion, sound and acquisition, fluorocarbon": (whole_chain("fluorocarbon"), 5),
    }
    for name, (call, n) in cases.items():
        call()
        print(f"{name:55s} {best_of(n, call):9.4f} s")  # noqa: T201


if __name__ == "__main__":
    main()
