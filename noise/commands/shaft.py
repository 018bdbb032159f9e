"""Motion of the shaft in the options of a condition: constant, ramp, log or oscillation."""

from __future__ import annotations

import csv
import math
from argparse import ArgumentTypeError, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.foreign_file import LARGEST_TEXT, reading
from noise.base.progress import note
from noise.commands.values import number, number_or_none

if TYPE_CHECKING:
    from sim.shaft import LoggedSpeed, ShaftMotion


def speed(text: str) -> float | tuple[float, float] | Path:
    """Read a speed [rad/s], the two ends of a ramp, or the path of a log."""
    start, dots, end = text.partition("..")
    if dots and number_or_none(start) is not None and number_or_none(end) is not None:
        return number()(start), number()(end)
    if number_or_none(text) is not None:
        return number()(text)
    if not Path(text).is_file():
        raise ArgumentTypeError(
            f"is {text!r}, expected a number in rad/s, a ramp such as 0..10, or a CSV file that "
            "exists"
        )
    return Path(text)


def swing(text: str) -> tuple[float, float]:
    """Read amplitude [degree] and frequency [Hz] of an oscillation."""
    try:
        degrees, frequency = (number(above=0.0)(part) for part in text.split(","))
    except (ArgumentTypeError, ValueError):
        raise ArgumentTypeError(
            f"is {text!r}, expected degrees and Hz, both above 0, such as 15,2"
        ) from None
    return degrees, frequency


def shaft_motion(options: Namespace, seconds: float) -> tuple[ShaftMotion, str]:
    """Return how the shaft turns, and that in words.

    Parameters
    ----------
    options : argparse.Namespace
        With ``speed`` and ``oscillate``, of which one is given.
    seconds : float
        Length of the run [s].
    """
    from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

    if options.oscillate is not None:
        degrees, frequency = options.oscillate
        words = f"swinging +-{degrees:g} degrees at {frequency:g} Hz"
        return Oscillation(math.radians(degrees), frequency), words
    if isinstance(options.speed, tuple):
        start, end = options.speed
        return SpeedRamp(start, end, seconds), f"{start:g} to {end:g} rad/s"
    if isinstance(options.speed, Path):
        return _logged_speed(options.speed, seconds), f"speed as logged in {options.speed.name}"
    return ConstantSpeed(options.speed), f"{options.speed:g} rad/s"


def _logged_speed(path: Path, seconds: float) -> LoggedSpeed:
    from sim.shaft import LoggedSpeed

    where = f"--speed {path}"
    with reading(path, "CSV table", where=where, largest=LARGEST_TEXT):
        try:
            time, speed = _read_log(path)
            logged = LoggedSpeed(time, speed)
        except ParameterError as error:
            raise ParameterError(f"{where}: {error}") from None
    if time[0] > 0.0 or time[-1] < seconds:
        note(
            f"--speed {path} covers {time[0]:g} to {time[-1]:g} s, the run 0 to {seconds:g} s; "
            "where the log says nothing its nearest speed is held"
        )
    elif time[-1] > seconds:
        note(f"--speed {path} lasts {time[-1]:g} s, the run takes its first {seconds:g} s")
    return logged


def _read_log(path: Path) -> tuple[list[float], list[float]]:
    time: list[float] = []
    speed: list[float] = []
    columns = (0, 1)
    header_possible = True
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = csv.reader(file)
        for row in rows:
            cells = [cell.strip() for cell in row]
            if not any(cells):
                continue
            if header_possible and all(number_or_none(cell) is None for cell in cells):
                header_possible = False
                if not {"time_s", "speed_rad_s"} <= set(cells):
                    raise ParameterError(
                        f"has the columns {', '.join(cells)}, expected time_s and speed_rad_s"
                    )
                columns = (cells.index("time_s"), cells.index("speed_rad_s"))
                continue
            header_possible = False
            try:
                moment, value = (float(cells[column]) for column in columns)
            except (ValueError, IndexError):
                raise ParameterError(
                    f"line {rows.line_num} is {','.join(row)!r}, expected time in s and speed in "
                    "rad/s with a comma between"
                ) from None
            time.append(moment)
            speed.append(value)
    return time, speed
