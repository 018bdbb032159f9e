"""What the contact solver carries on from step to step and from block to block."""

from __future__ import annotations

__all__ = [
    "ANGLE", "DONE", "FAR", "FIRST", "FRESH", "MODE", "NEXT_MODE", "N_CARRIED", "N_MOTION",
    "N_ROWS", "N_STAGES", "SHORTEST_STEP", "SLIDE", "STEP_END", "STEP_OF_SLIP", "STEP_OF_STICK",
    "STEP_START", "STICK_LENGTH", "STICK_START",
]  # fmt: skip

SHORTEST_STEP = 1e-7
"""Average over a run, below which it is given up [s]."""

MODE = 0
"""+1 or -1 while it slides, 0 in stick and with a law."""
SLIDE = 1
"""Sign of the sliding speed with a law, 0 while that is not known."""
STICK_START = 2
"""When the last stick began [s]."""
STICK_LENGTH = 3
"""Of the last stick [s]."""
ANGLE = 4
"""Of the drive at the next sample [rad]."""
FIRST = 5
"""The next sample."""
STEP_START = 6
"""Of the last step, since the next sample [s]."""
STEP_END = 7
"""[s]"""
STEP_OF_STICK = 8
"""The next step as the error allows it, in stick [s]."""
STEP_OF_SLIP = 9
"""[s]"""
FRESH = 10
"""Whether the rates at the end of the last step are to be computed anew."""
DONE = 11
"""Steps since the start; negative where they became too many."""
FAR = 12
"""From the end of stick or slip, at the end of the last step."""
NEXT_MODE = 13
"""After the last step."""
N_CARRIED = 14

N_STAGES = 7
"""Of a step of `sim.solvers.dormand_prince`."""

N_MOTION = 6
"""First of the variables, whose errors have scales of their own."""

# Rows of an array of states: the rates at the stages of the last step, its start and its end, and
# room for the state of a stage, its rates, and the coefficients between start and end.
N_ROWS = N_STAGES + 8
