"""Figures of a set of cases with their 95 % intervals, in all and by kind of bench.

The worst kind of bench is the headline. A share has Wilson's interval, all else that of cases drawn
again; an aim is met where it lies inside or beyond the interval.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import binomtest

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from .cases import Answer, Truth

    Pairs = list[tuple[Truth, Answer]]

__all__ = ["QUANTITIES", "Figure", "as_json", "as_text", "calibration_error", "score", "worst"]

_DRAWS = 400
_GROUPS = 10
_SURE = 0.9
_WIDTH = 20


@dataclass(frozen=True)
class Quantity:
    """Of whom something is asked, what of each, and what of them all."""

    asked: Callable[[Truth], bool]
    value: Callable[[Truth, Answer], object]
    aims: tuple[float | None, float | None] = (None, None)
    """On the worst kind of bench, and on all."""
    low_is_good: bool = False
    statistic: Callable[[np.ndarray], float] = lambda rows: float(rows[:, 0].mean())


@dataclass(frozen=True)
class Figure:
    """A value with its interval; None where no case asks for it."""

    cases: int
    value: float | None = None
    low: float | None = None
    high: float | None = None


def _of(*kinds: str) -> Callable[[Truth], bool]:
    return lambda t: t.counts and t.kind in kinds


def _plain(kind: str) -> Callable[[Truth], bool]:
    return lambda t: t.counts and t.kind == kind and t.plain


def _exact(truth: Truth, answer: Answer) -> bool:
    return set(answer.verdict) == set(truth.verdict)


def _named(_: Truth, answer: Answer) -> bool:
    wrong = (p for name, p in answer.probability.items() if name not in ("none", "unknown"))
    return answer.failed or max(wrong, default=0.0) > _SURE


def _brier(truth: Truth, answer: Answer) -> float:
    names = set(truth.names) | set(answer.probability)
    return sum((answer.of(name) - (name in truth.names)) ** 2 for name in names)


def _top(truth: Truth, answer: Answer) -> tuple[float, bool]:
    if not answer.probability:
        return 1.0, False
    name = answer.ranking[0]
    return answer.of(name), name in truth.names


def calibration_error(rows: np.ndarray) -> float:
    """Expected calibration error of rows of confidence and whether it was right."""
    order = np.argsort(rows[:, 0], kind="stable")
    groups = np.array_split(rows[order], min(_GROUPS, len(rows)))
    return float(sum(abs(g[:, 0].mean() - g[:, 1].mean()) * len(g) for g in groups) / len(rows))


def _median(rows: np.ndarray) -> float:
    return float(np.median(rows[:, 0]))


def _covers(_: Truth, answer: Answer) -> bool:
    """Whether the interval holds all of the gap, which the effect's own absence closes."""
    return answer.interval is not None and answer.interval[0] <= 1.0 <= answer.interval[1] + 0.05


_KNOWN = _of("one", "pair", "triple")
_SCORED = lambda t: t.counts or t.kind == "none"  # noqa: E731

QUANTITIES: dict[str, Quantity] = {
    "false alarm": Quantity(lambda t: t.kind == "none",
                            lambda _, a: bool(a.verdict) or a.failed, (0.05, 0.02), True),
    "detected": Quantity(lambda t: t.counts, lambda _, a: bool(a.verdict), (0.92, 0.97)),
    "right first": Quantity(_of("one"), lambda t, a: t.verdict[0] in a.ranking[:1], (0.80, 0.90)),
    "among three": Quantity(_of("one"), lambda t, a: t.verdict[0] in a.ranking[:3]),
    "exact single": Quantity(_of("one"), _exact),
    "stage": Quantity(_KNOWN, lambda t, a: a.stage in t.stages),
    "parameters": Quantity(_of("parameters"), lambda _, a: "parameters" in a.verdict, (0.85, 0.93)),
    "as parameters": Quantity(_of("one", "pair", "triple", "stranger"),
                              lambda _, a: "parameters" in a.verdict, low_is_good=True),
    "exact pair": Quantity(_plain("pair"), _exact, (0.35, 0.55)),
    "exact triple": Quantity(_plain("triple"), _exact),
    "unknown": Quantity(_of("stranger"), lambda _, a: "unknown" in a.verdict, (0.60, 0.75)),
    "named > 0.9": Quantity(_of("stranger"), _named, (0.08, 0.03), True),
    "ECE": Quantity(_SCORED, _top, (0.08, 0.03), True, calibration_error),
    "Brier": Quantity(_SCORED, _brier, (None, 0.25), True),
    "closed": Quantity(_KNOWN, lambda _, a: a.closed or 0.0, (0.7, 0.85), False, _median),
    "covers": Quantity(_KNOWN, _covers, (None, 0.85)),
    "seconds": Quantity(lambda _: True, lambda _, a: a.seconds or 0.0, (None, 25.0), True, _median),
    "failed": Quantity(lambda _: True, lambda _, a: a.failed, low_is_good=True),
}  # fmt: skip
"""By their headings."""


def score(pairs: Pairs, seed: int = 0) -> dict[str, Figure]:
    """Return a figure of each quantity."""
    rng = np.random.default_rng(seed)
    return {
        name: _figure(q, [q.value(t, a) for t, a in pairs if q.asked(t)], rng)
        for name, q in QUANTITIES.items()
    }


def _figure(quantity: Quantity, values: list[object], rng: np.random.Generator) -> Figure:
    n = len(values)
    if n == 0:
        return Figure(0)
    rows = np.array(values, dtype=float).reshape(n, -1)
    value = quantity.statistic(rows)
    if rows.shape[1] == 1 and np.isin(rows, (0.0, 1.0)).all() and quantity.statistic is not _median:
        sure = binomtest(round(float(rows.sum())), n).proportion_ci(method="wilson")
        return Figure(n, value, float(sure.low), float(sure.high))
    drawn = [quantity.statistic(rows[rng.integers(0, n, n)]) for _ in range(_DRAWS)]
    low, high = np.quantile(drawn, [0.025, 0.975]).tolist()
    return Figure(n, value, low, high)


def worst(scores: Mapping[str, Mapping[str, Figure]]) -> dict[str, tuple[str, Figure]]:
    """Return the worst kind of bench by quantity, with its figure."""
    found = {}
    for name, quantity in QUANTITIES.items():
        of = [(b, s[name]) for b, s in scores.items() if s[name].value is not None]
        if of:
            sign = 1.0 if quantity.low_is_good else -1.0
            found[name] = max(of, key=lambda one: sign * (one[1].value or 0.0))
    return found


def by_bench(pairs: Pairs) -> dict[str, dict[str, Figure]]:
    """Figures of each kind of bench, in the order in which they appear."""
    benches = dict.fromkeys(t.bench for t, _ in pairs)
    return {bench: score([(t, a) for t, a in pairs if t.bench == bench]) for bench in benches}


def _cell(f: Figure) -> str:
    return "-" if f.value is None else f"{f.value:.2f} {f.low:.2f}-{f.high:.2f} {f.cases}"


def _against(name: str, f: Figure, place: int) -> str:
    quantity = QUANTITIES[name]
    aim = quantity.aims[place]
    if aim is None or f.low is None or f.high is None:
        return ""
    met = f.low <= aim if quantity.low_is_good else f.high >= aim
    return f"{'<=' if quantity.low_is_good else '>='} {aim:g} {'met' if met else 'MISSED'}"


def as_text(pairs: Pairs) -> str:
    """Lay out a table: value, 95 % interval and cases; a row a kind of bench, the worst first."""
    scores, whole = by_bench(pairs), score(pairs)
    headline = worst(scores)
    names = list(headline)
    rows = [
        ["", *names],
        ["worst", *(_cell(headline[name][1]) for name in names)],
        ["  which", *(headline[name][0] for name in names)],
        ["  aim", *(_against(name, headline[name][1], 0) for name in names)],
        *([bench, *(_cell(s[name]) for name in names)] for bench, s in scores.items()),
        ["all", *(_cell(whole[name]) for name in names)],
        ["  aim", *(_against(name, whole[name], 1) for name in names)],
    ]
    return "\n".join("".join(f"{x:{_WIDTH}}" for x in row).rstrip() for row in rows)


def as_json(pairs: Pairs) -> dict[str, dict]:
    """Return the same figures as JSON has them: number of cases, value and interval."""

    def listed(figures: Mapping[str, Figure]) -> dict[str, list]:
        return {n: [f.cases, f.value, f.low, f.high] for n, f in figures.items() if f.cases}

    scores = by_bench(pairs)
    headline = {n: [*listed({n: f})[n], bench] for n, (bench, f) in worst(scores).items()}
    benches = {bench: listed(s) for bench, s in scores.items()}
    return {"figures": listed(score(pairs)), "by_bench": {"worst": headline} | benches}
