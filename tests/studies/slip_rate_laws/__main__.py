"""``python -m tests.studies.slip_rate_laws``: the table of `slip_rate_laws.md`, from its fits.

``fits.json`` holds the points that the searches found; every number is simulated again, half a
minute a fit, and read off its runs as `noise.training.calibrate` reads those of the shipped rig.
"""

from __future__ import annotations

import json
import math
import sys
from itertools import pairwise
from pathlib import Path

from models.condition import FIXED
from noise.identification.quantities import QUANTITIES
from noise.identification.settled_run import SettledRun
from noise.thesis.runs import LONG, SHORT
from noise.training.calibrate.thesis_table import CELLS, THIN_CELLS
from sim.analysis.slips import find_slips
from tests.studies.slip_rate_laws.laws import INVERSE_J_E, K_E, simulate
from tests.studies.slip_rate_laws.point import START, UNKNOWNS, constants, unknowns

__all__ = ["FITS", "LEFT_OUT", "left_out_speed", "main", "row", "run"]

FITS = Path(__file__).with_name("fits.json")
SPEEDS = 2.5, 5.0, 7.5, 10.0
SWEEP = tuple(0.5 * i for i in range(5, 21))
"""No search sees the speeds between [rad/s]."""
LEAST_RISE, MOST_RISE = 10.0, 25.0
"""For each 2.5 rad/s at 0.381 mm, 2214 Nm/rad [Hz] (5.2.1)."""

LEFT_OUT = next(c for c in CELLS if c.item == "v_crit1" and c.support_stiffness == SHORT)
"""With the speed of 5 rad/s, what the second search of each law does not see."""

_HEAD = (
    "law", "unknowns", "fitted to", "rises [Hz]", "5 rad/s", "largest fall [Hz]", "V_crit",
    "V_crit1, 3745", "V_crit2, 0.178 mm", "sudden at 13", "mean [Nm]", "1 rad/s [Hz]",
    "0.279 mm [Hz]",
)  # fmt: skip


def run(law, point, millimetres, support, speed, seconds=1.2) -> SettledRun:
    """Run a law from rest at a point and keep the last half."""
    c = constants(law, point, millimetres, support)
    torque, rate = simulate(law, speed, c, unknowns(law, point), seconds)
    last = torque[torque.size // 2 :]
    own = 2.0 * math.pi / math.sqrt(c[K_E] * c[INVERSE_J_E])
    return SettledRun(find_slips(last / c[K_E], speed, rate, own_period=own), last, rate)


def left_out_speed(before, found, after) -> float:
    """Error of the rate at 5 rad/s: how far outside what its two rises allow [-].

    It may lie 10 to 25 Hz above the rate at 2.5 and as much below that at 7.5 rad/s; where these
    are too near or too far for both, anywhere between the two bounds.
    """
    low = max(before + LEAST_RISE, after - MOST_RISE)
    low, high = sorted((low, min(before + MOST_RISE, after - LEAST_RISE)))
    return max(low - found, found - high, 0.0) / found


def _critical_error(law, point, cell) -> float:
    """Logarithm of a critical speed over what was measured."""
    at = round(1e3 * cell.interference, 3), cell.support_stiffness
    runs = [run(law, point, *at, speed, 0.8) for speed in cell.speeds]
    return math.log(QUANTITIES[cell.item].found(None, cell, runs) / cell.value)


def row(law, fitted_to, point) -> list[str]:
    """Return the row of a fit, in the order of the head."""
    sweep = {speed: run(law, point, 0.381, LONG, speed).slips.rate for speed in SWEEP}
    fall = max(before - after for before, after in pairwise(sweep.values()))
    rates = [sweep[speed] for speed in SPEEDS]
    seen = [c for c in CELLS if c is not LEFT_OUT or fitted_to != "without"]
    squares = [_critical_error(law, point, cell) ** 2 for cell in seen]
    thin = [_critical_error(law, point, cell) for cell in THIN_CELLS]
    sticking = [run(law, point, 0.381, k, 13.0).slips.sudden_share for k in (LONG, SHORT, FIXED)]
    low = [run(law, point, 0.279, LONG, speed).repetition_rate for speed in (1.0, 2.5)]
    return [
        law, str(len(START) + len(UNKNOWNS[law])), fitted_to,
        ", ".join(f"{after - before:+.1f}" for before, after in pairwise(rates)),
        f"{left_out_speed(*rates[:3]):.1%}", f"{fall:.0f}",
        f"{math.sqrt(sum(squares) / len(squares)):.3f}",
        f"{_critical_error(law, point, LEFT_OUT):+.2f}",
        ", ".join(f"{error:+.2f}" for error in thin),
        ", ".join(f"{share:.2f}" for share in sticking),
        f"{run(law, point, 0.381, LONG, 5.0).mean_torque:.1f}",
        f"{run(law, point, 0.381, LONG, 1.0).slips.rate:.0f}",
        ", ".join(f"{rate:.0f}" for rate in low),
    ]  # fmt: skip


def main() -> None:
    """Print the table."""
    rows = [_HEAD, ["---"] * len(_HEAD)]
    sys.stdout.writelines(f"| {' | '.join(cells)} |\n" for cells in rows)
    for fit in json.loads(FITS.read_text(encoding="utf-8")):
        sys.stdout.write(f"| {' | '.join(row(**fit))} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
