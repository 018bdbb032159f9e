"""Page of Markdown with the table and the meaning of its columns and verdicts."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from importlib import resources

from noise.thesis.row import COLUMNS, Row
from noise.thesis.runs import constant_note

_WHY = """\
## What is missed, and why

All rows of something measured whose calibrated value is more than 25 % off, or that of a formula
where there is none. Factors without a source are trials with the shipped material, by which all
values of that parameter were multiplied.
"""


def verdict_counts(rows: Sequence[Row]) -> dict[str, int]:
    """Count the verdicts, all that are off as one.

    Examples
    --------
    >>> from noise.thesis.table import thesis_rows
    >>> verdict_counts(thesis_rows(["misprints"]))
    {'misprint': 5}
    """
    words = Counter(
        _counted(part) + (" (in sample)" if row.in_sample else "")
        for row in rows
        for part in row.verdict.removesuffix(" (in sample)").split("; ")
    )
    return dict(words.most_common())


def _counted(part: str) -> str:
    plain = part.removeprefix("calibrated ")
    if not plain.startswith("off by"):
        return part
    return "off" if plain == part else "calibrated off"


def measured_counts(rows: Sequence[Row]) -> str:
    """Count what was measured, what of it the shipped program misses, and what is out of sample.

    A fact counts once, by the row that judges what ships; see `Row.counted`.

    Examples
    --------
    >>> from noise.thesis.row import Row, number
    >>> measured_counts([Row("x", "y", "Hz", number(1.0), calibrated=2.0, measured=True)])
    'Measured: 1 fact, of which 1 out of sample; more than 25 % off 1, of which 1 out of sample...'
    """
    facts = [row for row in rows if row.measured and row.counted]
    checked = [row for row in facts if not math.isnan(row.best)]
    missed = [row for row in checked if row.misses]
    one, other = (sum(not row.in_sample for row in of) for of in (checked, missed))
    plural = "" if len(checked) == 1 else "s"
    return (
        f"Measured: {len(checked)} fact{plural}, of which {one} out of sample; more than 25 % off "
        f"{len(missed)}, of which {other} out of sample; not checkable {len(facts) - len(checked)}."
    )


def thesis_page(rows: Sequence[Row]) -> str:
    """Return the page.

    Examples
    --------
    >>> from noise.thesis.table import thesis_rows
    >>> print(thesis_page(thesis_rows(["misprints"])[:1]))
    # The thesis's numbers, checked
    ...
    | wlf_constant | (2.1), first | 1 | 8.88 |  | 8.860 |  | misprint |
    <BLANKLINE>
    """
    counts = ", ".join(f"{word} {count}" for word, count in verdict_counts(rows).items())
    constant = constant_note()
    lines = [
        (resources.files("noise.thesis") / "page.md").read_text(encoding="utf-8"),
        f"{constant[0].upper()}{constant[1:]}.",
        "",
        f"{len(rows)} rows: {counts}.",
        "",
        measured_counts(rows),
        "",
        "| " + " | ".join(COLUMNS) + " |",
        "|" + " --- |" * len(COLUMNS),
        *("| " + " | ".join(row.cells()[column] for column in COLUMNS) + " |" for row in rows),
        "",
    ]
    if whys := [f"- **{row.item}**, {row.condition}: {row.why}" for row in rows if row.why]:
        lines += [_WHY, *whys, ""]
    return "\n".join(lines)
