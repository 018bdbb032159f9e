"""Measured data with a known missing effect: ``python -m tests.helpers.real_effects``.

The data are no part of the project; the folder is named by BUSHING_NOISE_REAL_DATA.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from tests.studies.oscillator_terms import DrivenRecord, OscillatorDiagnosis, diagnose_oscillator
from tests.studies.pulled_slider import SliderComparison, compare_slider, read_pulled_record

FOLDER = os.environ.get("BUSHING_NOISE_REAL_DATA")
ABSENT = "BUSHING_NOISE_REAL_DATA names no folder of real recordings"

# Wigren & Schoukens, Three free data sets for development and benchmarking in nonlinear system
# identification, ECC 2013: a growing noise, ten realisations of a multisine with rests between
# them, and the quiet start of a further growing noise.
RATE = 1e7 / 2**14
"""[Hz]"""
ARROW = (500, 40_400)
STARTS = (40_767, 49_459, 58_153, 66_845, 75_535, 84_226, 92_921, 101_610, 110_305, 118_995)
LENGTH = 8_430
QUIET = (127_900, 131_000)


def silverbox(folder: Path) -> OscillatorDiagnosis:
    """Four of the ten realisations are fitted to, six and the arrow are held out."""
    series = np.genfromtxt(
        folder / "silverbox" / "SNLS80mV.csv", delimiter=",", skip_header=1, usecols=(0, 1)
    )
    drive, response = np.ascontiguousarray(series.T)
    realisations = [(start, start + LENGTH) for start in STARTS]
    held_out = [span for i, span in enumerate(realisations) if i % 3]
    return diagnose_oscillator(
        DrivenRecord(drive, response, RATE),
        [QUIET],
        realisations[::3],
        {"held out": held_out, "arrow": [ARROW]},
        np.random.default_rng(0),
    )


def paper_on_paper(folder: Path) -> SliderComparison:
    """Compare all stick-slip records of the folder with a simulated slider."""
    files = sorted((folder / "stickslip").glob("*.mat"))
    return compare_slider([read_pulled_record(path) for path in files])


def main() -> None:
    """Print both tables."""
    if not FOLDER:
        sys.exit(ABSENT)
    found = silverbox(Path(FOLDER))
    first = found.first
    sys.stdout.write(f"Silverbox, {found.seconds:.0f} s\n{found.table('mV', 1e3)}\n")
    for name in found.gap_before:
        for label, share in (("closed", first.closed), ("by term", first.closed_by_effect)):
            gap = share[name]
            if gap is not None:
                sys.stdout.write(
                    f"{name}: {label} {gap.value:.4f}, 90 % {gap.low:.4f} to {gap.high:.4f}\n"
                )
    slid = paper_on_paper(Path(FOLDER))
    sys.stdout.write(f"\nPaper on paper, {slid.seconds:.0f} s\n{slid.table()}\n")


if __name__ == "__main__":
    main()
