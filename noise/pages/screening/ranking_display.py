"""The ranking of a screen as rows of a table in plain words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.screening.map.batches import LABELS
from noise.screening.tables.summary import parts_lines, risk_words

if TYPE_CHECKING:
    from noise.screening.outcome import Screening
    from noise.screening.ranking.ranking import Standing

__all__ = ["RankingRow", "ranking_rows"]


@dataclass(frozen=True)
class RankingRow:
    """A design in one environment and motion.

    Parameters
    ----------
    rank : str
    design, where : str
    risk : str
    shares : tuple of (str, float, str)
        Label, share of the conditions of use [-], and it in words; those that occur.
    loudest, margin : str
    words, hint : str
    notes : tuple of str
    """

    rank: str
    design: str
    where: str
    risk: str
    shares: tuple[tuple[str, float, str], ...]
    loudest: str
    margin: str
    words: str
    hint: str
    notes: tuple[str, ...]


def ranking_rows(found: Screening) -> list[RankingRow]:
    """Return the rows, the quietest design first.

    Examples
    --------
    >>> from noise.screening.design.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    >>> row = ranking_rows(found)[0]
    >>> row.rank, row.shares, row.loudest
    ('1', (('none', 1.0, '100 %'),), 'quiet')
    """
    return [_row(one, found) for one in found.standings]


def _row(one: Standing, found: Screening) -> RankingRow:
    loudest = "quiet" if one.rank is not None else ""
    if math.isfinite(one.loudest_level):
        loudest = f"{one.loudest_level:.0f} dB(A)"
    shares = tuple(
        (name, one.shares[name], _percent(one.shares[name]))
        for name in LABELS
        if one.shares.get(name)
    )
    parts = parts_lines(found.statistics_of(one.design, one.environment))
    return RankingRow(
        "\N{EN DASH}" if one.rank is None else str(one.rank),
        one.design,
        one.environment if one.motion == "steady" else f"{one.environment}, {one.motion}",
        risk_words(one.risk),
        shares,
        loudest,
        _margin(one),
        one.words,
        one.hint,
        tuple(dict.fromkeys([*parts, *(note for note in one.notes if note != one.never_slips)])),
    )


def _margin(one: Standing) -> str:
    if math.isnan(one.margin_v_crit2) or one.never_slips:
        return ""
    if math.isinf(one.margin_v_crit2):
        return "nothing vibrates"
    return f"{one.margin_v_crit2:+.3g} rad/s".replace("-", "\N{MINUS SIGN}")


def _percent(share: float) -> str:
    return "< 1 %" if share < 0.005 else f"{100.0 * share:.0f} %"
