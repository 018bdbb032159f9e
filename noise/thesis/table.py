"""Table of published numbers beside computed ones: its rows, their verdicts, and its page.

Each row of ``rows.csv`` is a published number with all that its verdict depends on (`Row`) and how
it is computed. ``value`` is the number itself: arithmetic on numbers of the thesis alone (its
calibrations, its shaft, its beams between rigid anchors, its heat) was done once and is data;
``as_printed`` is what a formula gives as it is printed, where ``value`` has it put right.
``listing`` is what the thesis's own program gives, which was run once (`tests/studies.md`).
``quantity`` names one of `noise.thesis.runs.QUANTITIES`, computed at ``cases`` for the models in
``columns`` (by default the equations and the calibrated material). A case is speed, interference
and support stiffness, then c_E or a material where they are others; cases are parted by semicolons,
and ``combined`` says what is made of them.

The verdict follows from numbers alone, by the tolerance that a row states: nobody's opinion is in
it. A row says which of its columns is judged. What was measured is judged on the calibrated column
as well, so that a calibrated rig which misses a measurement is told even where the thesis's
equations meet it. Why measured numbers are missed, a sentence or two each, with what was tried, is
in ``why.toml``.
"""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

from noise.base import packaged_toml
from noise.base.progress import counted
from noise.thesis.runs import CALIBRATED, QUANTITIES, THESIS, Case, constant_note

_MODELS = "listing", "exact", "calibrated"

COLUMNS = "item", "condition", "unit", "published", *_MODELS, "verdict"

_OFF_AT_MOST = 0.25
"""A value that is further off fails."""


@dataclass(frozen=True)
class Published:
    """Published value, as text and as the interval of values that it allows.

    Parameters
    ----------
    text : str
    low, high : float
        In the unit of the row [-]; equal for a number.
    """

    text: str
    low: float
    high: float

    def gap(self, value: float, scale: float | None = None) -> float:
        """Return the distance of `value` from the interval, relative to it or to `scale`.

        Examples
        --------
        >>> number(10.0).gap(12.0), Published("< 250", -math.inf, 250.0).gap(200.0)
        (0.2, 0.0)
        """
        nearest = min(max(value, self.low), self.high)
        if value == nearest:
            return 0.0
        base = abs(nearest) if scale is None else scale
        return abs(value - nearest) / base if base > 0.0 else math.inf


def number(value: float, text: str | None = None) -> Published:
    """Return a published number, in the unit of its row [-]."""
    return Published(f"{value:g}" if text is None else text, value, value)


@dataclass(frozen=True)
class Row:
    """A row of the table.

    Parameters
    ----------
    item, condition, unit : str
    published : Published
    listing, exact, calibrated : float
        Computed values, in the unit `unit` [-]; infinite is beyond `limit`, NaN is none.
    judged : str
        Which of them the verdict is on.
    tolerance : float
        Relative, within which a value holds.
    measured : bool
        Whether the thesis measured it. The calibrated column is then judged as well, and equations
        that fail are refuted.
    meant : Published, optional
        What must have been meant, if the print is wrong.
    as_printed : float, optional
        What a formula gives as it is printed, where `exact` is what it gives put right; in the
        unit `unit` [-].
    scale : float, optional
        What deviations are relative to, where the published value is zero.
    in_sample : bool
        Whether parameters of what is judged were chosen for this number.
    counted : bool
        Whether the measured fact is counted by this row: not where it judges a formula that the
        shipped bench does not run on, nor where it reads again what another row counts.
    why : str
        Why what was measured is missed; empty where it is not.
    limit : float, optional
        The last value tried, where a search may end without a result; in the unit `unit` [-].
    digits : int
        Significant digits that are shown.
    """

    item: str
    condition: str
    unit: str
    published: Published
    listing: float = math.nan
    exact: float = math.nan
    calibrated: float = math.nan
    judged: str = "exact"
    tolerance: float = 0.01
    measured: bool = False
    meant: Published | None = None
    as_printed: float | None = None
    scale: float | None = None
    in_sample: bool = False
    counted: bool = True
    why: str = ""
    limit: float | None = None
    digits: int = 4

    @property
    def verdict(self) -> str:
        """``holds``, ``off by N %``, ``misprint``, ``fails``, ``refuted`` or ``not checkable``.

        A verdict on a number for which parameters were chosen ends in ``(in sample)``.

        Examples
        --------
        >>> Row("v_crit2", "0.279 mm", "rad/s", number(12.5), calibrated=9.75,
        ...     judged="calibrated", measured=True).verdict
        'off by 22 %'
        >>> Row("critical_damping", "7.5 rad/s", "Nm s/rad", number(0.7599), listing=0.07598,
        ...     judged="listing", meant=number(0.07599)).verdict
        'misprint'
        >>> Row("mean_torque", "0.279 mm", "Nm", number(8.0), exact=8.01, in_sample=True).verdict
        'holds (in sample)'
        """
        return self._words() + (" (in sample)" if self.in_sample else "")

    @property
    def best(self) -> float:
        """Value compared with a measurement: of the shipped material, else of a formula [-]."""
        formula = not self.counted and math.isnan(self.calibrated)
        return self.exact if formula else self.calibrated

    @property
    def misses(self) -> bool:
        """Whether this was measured and `best` deviates by more than a quarter."""
        checkable = self.measured and not math.isnan(self.best)
        return checkable and self._word(self.best, self.meant or self.published) == "fails"

    def _words(self) -> str:
        value = getattr(self, self.judged)
        if math.isnan(value):
            return "not checkable"
        word = self._word(value, self.published)
        if word == "holds":
            if self.as_printed is not None and self._word(self.as_printed, self.published) != word:
                word = "misprint"
        elif self.meant is not None and self._word(value, self.meant) == "holds":
            word = "misprint"
        elif word == "fails" and self.measured and self.judged != "calibrated":
            word = "refuted"
        if self.measured and self.judged != "calibrated" and not math.isnan(self.calibrated):
            calibrated = self._word(self.calibrated, self.meant or self.published)
            if calibrated != "holds":
                word += f"; calibrated {calibrated}"
        return word

    def _word(self, value: float, published: Published) -> str:
        gap = published.gap(value, self.scale)
        if gap <= self.tolerance:
            return "holds"
        return f"off by {_percent(gap)} %" if gap <= _OFF_AT_MOST else "fails"

    def cells(self) -> dict[str, str]:
        """Return the row as texts by column; a value that there is none of is empty."""
        computed = (self._shown(getattr(self, name)) for name in _MODELS)
        cells = (self.item, self.condition, self.unit, self.published.text, *computed, self.verdict)
        return dict(zip(COLUMNS, cells, strict=True))

    def _shown(self, value: float) -> str:
        if math.isnan(value):
            return ""
        if math.isinf(value):
            return f"> {self.limit:g}"
        return _short(value, self.digits)


def _percent(gap: float) -> str:
    percent = 100.0 * gap
    return f"{percent:.1f}" if percent < 9.95 else f"{percent:.0f}"


def _short(value: float, digits: int) -> str:
    """Return a number with so many significant digits, without an exponent where that is short."""
    if value == 0.0:
        return "0"
    order = math.floor(math.log10(abs(value)))
    if not -5 <= order < 7:
        return f"{value:.{digits - 1}e}"
    decimals = max(digits - 1 - order, 0)
    return f"{round(value, digits - 1 - order):.{decimals}f}"


# --- from the files ------------------------------------------------------------------------------

_COMBINED: Mapping[str, Callable[[list[float]], float]] = {
    "": lambda values: values[0],
    "ratio": lambda values: values[0] / values[1],
    "rise": lambda values: values[0] - values[1],
    "span": lambda values: max(values) / min(values),
    "largest": max,
    "x4": lambda values: 4.0 * values[0],
    "x6": lambda values: 6.0 * values[0],
}
_DECIMALS = 6  # of what runs give: beyond them lies rounding


@lru_cache(maxsize=1)
def _lines() -> dict[str, list[dict[str, str]]]:
    """Return the rows of ``rows.csv`` by the name of their group."""
    text = (resources.files("noise.thesis") / "rows.csv").read_text(encoding="utf-8")
    groups: dict[str, list[dict[str, str]]] = {}
    for line in csv.DictReader(text.splitlines()):
        groups.setdefault(line["group"], []).append(line)
    return groups


def group_names() -> list[str]:
    """Return the names of the groups of rows, in the order of the table.

    Examples
    --------
    >>> group_names()[:2]
    ['potentiometer', 'torque_cell']
    """
    return list(_lines())


@lru_cache(maxsize=1)
def reasons() -> dict[tuple[str, str], str]:
    """Return why measured numbers are missed, by item and condition of the row.

    Examples
    --------
    >>> reasons()["v_crit1", "0.178 mm, 2214 Nm/rad"][:20]
    "The torque's drop at"
    """
    given = packaged_toml("noise.thesis", "why.toml")["why"]
    return {tuple(row): one["text"] for one in given for row in one["rows"]}


def thesis_rows(groups: Iterable[str]) -> list[Row]:
    """Compute the rows of groups; those that are missed say why.

    Examples
    --------
    >>> [row.verdict for row in thesis_rows(["misprints"])][:2]
    ['misprint', 'misprint']
    """
    return [_row(line) for group in groups for line in _lines()[group]]


_OPTIONAL: Mapping[str, Callable[[str], object]] = {
    "judged": str, "tolerance": float, "measured": bool, "as_printed": float, "scale": float,
    "meant": lambda text: number(float(text)), "in_sample": bool, "counted": lambda _: False,
    "limit": float, "digits": int,
}  # fmt: skip
"""Fields of a row that a line may state."""


def _row(line: Mapping[str, str]) -> Row:
    fields: dict[str, Any] = {name: of(line[name]) for name, of in _OPTIONAL.items() if line[name]}
    return Row(
        line["item"],
        line["condition"],
        line["unit"],
        Published(line["published"], float(line["low"]), float(line["high"])),
        why=reasons().get((line["item"], line["condition"]), ""),
        **fields | _computed(line),
    )


def _computed(line: Mapping[str, str]) -> dict[str, float]:
    """Return the values of a row by column."""
    quantity = line["quantity"]
    results = {"listing": float(line["listing"])} if line["listing"] else {}
    if line["value"]:
        results[line["judged"] or "exact"] = float(line["value"])
    columns = (line["columns"] or "exact calibrated").split() if quantity else []
    for column in columns:
        cases = map(_case, line["cases"].split(";"))
        shipped = THESIS if column == "exact" else CALIBRATED
        values = [QUANTITIES[quantity](own or shipped, case) for case, own in cases]
        value = _COMBINED[line["combined"]](values)
        results[column] = value if math.isinf(value) else round(value, _DECIMALS)
    return results


def _case(text: str) -> tuple[Case, str]:
    """Return a case, and its material where stated."""
    words = text.split()
    material = words.pop() if words[-1][0].isalpha() and words[-1] != "fixed" else ""
    speed, interference, support, *damping = (
        math.inf if word == "fixed" else float(word) for word in words
    )
    return Case(speed, interference, support, *damping), material


# --- the page ------------------------------------------------------------------------------------

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
    >>> verdict_counts(thesis_rows(["misprints"]))
    {'misprint': 5}
    """
    words = Counter(
        part.partition(" by ")[0] + " (in sample)" * row.in_sample
        for row in rows
        for part in row.verdict.removesuffix(" (in sample)").split("; ")
    )
    return dict(words.most_common())


def measured_counts(rows: Sequence[Row]) -> str:
    """Count what was measured, what of it the shipped program misses, and what is out of sample.

    A fact counts once, by the row that judges what ships; see `Row.counted`.

    Examples
    --------
    >>> measured_counts([Row("x", "y", "Hz", number(1.0), calibrated=2.0, measured=True)])
    'Measured: 1 fact, of which 1 out of sample; more than 25 % off 1, of which 1 out of sample...'
    """
    facts = [row for row in rows if row.measured and row.counted]
    checked = [row for row in facts if not math.isnan(row.best)]
    missed = [row for row in checked if row.misses]
    one, other = (sum(not row.in_sample for row in of) for of in (checked, missed))
    return (
        f"Measured: {counted(len(checked), 'fact')}, of which {one} out of sample; more than 25 % "
        f"off {len(missed)}, of which {other} out of sample; not checkable "
        f"{len(facts) - len(checked)}."
    )


def thesis_page(rows: Sequence[Row]) -> str:
    """Return the page.

    Examples
    --------
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
