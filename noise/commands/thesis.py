"""``bushing-noise thesis``: published numbers compared with computed ones."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from models.errors import ParameterError
from noise.base.files import atomic, check_target
from noise.base.progress import report, say, track
from noise.base.tables import TABLE_ENDINGS, check_table_path, write_table
from noise.commands.options import Option

_PAGE_ENDING = ".md"


OPTIONS = (Option("--out TABLE", Path),)


def run(options: Namespace) -> int:
    """Compute and write the table, and print a summary of its verdicts."""
    out: Path | None = options.out
    is_page = out is not None and out.suffix.lower() == _PAGE_ENDING
    if out is not None:
        if is_page and out.is_dir():
            raise ParameterError(f"{out}: is a folder; name a file to write")
        if not is_page and out.suffix.lower() not in TABLE_ENDINGS:
            endings = ", ".join(TABLE_ENDINGS)
            raise ParameterError(f"{out}: this table ends in {endings} or {_PAGE_ENDING}")
        if not is_page:
            check_table_path(out)
        check_target(out)
    say("preparing")
    from noise.thesis.runs import constant_note
    from noise.thesis.table import COLUMNS, group_names, thesis_page, thesis_rows, verdict_counts

    rows = thesis_rows(track(group_names(), "computing", unit="row group"))
    if out is not None and is_page:
        with atomic(out) as temporary:
            temporary.write_text(thesis_page(rows), encoding="utf-8", newline="\n")
    else:
        write_table(out, COLUMNS, (row.cells() for row in rows))
    counts = ", ".join(f"{word} {count}" for word, count in verdict_counts(rows).items())
    say(f"{len(rows)} rows: {counts}")
    say(constant_note())
    if out is not None:
        report(out)
    return 0
