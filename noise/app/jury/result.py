"""What a jury has said so far: the scale with names, and what to know of it."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np

from noise.app.jury.consistency import consistency
from noise.app.jury.scale import scale
from noise.base.csv_table import write_csv

if TYPE_CHECKING:
    from noise.app.jury.store import Jury

__all__ = ["COLUMNS", "result", "result_csv"]

COLUMNS = (
    *("jury", "listener", "question", "played", "sound", "value", "low_95", "high_95"),
    *("chosen", "not_chosen", "no_difference", "group"),
)
"""Of the table of a scale, the highest first."""


def result(jury: Jury) -> dict[str, object]:
    """Return the scale of a jury's sounds, the highest first, and all remarks on it.

    Examples
    --------
    >>> from noise.app.jury.store import Jury
    >>> pairs = ("a.wav", "b.wav"), ("b.wav", "a.wav")
    >>> found = result(Jury(1, "", "Which is louder?", "one gain", pairs, ("second", "first")))
    >>> [one["sound"] for one in found["sounds"]], found["voted"]
    (['b.wav', 'a.wav'], 2)
    """
    found = scale(jury.sounds, jury.said)
    trusted = consistency(len(jury.sounds), jury.said, np.random.default_rng(jury.number))
    rows = [
        {
            "sound": name,
            "value": _rounded(one.value),
            "low_95": _rounded(one.low),
            "high_95": _rounded(one.high),
            "chosen": one.chosen,
            "not_chosen": one.not_chosen,
            "no_difference": one.no_difference,
            "group": one.group + 1,
        }
        for name, one in sorted(
            zip(jury.sounds, found.sounds, strict=True),
            key=lambda pair: (pair[1].group, -(pair[1].value or 0.0), pair[0]),
        )
    ]
    facts = [f"{len(jury.votes)} of {len(jury.pairs)} comparisons voted"]
    if trusted.triads:
        zeta = "" if trusted.zeta is None else f" (Kendall's zeta {trusted.zeta:.2f})"
        facts.append(f"{trusted.circular} of {trusted.triads} triads go in a circle{zeta}")
    if trusted.repeats:
        facts.append(f"{trusted.alike} of {trusted.repeats} repeated pairs were answered alike")
    if trusted.decided:
        facts.append(f"A was chosen in {trusted.first} of {trusted.decided} decided votes")
    return {
        "jury": jury.number,
        "listener": jury.listener,
        "question": jury.question,
        "played": jury.played,
        "voted": len(jury.votes),
        "total": len(jury.pairs),
        "sounds": rows,
        "facts": facts,
        "remarks": [*found.remarks, *trusted.remarks],
    }


def result_csv(jury: Jury) -> str:
    """Return the scale of a jury's sounds as a table.

    Examples
    --------
    >>> from noise.app.jury.store import Jury
    >>> jury = Jury(1, "", "Which?", "one gain", (("=a.wav", "b.wav"),), ("second",))
    >>> result_csv(jury).splitlines()[2]
    "1,,Which?,one gain,'=a.wav,-0.55,-3.04,0.92,0,1,0,1"
    """
    found = result(jury)
    rows = found["sounds"]
    about = {"jury": jury.number, "listener": jury.listener, "question": jury.question}
    about["played"] = jury.played
    text = io.StringIO()
    full = [about | row for row in rows]  # type: ignore[attr-defined]
    write_csv(text, COLUMNS, [[row[column] for column in COLUMNS] for row in full])
    return text.getvalue()


def _rounded(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else round(value, 2) + 0.0
