"""``python -m tests.studies.rig_measures``: how far a material is from the rig, in one page.

Counted by one definition each, so that a change of the model can be judged by it: critical speeds
(`sim.analysis.critical_speeds`), rise of the slip rate (`sim.analysis.slips`), noises of 5.2.3 by
physics and by the classifier, how irregular the creak is, and what a run costs. Critical speeds
with a cell left out take searches: ``python -m noise.training.calibrate --leave-out N``. Rows of
the thesis that are missed stand in the head of ``tests/thesis.md``.

The creak's measures, of two seconds of sound at the microphone without room and noise, the loudest
second: *jitter*, the coefficient of variation of the intervals between pulses above 2 kHz;
*harmonicity*, the highest autocorrelation at a lag of 1/1500 to 1/20 s; *flatness*, the geometric
over the arithmetic mean of the autospectrum from 20 Hz to 14.25 kHz.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import replace
from itertools import pairwise, product
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import butter, find_peaks, hilbert, sosfiltfilt

from features.kernels.periodicity import strongest_period
from features.kernels.spectra import autospectrum, spectral_shape
from models.rig_files.rig_file import load_material_rig
from noise.classifier import load_classifier
from noise.labels.segments import file_label, label_recording
from noise.noise_definition import label_by_physics
from noise.training.calibrate.report import measured_speeds, speeds_page
from noise.training.calibrate.thesis_table import CELLS, THIN_CELLS
from sim.analysis.slips import motion_slips
from sim.constant_version import constant_version
from sim.motion import simulate_motion
from sim.run import simulate
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from sim.run import Run

__all__ = ["NOISE_CELLS", "creak_measures", "main", "slip_rates"]

LONG, SHORT = 2214.0, 3745.0
TIGHT = 0.381e-3
SPEEDS = (1.0, 2.5, 5.0, 7.5, 10.0)

_PULSES_FROM, _PULSES_TO = 2_000.0, 500.0
"""Where pulses sound, and up to where their envelope is followed [Hz]."""

_LEAST_PULSE = 0.25
"""How far a pulse stands out, re the 99th percentile of the envelope [-]."""

NOISE_CELLS = (
    *(("fluorocarbon", TIGHT, k, v, "creak") for k in (LONG, SHORT) for v in SPEEDS),
    ("fluorocarbon", 0.279e-3, LONG, 5.0, "squawk"),
    ("fluorocarbon", 0.279e-3, LONG, 7.5, "squawk"),
    ("fluorocarbon", 0.279e-3, SHORT, 5.0, "squawk"),
    ("fluorocarbon", 0.178e-3, LONG, 1.0, "squawk"),
    ("fluorocarbon", 0.178e-3, LONG, 2.5, "squawk"),
    ("fluorocarbon", 0.279e-3, SHORT, 10.0, "squeal"),
    ("fluorocarbon", 0.279e-3, LONG, 10.0, "none"),
    *(("fluorocarbon", 0.178e-3, LONG, v, "none") for v in SPEEDS[2:]),
    *(("PDMS", fit, LONG, v, "none") for fit in (0.254e-3, TIGHT) for v in (0.25, 5.0, 17.0)),
)
"""Material, interference [m], support stiffness [Nm/rad], speed [rad/s] and noise (5.2.3)."""


def slip_rates(rig: Rig) -> list[float]:
    """Slips a second of the constant version at `SPEEDS`, 0.381 mm and 2214 Nm/rad [Hz]."""
    rig, rates = constant_version(rig), []
    for speed in SPEEDS:
        motion = simulate_motion(
            rig, ConstantSpeed(speed), interference=TIGHT, support_stiffness=LONG, seconds=2.5,
            rate=30e3,
        )  # fmt: skip
        rates.append(motion_slips(motion.since(15_000)).rate)
    return rates


def creak_measures(pressure: NDArray[np.float64], rate: float) -> tuple[float, float, float]:
    """Jitter [-], harmonicity [-] and flatness [dB] of the loudest second of a creak."""
    n, step = round(rate), round(0.25 * rate)
    starts = range(0, max(pressure.size - n, 0) + 1, step)
    first = max(starts, key=lambda start: float(np.sum(pressure[start : start + n] ** 2)))
    sound = pressure[first : first + n] - pressure[first : first + n].mean()
    period = strongest_period(sound, rate, lowest=20.0, highest=1500.0, whiten=False)
    shape = spectral_shape(autospectrum(sound, rate), low=20.0, high=14_250.0)
    return _jitter(sound, rate), period.strength, 10.0 * math.log10(shape.flatness)


def _jitter(sound: NDArray[np.float64], rate: float) -> float:
    """Coefficient of variation of the intervals between pulses, up to some 500 a second.

    `features.kernels.slip_pulses` smooths over longer, and loses those above 150 a second.
    """
    high = sosfiltfilt(butter(4, _PULSES_FROM, "highpass", fs=rate, output="sos"), sound)
    low = butter(2, _PULSES_TO, fs=rate, output="sos")
    envelope = sosfiltfilt(low, np.abs(hilbert(high)))
    least = _LEAST_PULSE * float(np.quantile(envelope, 0.99))
    intervals = np.diff(find_peaks(envelope, prominence=least)[0])
    return float(intervals.std() / intervals.mean()) if intervals.size > 1 else math.nan


def _run(material: str, interference: float, support: float, speed: float, **about: float) -> Run:
    return simulate(
        load_material_rig(material), speed, interference=interference, support_stiffness=support,
        **about,
    )  # fmt: skip


def _noises(material: str) -> Iterator[str]:
    heard = [0, 0, 0]
    for of, interference, support, speed, noise in NOISE_CELLS:
        of = material if of == "fluorocarbon" else of
        run = _run(of, interference, support, speed)
        row = run.recording.channel_names.index("pressure")
        alone = replace(
            run.recording,
            samples=run.recording.samples[[row]],
            channels=(run.recording.channels[row],),
        )
        labels = [
            label_by_physics(run),
            *(
                file_label(label_recording(r, load_classifier())).label
                for r in (run.recording, alone)
            ),
        ]
        for i, label in enumerate(labels):
            heard[i] += label == noise
        if set(labels) != {noise}:
            where = f"{of}, {1e3 * interference:g} mm, {support:g} Nm/rad, {speed:g} rad/s"
            yield f"  {where}: {noise}, but {', '.join(labels)}"
    yield "  as named, by physics, from all channels, from pressure alone: " + (
        ", ".join(f"{count} of {len(NOISE_CELLS)}" for count in heard)
    )


def _creaks(material: str) -> Iterator[str]:
    for support in (LONG, SHORT):
        for speed in SPEEDS[:3]:
            run = _run(material, TIGHT, support, speed, seconds=2.0)
            jitter, harmonicity, flatness = creak_measures(run.pressure, run.motion.rate)
            yield (
                f"  {support:g} Nm/rad, {speed:g} rad/s: jitter {jitter:.2f}, harmonicity "
                f"{harmonicity:.2f}, flatness {flatness:.0f} dB, {label_by_physics(run)}"
            )


def _cost(material: str) -> float:
    """Processor time of motions of one second over that with constant torques."""
    seconds = []
    for of in ("fluorocarbon-thesis", material):
        rig, total = load_material_rig(of), 0.0
        for fit, support, speed in product((0.178e-3, 0.279e-3, TIGHT), (LONG, SHORT), SPEEDS[::2]):
            best = math.inf
            for _ in range(3):
                start = time.process_time()
                simulate_motion(
                    rig, ConstantSpeed(speed), interference=fit, support_stiffness=support,
                    seconds=1.0, rate=30e3,
                )  # fmt: skip
                best = min(best, time.process_time() - start)
            total += best
        seconds.append(total)
    return seconds[1] / seconds[0]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the page."""
    parser = argparse.ArgumentParser(prog="python -m tests.studies.rig_measures")
    parser.add_argument("--material", default="fluorocarbon")
    material = parser.parse_args(arguments).material
    rig = load_material_rig(material)
    speeds = measured_speeds(rig)
    rates = slip_rates(rig)
    lines = [
        speeds_page("Fitted, at 0.279 mm", {cell: speeds[cell] for cell in CELLS}),
        speeds_page("V_crit2 at 0.178 mm", {cell: speeds[cell] for cell in THIN_CELLS}),
        "Slips a second, 0.381 mm, 2214 Nm/rad; measured +10 to 25 Hz for each 2.5 rad/s",
        "  " + ", ".join(f"{v:g} rad/s {f:.0f} Hz" for v, f in zip(SPEEDS, rates, strict=True)),
        "  rises " + ", ".join(f"{b - a:+.0f} Hz" for a, b in pairwise(rates)),
        "Noises of 5.2.3",
        *_noises(material),
        "Creak",
        *_creaks(material),
        f"Cost of the motion over that of constant torques: {_cost(material):.0f} times",
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
