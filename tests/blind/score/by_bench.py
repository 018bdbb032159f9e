"""Scores by kind of bench: what is asked of each, and the worst, which is the headline."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .bootstrap import at_least, at_most
from .table import as_json, score_pairs

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .answers import Answer
    from .bootstrap import Aim, Figure
    from .truth import Truth

__all__ = ["ASKED", "by_bench", "by_bench_json", "by_bench_text", "worst"]

ASKED: dict[str, tuple[str, Aim | None]] = {
    "false alarms on null cases": ("false alarm", at_most(0.04)),
    "detection": ("detected", at_least(0.95)),
    "right cause first": ("right first", at_least(0.80)),
    "parameters told as such": ("parameters", None),
    "parameters told from physics": ("told apart", at_least(0.90)),
    "exact pair, each plain by itself": ("exact pair", at_least(0.45)),
    "exact triple": ("exact triple", None),
    "unknown: said so": ("unknown", at_least(0.60)),
    "unknown: named with p > 0.9": ("named > 0.9", at_most(0.10)),
    "closed, median": ("closed", at_least(0.80)),
    "ECE": ("ECE", at_most(0.06)),
    "Brier": ("Brier", None),
}
"""Quantities with their headings, and what is aimed at on the worst kind of bench."""

_LOW_IS_GOOD = ("false alarms on null cases", "unknown: named with p > 0.9", "ECE", "Brier")
_WIDTH = 20


def by_bench(pairs: list[tuple[Truth, Answer]]) -> dict[str, dict[str, Figure]]:
    """Figures of each kind of bench, in the order in which they appear."""
    benches = dict.fromkeys(t.bench for t, _ in pairs)
    return {
        bench: score_pairs([(t, a) for t, a in pairs if t.bench == bench], names=ASKED)
        for bench in benches
    }


def worst(scores: Mapping[str, Mapping[str, Figure]]) -> dict[str, tuple[str, Figure]]:
    """Return the worst kind of bench by quantity, with its figure."""
    found: dict[str, tuple[str, Figure]] = {}
    for name in ASKED:
        of = [(b, s[name]) for b, s in scores.items() if s[name].value is not None]
        if of:
            sign = 1.0 if name in _LOW_IS_GOOD else -1.0
            found[name] = max(of, key=lambda one: sign * (one[1].value or 0.0))
    return found


def _cell(f: Figure) -> str:
    if f.value is None:
        return "-"
    return f"{f.value:.2f} {f.low:.2f}-{f.high:.2f} {f.cases}"


def by_bench_text(scores: Mapping[str, Mapping[str, Figure]], all_: Mapping[str, Figure]) -> str:
    """Lay out a table: value, 95 % interval and cases; a row a kind of bench, the worst first."""
    worst_of = worst(scores)
    names = [name for name in ASKED if name in worst_of]
    rows = [["", *(ASKED[name][0] for name in names)]]
    rows += [["worst", *(_cell(worst_of[name][1]) for name in names)]]
    rows += [["  which", *(worst_of[name][0] for name in names)]]
    aims = [(ASKED[name][1], worst_of[name][1]) for name in names]
    rows += [["  aim", *(_against(aim, f) for aim, f in aims)]]
    rows += [[bench, *(_cell(s[name]) for name in names)] for bench, s in scores.items()]
    rows += [["all", *(_cell(all_[name]) for name in names)]]
    return "\n".join("".join(f"{x:{_WIDTH}}" for x in row).rstrip() for row in rows)


def _against(aim: Aim | None, f: Figure) -> str:
    if aim is None or f.low is None or f.high is None:
        return ""
    return f"{aim} {'met' if aim.met(f.low, f.high) else 'MISSED'}"


def by_bench_json(scores: Mapping[str, Mapping[str, Figure]]) -> dict[str, dict]:
    """Return figures by kind of bench as JSON has them, and the worst of each."""
    headline = {name: {"bench": b} | as_json({name: f})[name] for name, (b, f) in
                worst(scores).items()}  # fmt: skip
    return {"worst": headline} | {bench: as_json(s) for bench, s in scores.items()}
