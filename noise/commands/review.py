"""``bushing-noise review``: one page of recordings, labels, screens and diagnoses."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from noise.base.files import check_target
from noise.base.progress import counted, note, report, say
from noise.commands.options import (
    CALIBRATION,
    Option,
    full_scale_of,
    number,
    refuse,
    seed,
    whole_number,
)

DESCRIPTION = (
    "Put recordings, labels, screens and diagnoses on one page, to mail, project and print. It "
    "needs no network. It has sounds at one stated gain, spectrograms under a moving cursor, "
    "labels over time, and maps of conditions that play where you click. A and B switch between "
    "two sounds without a gap. Press ? on the page for its keys. Inputs that cannot be used are "
    "named on the page, and the exit code is then 1."
)

EPILOG = (
    "examples: bushing-noise review recordings labels.csv --out review.html; "
    "bushing-noise review screen old.toml new.toml --out review; "
    "bushing-noise review recordings diagnosis --seconds 5 --out review"
)

OPTIONS = (
    Option("paths PATH", Path, count="+").help(
        "recording; label table (.csv, .xlsx, .jsonl, .parquet); map.csv of a screen; "
        "diagnosis.json; rig file of a screen's design (DESIGN.toml), for its sounds; or a folder "
        "that is searched for all of these at any depth"
    ),
    Option("--out DIR|PAGE.html", Path, required=True).help(
        "page to write, or folder for its report.html"
    ),
    Option("--title TEXT", str, "Review").help("of the page"),
    Option("--seconds S", number(least=1.0, most=600.0), 10.0).help(
        "longest stretch of a recording that is played, about what gave it its label"
    ),
    Option("--megabytes MB", number(least=1.0, most=2000.0), 25.0).help(
        "size of the page; sounds are shortened to keep to it, which the page says"
    ),
    Option("--pascal-per-full-scale PA", number(above=0.0)).help(
        "sound pressure in Pa of a full-scale sample on the page, for a listening room that "
        "is calibrated to it (default: what the loudest calibrated sound needs)"
    ),
    Option("--simulated N", whole_number(0, most=1000), 48).help(
        "sounds simulated for the maps of screens, of all maps together"
    ),
    Option("--no-labelling").help(
        "leave recordings without a label that no table labels (default: label them)"
    ),
    *CALIBRATION,
    seed("seed of simulated sounds and of the dither"),
)


def run(options: Namespace) -> int:
    """Write the page."""
    from noise.pages.review import page_path, review

    target = page_path(options.out)
    check_target(target)
    made = review(
        options.paths,
        options.out,
        title=options.title,
        full_scale=full_scale_of(options),
        pascal_per_full_scale=options.pascal_per_full_scale,
        seconds=options.seconds,
        megabytes=options.megabytes,
        simulated=options.simulated,
        classify=not options.no_labelling,
        seed=options.seed,
    )
    for refusal in made.refused:
        refuse(f"{refusal.name}: {refusal.reason}")
    if made.shortened is not None:
        note(
            f"sounds are cut to {made.shortened:.3g} s to keep to {options.megabytes:g} MB; "
            "--megabytes allows more"
        )
    size = made.path.stat().st_size / 1e6
    say(f"{counted(made.sounds, 'sound')}, {size:.1f} MB")
    report(made.path)
    return 1 if made.refused else 0
