"""``bushing-noise simulate``: one operating condition into a recording."""

from __future__ import annotations

import json
import math
from argparse import Namespace
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError, naming
from noise.base.files import check_target
from noise.base.progress import note, report, say
from noise.base.tables import check_table_path, write_table
from noise.commands.condition import CONDITION, DEFAULT_SECONDS, run_arguments, with_notes
from noise.commands.options import Option, whole_number

if TYPE_CHECKING:
    from models.recording import Recording
    from models.suspension import Suspension
    from sim.run import Run


_DEFAULT_RATE = 30000
_SHORTEST_FOR_POWER = 0.25
"""Shortest run for `sim.analysis.sound_power` [s]."""


OPTIONS = (
    CONDITION,
    Option("--rate HZ", whole_number(1000, most=400_000), _DEFAULT_RATE),
    Option("--out RUN", Path),
    Option("--force"),
    Option("--plot FILE", Path),
    Option("--sound-power TABLE", Path),
)


def run(options: Namespace) -> int:
    """Simulate; write recording, picture and sound power, or print the summary."""
    _check(options)
    if options.rig is not None:
        from models.suspension import load_suspension

        with naming("--rig: "):
            car = load_suspension(options.rig)
        if car is not None:
            return _run_suspension(options, car)
    arguments, notes = run_arguments(options, options.rate)
    note(*notes)
    from sim.run import simulate

    simulated = simulate(**arguments)
    recording = with_notes(simulated, notes, arguments)
    if options.plot is options.sound_power is None or options.out is not None:
        _write_or_print(options.out, recording)
    if options.plot is not None:
        from noise.pictures.figure import write_picture
        from noise.pictures.run import plot_run

        write_picture(options.plot, plot_run(simulated))
        report(options.plot)
    if options.sound_power is not None:
        _write_sound_power(options.sound_power, simulated, arguments)
        report(options.sound_power)
    return 0


def _run_suspension(options: Namespace, car: Suspension) -> int:
    """Simulate a car's stabilizer bar in two bushings."""
    for option, value in (("--plot", options.plot), ("--sound-power", options.sound_power)):
        if value is not None:
            raise ParameterError(
                f"{option} is for the rig only; --rig {options.rig} is a suspension"
            )
    arguments, notes = run_arguments(options, options.rate, rig=car.rig)
    from noise.base.remarks import clipping_remarks
    from sim.suspension import run_suspension

    car = replace(car, rig=arguments.pop("rig"))
    recording = run_suspension(car, **arguments)
    sensors = arguments["acquisition"].over(car.rig.sensors).sensors
    notes += (*recording.notes, *clipping_remarks(recording, sensors))
    note(*notes)
    _write_or_print(options.out, replace(recording, notes=notes))
    return 0


def _write_or_print(path: Path | None, recording: Recording) -> None:
    """Write a recording, or without a path print its summary."""
    if path is None:
        print(json.dumps(_summary(recording)))
        return
    from noise.recordings import write_recording

    wav = write_recording(path, recording)
    report(wav, wav.with_suffix(".json"))


def _write_sound_power(path: Path, simulated: Run, arguments: Mapping[str, Any]) -> None:
    """Write the table of the sound power and print its sum."""
    from noise.audio.assessment import POWER_COLUMNS, sound_power_rows
    from sim.analysis.sound_power import motion_sound_power

    if arguments["rig"].measured:
        note("the sound power is that of the modelled plate; measured responses are not in it")
    say("computing the sound power")
    names = ("interference", "support_stiffness", "library")
    power = motion_sound_power(
        arguments["rig"], simulated.motion, **{name: arguments[name] for name in names}
    )
    rows = sound_power_rows(power)
    write_table(path, POWER_COLUMNS, rows)
    total = rows[-1]["power_level_dba"]
    silent = "the plate radiates no sound"
    say(silent if total is None else f"sound power {total:.1f} dB(A) re 1 pW in a baffle")


def _check_overwrite(out: Path) -> None:
    """Refuse to replace a recording that this program did not write, judged by the sidecar."""
    wav = out if out.suffix.lower() == ".wav" else out.with_name(f"{out.name}.wav")
    if not wav.exists():
        return
    from noise.recordings.sidecar import GENERATOR

    try:
        sidecar = json.loads(wav.with_suffix(".json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        sidecar = {}
    if not isinstance(sidecar, dict) or not GENERATOR.items() <= sidecar.items():
        raise ParameterError(
            f"--out {out}: {wav.name} is there and was not written by this program; give another "
            "name, or --force to replace it"
        )


def _check(options: Namespace) -> None:
    """Refuse outputs that cannot be written, before the run."""
    check_target(options.out)
    if options.out is not None and not options.force:
        _check_overwrite(options.out)
    if options.plot is not None:
        from noise.pictures.figure import check_picture_path

        with naming("--plot "):
            check_picture_path(options.plot)
    check_table_path(options.sound_power)
    seconds = DEFAULT_SECONDS if options.seconds is None else options.seconds
    for option, path in (("--plot", options.plot), ("--sound-power", options.sound_power)):
        if path is not None:
            check_target(path, option)
    if options.sound_power is not None and seconds < _SHORTEST_FOR_POWER:
        raise ParameterError(
            f"--sound-power: --seconds {seconds:g} is too short for the band at 50 Hz; "
            f"give {_SHORTEST_FOR_POWER:g} or more"
        )


def _summary(recording: Recording) -> dict[str, object]:
    """Return conditions, torque and sound level of a recording for JSON."""
    import numpy as np

    from models.recording import REFERENCE_PRESSURE
    from noise.recordings.sidecar import sidecar_text

    pressure = recording["pressure"]
    rms = float(pressure.std())
    level = 20.0 * math.log10(rms / REFERENCE_PRESSURE) if rms > 0.0 else None
    summary: dict[str, object] = {
        "conditions": json.loads(sidecar_text(recording))["conditions"],
        "seconds": recording.duration,
        "rate_hz": recording.rate,
    }
    for name in recording.channel_names:
        if name.partition("_")[0] == "torque":
            summary[f"{name}_mean_Nm"] = _short(float(np.mean(recording[name])))
            summary[f"{name}_rms_about_mean_Nm"] = _short(float(np.std(recording[name])))
    summary["peak_pressure_Pa"] = _short(float(abs(pressure).max()))
    summary["level_db"] = None if level is None else round(level, 2)
    return summary | ({"notes": list(recording.notes)} if recording.notes else {})


def _short(value: float) -> float:
    """Round a number to six digits."""
    return float(f"{value:.6g}")
