"""``bushing-noise identify``: recordings of a rig into its rig file."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.progress import Steps, note, report, say, steps
from noise.commands.options import CHANGE, Option, change_table, check_folder

if TYPE_CHECKING:
    from noise.identification.outcome import Identification


OPTIONS = (
    Option("data DATA", Path, count="+"),
    Option("--rig RIG.toml", Path),
    Option("--out FOLDER", Path),
    CHANGE,
)


def run(options: Namespace) -> int:
    """Identify the rig and write the results."""
    check_folder(options.out, file="report.html")
    with steps("identifying", 1) as progress:
        identification, refused = _identification(options, progress)
        if identification is not None and options.out is not None:
            from noise.pages.identification import write_identification

            progress("writing the report")
            write_identification(options.out, identification)
    if identification is None:
        return 1
    from noise.identification.identify import result_lines

    note(*identification.notes)
    if options.out is None:
        print(identification.rig_toml, end="")
    else:
        for name in ("report.html", "rig.toml", "identification.json"):
            report(options.out / name)
    for line in result_lines(identification):
        say(line)  # on standard error: standard output may be the rig file
    return 1 if refused else 0


def _identification(options: Namespace, progress: Steps) -> tuple[Identification | None, bool]:
    """Identify the rig, if possible; return also whether recordings were refused."""
    progress("preparing")
    from noise.identification.identify import NothingSlipsError, identify_rig
    from noise.identification.law_model import CANDIDATES
    from noise.identification.measured import known_beforehand, read_measurements

    beforehand = known_beforehand(options.rig, change_table(options.change or ()))
    measured, refused = read_measurements(options.data)
    for name, reason in refused:
        say(f"{name}: {reason}")
    if not measured:
        say("no recording that a rig can be identified from; nothing is written")
        return None, True
    progress.expect(len(measured) + 2 * len(CANDIDATES) + 2)
    try:
        identification = identify_rig(measured, refused, beforehand, progress=progress)
    except NothingSlipsError as error:
        say(f"{', '.join(one.name for one in measured)}: {error}; nothing is written")
        return None, True
    return identification, bool(refused)
