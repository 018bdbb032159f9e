"""``bushing-noise identify``: recordings of a rig -> its rig file."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.progress import Steps, note, report, say, steps
from noise.commands.options import CHANGE, Option, change_table, check_folder, seed

if TYPE_CHECKING:
    from noise.identification.outcome import Identification


DESCRIPTION = (
    "Identify a rig from recordings: stiffness and damping of the bushing, critical and "
    "kinetic torque by interference, and the law of friction, each with its 90 % interval. "
    "Recordings need torque and shaft angle, and a sidecar with interference and support "
    "stiffness. Slow rotation with clear stick and slip is most informative; several speeds "
    "determine the law. A condition recorded twice shows how much repeat measurements differ. A "
    "static test, slow motion to and fro without slip, gives the best stiffness. A shaft held "
    "still after that gives the best damping."
)

EPILOG = "example: bushing-noise identify recordings --rig known.toml --out mine"

OPTIONS = (
    Option("data DATA", Path, count="+").help("recordings, or folders of them"),
    Option("--rig RIG.toml", Path).help("what is known of the rig: the two inertias, if possible"),
    Option("--out FOLDER", Path).help(
        "folder for rig.toml, identification.json and report.html (default: the rig file on "
        "standard output)"
    ),
    CHANGE,
    seed("of simulated repeats"),
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
        found = identify_rig(measurements, beforehand, seed=options.seed or 0, progress=tell)
    except NothingSlipsError as error:
        say(f"{', '.join(one.name for one in measurements.used)}: {error}; nothing is written")
        return None, True
    return found, bool(measurements.refused)
