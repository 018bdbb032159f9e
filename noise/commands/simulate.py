"""``bushing-noise simulate``: one operating condition into a recording."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.base.atomic import check_target
from noise.commands import options as opt
from noise.commands.operating import is_long, run_arguments
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from models.recording import Recording

__all__ = ["configure", "run"]

_DEFAULT_RATE = 30000
_MOST_DRAWN = 60.0
"""Longest run that is drawn [s]; longer ones are written in blocks."""


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Simulate one run of the rig and record torque [N m], acceleration [m/s^2], pressure [Pa] "
        "and angle [rad], or draw it. The names of the files are printed; without --out and --plot "
        "a summary as one line of JSON: conditions, mean of the torque and its rms about the mean, "
        "peak and level (dB re 20 uPa) of the sound pressure."
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
    parser.add_argument(
        "--plot",
        type=Path,
        metavar="FILE",
        help="draw the run into FILE, .png, .svg or .pdf: torque, displacement and sliding speed "
        "over time, phase plane, torque against sliding speed, autospectra; of runs up to 60 s",
    )
    opt.add_seed(parser, "seed of the sensors' noise")


def run(options: Namespace) -> int:
    """Simulate; write the recording and the picture, or print the summary."""
    if options.out is not None:
        check_target(options.out)
    if options.plot is not None:
        _check_plot(options.plot, options.seconds)
    arguments = run_arguments(options, options.rate)
    if options.out is not None and is_long(arguments):
        from noise.long_run import write_run
        from sim.long_run import simulate_blocks

        _print_names(write_run(options.out, simulate_blocks(**arguments)))
        return 0
    from sim.run import simulate

    simulated = simulate(**arguments)
    if options.out is None and options.plot is None:
        print(json.dumps(_summary(simulated.recording)))
    if options.out is not None:
        from noise.recordings import write_recording

        _print_names(write_recording(options.out, simulated.recording))
    if options.plot is not None:
        from noise.pictures.files import write_picture
        from noise.pictures.run import plot_run

        write_picture(options.plot, plot_run(simulated))
        print(options.plot)
    return 0


def _check_plot(path: Path, seconds: float | None) -> None:
    """Refuse a picture that cannot be drawn, before the run that it shows."""
    from noise.pictures.files import check_picture_path

    try:
        check_picture_path(path)
    except ParameterError as error:
        raise ParameterError(f"--plot {error}") from None
    check_target(path, "--plot")
    if seconds is not None and seconds > _MOST_DRAWN:
        raise ParameterError(
            f"--plot takes the whole run in memory, for which --seconds {seconds:g} is too long; "
            f"give {_MOST_DRAWN:g} or less"
        )


def _print_names(path: Path) -> None:
    print(path)
    print(path.with_suffix(".json"))


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
