"""``bushing-noise simulate``: one operating condition into a recording."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from noise.commands import options as opt
from noise.commands.operating import is_long, run_arguments
from noise.commands.targets import check_target
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from models.recording import Recording

__all__ = ["configure", "run"]

_DEFAULT_RATE = 30000


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Simulate one run of the rig and record torque [N m], acceleration [m/s^2], pressure [Pa] "
        "and angle [rad]. With --out the names of the files are printed, without it a summary as "
        "one line of JSON: conditions, mean of the torque and its rms about the mean, peak and "
        "level (dB re 20 uPa) of the sound pressure."
    )
    parser.epilog = (
        "example: bushing-noise simulate --speed 5 --interference 0.279 --out run07; effects: "
        f"{', '.join(EFFECTS)}"
    )
    opt.add_condition(parser)
    parser.add_argument(
        "--rate",
        type=_rate,
        default=_DEFAULT_RATE,
        metavar="HZ",
        help=f"sampling rate in Hz, a whole number from 1000 to 400000 (default: {_DEFAULT_RATE})",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="RUN",
        help="write RUN.wav (32-bit float, in the units above) and RUN.json",
    )
    opt.add_seed(parser, "seed of the sensors' noise")


def run(options: Namespace) -> int:
    """Simulate; write the recording, or print its summary."""
    if options.out is not None:
        check_target(options.out)
    arguments = run_arguments(options, options.rate)
    if options.out is not None and is_long(arguments):
        from noise.long_run import simulate_to_file

        path = simulate_to_file(options.out, **arguments)
    else:
        from sim.run import simulate

        recording = simulate(**arguments).recording
        if options.out is None:
            print(json.dumps(_summary(recording)))
            return 0
        from noise.recordings import write_recording

        path = write_recording(options.out, recording)
    print(path)
    print(path.with_suffix(".json"))
    return 0


def _rate(text: str) -> int:
    value = opt.number(least=1000.0, most=400e3)(text)
    if not value.is_integer():
        raise argparse.ArgumentTypeError(f"is {text!r}, expected a whole number of Hz")
    return int(value)


def _summary(recording: Recording) -> dict[str, object]:
    from models.recording import REFERENCE_PRESSURE
    from noise.recordings.sidecar import sidecar_text

    torque, pressure = recording["torque"], recording["pressure"]
    rms = float(pressure.std())
    level = 20.0 * math.log10(rms / REFERENCE_PRESSURE) if rms > 0.0 else None
    return {
        "conditions": json.loads(sidecar_text(recording))["conditions"],
        "seconds": recording.duration,
        "rate_hz": recording.rate,
        "torque_mean_Nm": _short(float(torque.mean())),
        "torque_rms_about_mean_Nm": _short(float(torque.std())),
        "peak_pressure_Pa": _short(float(abs(pressure).max())),
        "level_db": None if level is None else round(level, 2),
    }


def _short(value: float) -> float:
    return float(f"{value:.6g}")
