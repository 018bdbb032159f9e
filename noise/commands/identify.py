"""``bushing-noise identify``: recordings of a rig -> its rig file."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.progress import Steps, note, report, say, steps
from noise.commands.options import CHANGE, SEED, Option, change_table, check_folder

if TYPE_CHECKING:
    from noise.identification.outcome import Identification


OPTIONS = (
    Option("data DATA", Path, count="+"),
    Option("--rig RIG.toml", Path),
    Option("--out FOLDER", Path),
    CHANGE,
    SEED,
)


def run(options: Namespace) -> int:
    """Identify and write."""
    if options.out is not None:
        check_folder(options.out, file="report.html")
    with steps("identifying", 1) as tell:
        found, refused = _identified(options, tell)
        if found is not None and options.out is not None:
            from noise.pages.identification import write_identification

            tell("writing the report")
            write_identification(options.out, found)
    if found is None:
        return 1
    for text in found.notes:
        note(text)
    if options.out is None:
        print(found.rig_toml, end="")
    else:
        for name in ("report.html", "rig.toml", "identification.json"):
            report(options.out / name)
    return 1 if refused else 0


def _identified(options: Namespace, tell: Steps) -> tuple[Identification | None, bool]:
    """Return what was found, None where there is nothing, and whether recordings were refused."""
    tell("preparing")
    from noise.identification.identify import NothingSlipsError, identify_rig
    from noise.identification.law_model import CANDIDATES
    from noise.identification.measured import known_beforehand, read_measurements

    beforehand = known_beforehand(options.rig, change_table(options.change or ()))
    calibrations = beforehand.rig.sensors.calibrations
    measurements = read_measurements(options.data, calibrations)
    for name, reason in measurements.refused:
        say(f"{name}: {reason}")
    if not (measurements.used or measurements.static):
        say("no recording that a rig can be identified from; nothing is written")
        return None, True
    tell.expect(len(measurements.used) + 2 * len(CANDIDATES) + 2)
    try:
        found = identify_rig(measurements, beforehand, progress=tell)
    except NothingSlipsError as error:
        say(f"{', '.join(one.name for one in measurements.used)}: {error}; nothing is written")
        return None, True
    return found, bool(measurements.refused)
