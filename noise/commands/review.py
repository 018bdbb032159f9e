"""``bushing-noise review``: one page of recordings and labels."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from noise.base.files import check_target
from noise.base.progress import counted, note, report, say
from noise.commands.options import CALIBRATION, Option, full_scale_of, number, refuse

OPTIONS = (
    Option("paths PATH", Path, count="+"),
    Option("--out DIR|PAGE.html", Path, required=True),
    Option("--title TEXT", str, "Review"),
    Option("--seconds S", number(least=1.0, most=600.0), 10.0),
    Option("--megabytes MB", number(least=1.0, most=2000.0), 40.0),
    Option("--no-labelling"),
    *CALIBRATION,
)


def run(options: Namespace) -> int:
    """Write the review page."""
    from noise.pages.review import page_path, review

    target = page_path(options.out)
    check_target(target)
    page = review(
        options.paths,
        options.out,
        title=options.title,
        full_scale=full_scale_of(options),
        seconds=options.seconds,
        megabytes=options.megabytes,
        classify=not options.no_labelling,
    )
    for refusal in page.refused:
        refuse(f"{refusal.name}: {refusal.reason}")
    if page.longest < options.seconds:
        note(
            f"sounds are cut to {page.longest:.3g} s to keep to {options.megabytes:g} MB; "
            "--megabytes allows more"
        )
    size = page.path.stat().st_size / 1e6
    say(f"{counted(page.sounds, 'sound')}, {size:.1f} MB")
    report(page.path)
    return 1 if page.refused else 0
