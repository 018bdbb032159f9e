"""Row of the table: one published number beside the computed ones, and the verdict on it.

The verdict follows from numbers alone, by the tolerance that a row states: nobody's opinion is in
it. A row says which of its columns is judged. What was measured is judged on the calibrated column
as well, so that a calibrated rig which misses a measurement is told even where the thesis's
equations meet it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

COLUMNS = (
    "item", "condition", "unit", "published", "listing", "exact", "calibrated", "verdict",
)  # fmt: skip

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


Values = Mapping[str, float]
"""What is computed of a row: ``listing``, ``exact``, ``calibrated``, ``as_printed``, ``scale``."""


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
        computed = map(self._shown, (self.listing, self.exact, self.calibrated))
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
