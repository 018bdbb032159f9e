"""``bushing-noise screen``: bushing designs into maps of their noise, margins and a ranking."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.rig import Rig
from noise.base.progress import Steps, report, say, steps
from noise.commands.options import (
    CHANGE,
    MOST_WORKERS,
    Group,
    Option,
    changed,
    check_folder,
    whole_number,
)

if TYPE_CHECKING:
    from noise.screening.design import Swinging, Use
    from noise.screening.screen import Screening


OPTIONS = (
    Option("designs DESIGN", str, count="+"),
    Option("--out FOLDER", Path),
    Option("--sounds N", whole_number(0), 24),
    CHANGE,
    Group(
        "conditions",
        "In place of the designs' own. Each is a number, a list 1,2.5,5 or a range LOW..HIGH, "
        "with LOW..HIGH/N of N points.",
        (
            Option("--speed V", str),
            Option("--oscillate DEG,HZ", str),
            Option("--interference MM", str),
            Option("--support-stiffness K", str),
            Option("--temperature C", str),
            Option("--environment NAME", str, "dry"),
        ),
    ),
    Option("--no-tolerances"),
    Option("--simulations N", whole_number(1)),
    Option("--workers N", whole_number(1, most=MOST_WORKERS), -1),
)


def run(options: Namespace) -> int:
    """Screen the designs, print the ranking and write tables and pictures."""
    check_folder(options.out, file="map.csv")
    from noise.batch.journal import call_identity, temporary_journal
    from noise.screening.design import load_design, load_designs
    from noise.screening.environments import environment

    use, change = _use(options), _change(options)
    environments = [name for name in options.environment.split(",") if name.strip()]
    for name in environments:
        environment(name)
    for design in options.designs:
        if not Path(design).exists():
            load_design(design)  # refuses the call if it is no material either
    load_designs(options.designs, change)  # refuses bad designs before slow imports
    table = None if options.out is None else options.out / "map.csv"
    with temporary_journal(table, call_identity("screening")) as journal:
        with steps("screening", 100, "percent") as bar:
            say("preparing")
            import numpy as np

            from noise.screening.screen import DEFAULT_SIMULATIONS, screen

            screening = screen(
                options.designs,
                use,
                environments=environments,
                tolerances=not options.no_tolerances,
                rng=np.random.default_rng(options.seed),
                change=change,
                simulations=options.simulations or DEFAULT_SIMULATIONS,
                workers=options.workers,
                progress=say,
                advance=bar.at,
                journal=journal,
            )
        from noise.screening.summary import summary_lines

        for name, reason in screening.refused:
            say(f"{name}: {reason}")
        if options.out is None:
            print(*summary_lines(screening), sep="\n")
        else:
            report(*summary_lines(screening))
            with steps("writing", 2) as progress:
                written = _write(options, screening, progress)
            report(*written)
    return 1 if screening.refused else 0


def _change(options: Namespace) -> Callable[[Rig], Rig] | None:
    """Return the change of the rigs by ``--change``."""
    return (lambda rig: changed(rig, options.change)) if options.change else None


def _use(options: Namespace) -> Use:
    """Return the conditions that the options state."""
    from noise.screening.design import AXES, read_use

    return read_use(
        {axis: getattr(options, axis) for axis in AXES},
        {axis: f"--{axis.replace('_', '-')}" for axis in AXES},
        None if options.oscillate is None else _swinging(options.oscillate),
    )


def _swinging(text: str) -> Swinging:
    """Parse amplitude [degree] and frequencies [Hz] of an oscillation."""
    from noise.screening.design import FREQUENCY, Swinging, axis_values

    degrees, comma, frequency = text.partition(",")
    if not comma:
        raise ParameterError(
            f"--oscillate is {text!r}, expected degrees and Hz, such as 15,2 or 15,0.5..4"
        )
    (amplitude,) = axis_values(degrees, "--oscillate")[:1]
    return Swinging(math.radians(amplitude), axis_values(frequency, "--oscillate", FREQUENCY))


def _write(options: Namespace, screening: Screening, progress: Steps) -> list[Path]:
    """Write tables, designs, pictures and the report; return their paths."""
    from noise.base.tables import write_table
    from noise.pages.screening import write_screening
    from noise.pictures.figure import write_picture
    from noise.pictures.maps import plot_screen
    from noise.screening.tables import screening_tables

    folder = options.out
    written: list[Path] = []
    progress("drawing the maps")
    for name, (columns, rows) in screening_tables(screening).items():
        write_table(folder / name, columns, rows)
        written.append(folder / name)
    single = len(screening.maps) == 1
    for index, mapped in enumerate(screening.maps, start=1):
        path = folder / ("map.png" if single else f"map-{index}.png")
        write_picture(path, plot_screen(mapped))
        written.append(path)
    progress("making the sounds of the report")
    write_screening(
        folder / "report.html", screening, sounds=options.sounds, seed=options.seed or 0,
        workers=options.workers,
    )  # fmt: skip
    return [*written, folder / "report.html"]
