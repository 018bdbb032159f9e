# ruff: noqa: T201
"""How fast torque becomes sound, beside filtering mode by mode and beside real time.

Run by hand: ``OPENBLAS_NUM_THREADS=1 python tests/benchmarks/radiation.py``. One second of torque
at 48 kHz through the shipped bench and through its plate with free edges, all modes of the plate to
16 kHz; processor seconds on one core, best of several. `scipy.signal.lfilter` is given its best
case: one section of second order a mode and a weighted sum, without the sound's travel, which costs
it another filter of a hundred taps a mode.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from models.bench import HIGHEST_PLATE_FREQUENCY
from models.radiation.impulse_responses import radiate
from models.radiation.rig_response import impulse_responses
from models.radiation.sound_power import third_octave_power
from models.rig_file import load_material_rig
from models.structure.modal import acceleration_section
from models.structure.plate import plate_modes
from models.transfer_functions.filtering import convolve

if TYPE_CHECKING:
    from collections.abc import Callable

    from models.structure.plate import PlateModes

RATE = 48e3
TORQUE = np.random.default_rng(1).normal(size=round(RATE))


def best_of(n: int, call: Callable[[], object]) -> float:
    times = []
    for _ in range(n):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def mode_by_mode(modes: PlateModes, taps: int) -> np.ndarray:
    """Sum of all modes' accelerations, each heard through `taps` taps, or weighted if 0."""
    total = np.zeros(TORQUE.size)
    weights = np.ones(max(taps, 1)) / max(taps, 1)
    for frequency, ratio in zip(modes.frequencies, modes.damping_ratios, strict=True):
        moved = lfilter(*acceleration_section(frequency, ratio, RATE), TORQUE)
        total += lfilter(weights, [1.0], moved) if taps else weights[0] * moved
    return total


def main() -> None:
    for edges in ("simply_supported", "free"):
        shipped = load_material_rig("fluorocarbon")
        rig = replace(shipped, plate=replace(shipped.plate, edges=edges))
        start = time.process_time()
        modes = plate_modes(rig.plate, HIGHEST_PLATE_FREQUENCY)
        solved = time.process_time() - start
        start = time.process_time()
        chain = impulse_responses(rig, 2.79e-4, 2214.0, RATE)
        built = time.process_time() - start
        path = chain.torque_to_pressure
        print(f"\nplate {edges}, {modes.frequencies.size} modes")
        print(f"  once: modes {1e3 * solved:.0f} ms, responses of the rig {1e3 * built:.0f} ms")
        sections = best_of(3, lambda modes=modes: mode_by_mode(modes, 0))
        travel = best_of(1, lambda modes=modes: mode_by_mode(modes, 128))
        afresh = best_of(20, lambda path=path: convolve(TORQUE, path))
        radiate(chain, TORQUE)
        both = best_of(20, lambda chain=chain: radiate(chain, TORQUE))
        print(f"  {'1 s of sound':44}{'ms':>8}{'x lfilter':>11}{'x real time':>13}")
        for name, seconds in (
            ("lfilter mode by mode", sections),
            ("lfilter mode by mode, with travel", travel),
            ("torque to pressure, spectrum made afresh", afresh),
            ("torque to pressure, spectrum kept", both / 2),
            ("torque to pressure and acceleration, kept", both),
        ):
            print(f"  {name:44}{1e3 * seconds:8.2f}{sections / seconds:11.1f}{1 / seconds:13.0f}")
        drives = modes.shape([0.17], [0.12]).T
        power = best_of(1, lambda modes=modes, drives=drives: third_octave_power(modes, drives))
        print(f"  sound power in third octaves, 50 Hz to 10 kHz: {power:.2f} s")


if __name__ == "__main__":
    main()
